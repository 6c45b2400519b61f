// Plans of dynamic work distribution: the text of a plan, and the refusal of invalid plans.
#include <catch2/catch.hpp>
#include <limits>
#include <stdexcept>

#include "host/ring/mapping.hpp"

using namespace raya;

TEST_CASE("a plan's text omits default values at its end", "[schedule]") {
    CHECK(dynamic_text({4, 0, 0}) == "dynamic:4");
    CHECK(dynamic_text({4, 9, 0}) == "dynamic:4,9");
    CHECK(dynamic_text({4, 0, 0, 7}) == "dynamic:4,0,7");
    CHECK(dynamic_text({4, 0, 0.5}) == "hybrid:4,0,0.5");
    CHECK(dynamic_text({4, 0, 0.5, 7}) == "hybrid:4,0,0.5,7");
}

TEST_CASE("schedules reject invalid cost images, mappings and plans, and mappings that do not match the cost image",
          "[schedule]") {
    const CostImage image{2, 2, {1, 2, 3, 4}};
    const raya_mapping valid_mapping{2, 2, 2, 0, RAYA_FOLD_CYCLIC};
    const auto check_error = [](const CostImage& costs, const raya_mapping& m) {
        CHECK_THROWS_AS(static_load(costs, m), std::invalid_argument);
        CHECK_THROWS_AS(dynamic_schedule(costs, m, {}), std::invalid_argument);
    };
    check_error(image, {1, 2, 2, 0, RAYA_FOLD_CYCLIC});
    check_error(image, {2, 1, 2, 0, RAYA_FOLD_CYCLIC});
    check_error(image, {2, 2, 0, 0, RAYA_FOLD_CYCLIC});
    check_error(image, {2, 2, 5, 0, RAYA_FOLD_CYCLIC});
    check_error({2, 2, {1, 2, 3}}, valid_mapping);
    check_error({0, 0, {}}, {0, 0, 1, 0, RAYA_FOLD_CYCLIC});
    for (const double static_fraction : {-0.1, 1.1, std::numeric_limits<double>::quiet_NaN()})
        CHECK_THROWS_AS(dynamic_schedule(image, valid_mapping, {1, 0, static_fraction}), std::invalid_argument);
    CHECK_THROWS_AS(dynamic_schedule(image, valid_mapping, {0, 0, 0}), std::invalid_argument);
    CHECK_THROWS_AS(dynamic_schedule(image, valid_mapping, {1, kMaxOverhead + 1, 0}), std::invalid_argument);
    CHECK_THROWS_AS(dynamic_schedule(image, valid_mapping, {1, 0, 0, kMaxOverhead + 1}), std::invalid_argument);
    CHECK_THROWS_AS(imbalance_of_offsets(image, 2, RAYA_FOLD_CYCLIC, {0, 2}), std::invalid_argument);
    CHECK_THROWS_AS(imbalance_of_offsets(image, 2, 7, {0}), std::invalid_argument);
    CHECK_THROWS_AS(imbalance_of_offsets(image, 5, RAYA_FOLD_BLOCK, {0}), std::invalid_argument);
    CHECK_THROWS_AS(lower_bound(image, 0), std::invalid_argument);
}
