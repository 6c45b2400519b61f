// Plans of dynamic distribution: their text both ways, and what is refused.
#include <catch2/catch.hpp>
#include <cstdint>
#include <limits>
#include <stdexcept>
#include <string>

#include "host/error.hpp"
#include "host/ring/schedule.hpp"
#include "host/scene/split_mix.hpp"
#include "tests/ring/small_mapping.hpp"

using namespace raya;
using Catch::Contains;

TEST_CASE("dynamic mappings by name, and what is refused", "[schedule]") {
    CHECK(parse_dynamic("dynamic:4") == DynamicPlan{4, 0, 0});
    CHECK(parse_dynamic("dynamic:1,2000") == DynamicPlan{1, 2'000, 0});
    CHECK(parse_dynamic("dynamic:268435456,1000000000") == DynamicPlan{268'435'456, 1'000'000'000, 0});
    CHECK(parse_dynamic("hybrid:8") == DynamicPlan{8, 0, 0.5});
    CHECK(parse_dynamic("hybrid:8,50") == DynamicPlan{8, 50, 0.5});
    CHECK(parse_dynamic("hybrid:8,50,0.75") == DynamicPlan{8, 50, 0.75});
    CHECK(parse_dynamic("hybrid:8,50,0") == DynamicPlan{8, 50, 0});
    CHECK(dynamic_text({4, 0, 0}) == "dynamic:4");
    CHECK(dynamic_text({4, 9, 0}) == "dynamic:4,9");
    CHECK(dynamic_text({4, 0, 0.5}) == "hybrid:4,0,0.5");
    constexpr std::uint64_t kSeed = 7;
    SplitMix random(kSeed);
    for (int i = 0; i < 500; ++i) {
        const double shares[] = {0, 0.5, 1, random.uniform(0, 1)};
        const DynamicPlan plan{1 + random_below(random, kLargestChunk >> random.next() % 28),
                               random.next() % 2 * random_below(random, kLargestOverhead + 1), shares[i % 4]};
        CAPTURE(kSeed, i, plan.chunk, plan.overhead, plan.static_share, dynamic_text(plan));
        CHECK(parse_dynamic(dynamic_text(plan)) == plan);
    }
    for (const std::string text : {"dynamic",
                                   "dynamic:",
                                   "dynamic:0",
                                   "dynamic:-1",
                                   "dynamic:+1",
                                   "dynamic: 1",
                                   "dynamic:1 ",
                                   "dynamic:1.5",
                                   "dynamic:x",
                                   "dynamic:268435457",
                                   "dynamic:4294967297",
                                   "dynamic:1,",
                                   "dynamic:1,-1",
                                   "dynamic:1,1000000001",
                                   "dynamic:1,99999999999999999999",
                                   "dynamic:1,2,0.5",
                                   "dynamic:,1",
                                   "hybrid",
                                   "hybrid:1,0,",
                                   "hybrid:1,0,1.01",
                                   "hybrid:1,0,-0.1",
                                   "hybrid:1,0,-0",
                                   "hybrid:1,0,nan",
                                   "hybrid:1,0,-nan",
                                   "hybrid:1,0,inf",
                                   "hybrid:1,0,0.5x",
                                   "hybrid:1,0,0.5,1",
                                   "hybrid:1,0,0,5",
                                   "Dynamic:1",
                                   "cyclic:16",
                                   ""}) {
        CHECK_THROWS_AS(parse_dynamic(text), UserError);
        CHECK_THROWS_WITH(parse_dynamic(text), Contains("--mapping " + text + ":") && Contains("dynamic:CHUNK") &&
                                                   Contains("1..268435456") && Contains("0..1000000000"));
    }
}

TEST_CASE("schedules refuse what does not fit together", "[schedule]") {
    const CostImage image{2, 2, {1, 2, 3, 4}};
    const raya_mapping fits{2, 2, 2, 0, RAYA_FOLD_CYCLIC};
    const auto refuses = [](const CostImage& costs, const raya_mapping& m) {
        CHECK_THROWS_AS(static_load(costs, m), std::invalid_argument);
        CHECK_THROWS_AS(dynamic_schedule(costs, m, {}), std::invalid_argument);
    };
    refuses(image, {1, 2, 2, 0, RAYA_FOLD_CYCLIC});
    refuses(image, {2, 1, 2, 0, RAYA_FOLD_CYCLIC});
    refuses(image, {2, 2, 0, 0, RAYA_FOLD_CYCLIC});
    refuses(image, {2, 2, 5, 0, RAYA_FOLD_CYCLIC});
    refuses({2, 2, {1, 2, 3}}, fits);
    refuses({0, 0, {}}, {0, 0, 1, 0, RAYA_FOLD_CYCLIC});
    for (const double share : {-0.1, 1.1, std::numeric_limits<double>::quiet_NaN()})
        CHECK_THROWS_AS(dynamic_schedule(image, fits, {1, 0, share}), std::invalid_argument);
    CHECK_THROWS_AS(dynamic_schedule(image, fits, {0, 0, 0}), std::invalid_argument);
    CHECK_THROWS_AS(dynamic_schedule(image, fits, {1, kLargestOverhead + 1, 0}), std::invalid_argument);
    CHECK_THROWS_AS(imbalance_of_offsets(image, 2, RAYA_FOLD_CYCLIC, {0, 2}), std::invalid_argument);
    CHECK_THROWS_AS(imbalance_of_offsets(image, 2, 7, {0}), std::invalid_argument);
    CHECK_THROWS_AS(imbalance_of_offsets(image, 5, RAYA_FOLD_BLOCK, {0}), std::invalid_argument);
    CHECK_THROWS_AS(lower_bound(image, 0), std::invalid_argument);
}
