// Loads computed from cost images, compared with sums over the pixels, with an event-by-event simulation and with
// theoretical bounds.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cstdint>
#include <deque>
#include <limits>
#include <numeric>
#include <stdexcept>
#include <vector>

#include "host/ring/mapping.hpp"
#include "host/scene/split_mix.hpp"
#include "kernels/shared/share_pixels.h"
#include "tests/ring/small_mapping.hpp"

using namespace raya;

namespace {

using Cycles = std::vector<std::uint64_t>;

/// Returns a random cost image of one of four kinds: all costs are zero; there are few distinct costs, so that many PEs
/// become free at the same time; costs are nearly equal; or a few pixels cost far more than all others.
CostImage random_image(SplitMix& random, std::uint32_t width, std::uint32_t height) {
    CostImage image{width, height, {}};
    const std::uint64_t kind = random.next() % 8;
    for (std::uint32_t i = 0; i < width * height; ++i) {
        const std::uint64_t number = random.next();
        const std::uint64_t heavy = number % 16 == 0 ? number % 1'000'003 : number % 10;
        image.cycles.push_back(kind == 0 ? 0 : kind < 4 ? number % 4 : kind < 6 ? 9'000 + number % 2'000 : heavy);
    }
    return image;
}

DynamicPlan random_plan(SplitMix& random, std::uint32_t pixels) {
    DynamicPlan plan;
    plan.chunk = random.next() % 4 == 0 ? 1 : 1 + random_below(random, random.next() % 2 ? 8 : pixels + 2);
    plan.overhead = random.next() % 3 * random_below(random, 500);
    const double fractions[] = {0, 0, 0.25, 0.5, 0.9, 1, random.uniform(0, 1)};
    plan.static_fraction = fractions[random_below(random, 7)];
    plan.root_cycles = random.next() % 2 * random_below(random, 500);
    return plan;
}

struct Simulated {
    Cycles finished;             // [PE]: when the PE finishes its last pixel
    std::uint64_t requests = 0;  // number of chunks that PEs requested
};

/// Simulates a dynamic schedule event by event. The function finds each PE's pixels by the owners of all pixels, and
/// the next free PE by a search over all PEs.
Simulated simulated(const CostImage& image, const raya_mapping& m, const DynamicPlan& plan) {
    std::vector<std::vector<std::uint64_t>> shares(m.pes);  // [PE]: pixel numbers
    for (std::uint32_t j = 0; j < image.height; ++j)
        for (std::uint32_t x = 0; x < image.width; ++x) shares[raya_owner(m, j, x)].push_back(j * image.width + x);
    Simulated run;
    std::deque<std::uint64_t> queue(image.cycles.size());
    std::iota(queue.begin(), queue.end(), 0);
    for (std::uint32_t pe = 0; pe < m.pes; ++pe) {
        const raya_share share = raya_share_of(m, pe);
        run.finished.push_back(0);
        for (const std::uint64_t at : shares[pe]) {
            const raya_pixel pixel{static_cast<std::uint32_t>(at) / m.width, static_cast<std::uint32_t>(at) % m.width};
            const double end = plan.static_fraction * static_cast<double>(shares[pe].size());
            if (raya_index_of(m, share, pixel) + 1 > end) continue;
            run.finished[pe] += image.cycles[at];
            queue.erase(std::find(queue.begin(), queue.end(), at));
        }
    }
    std::uint64_t root_is_free = 0;
    while (!queue.empty()) {
        const auto first_free = std::min_element(
            run.finished.begin(), run.finished.end());  // the lowest-numbered of the PEs that become free first
        if (plan.root_cycles > 0) {
            root_is_free = std::max(root_is_free, *first_free) + plan.root_cycles;
            *first_free = root_is_free;
        }
        *first_free += plan.overhead;
        ++run.requests;
        for (std::uint32_t i = 0; i < plan.chunk && !queue.empty(); ++i, queue.pop_front())
            *first_free += image.cycles[queue.front()];
    }
    return run;
}

}  // namespace

TEST_CASE("a static load is the sum of the costs of the PE's pixels", "[schedule]") {
    CHECK(static_load({3, 2, {1, 20, 300, 4'000, 50'000, 600'000}}, {3, 2, 3, 1, RAYA_FOLD_CYCLIC}).per_pe ==
          Cycles{1 + 50'000, 20 + 600'000, 300 + 4'000});  // PE i owns (0, i) and (1, i + 1)
}

TEST_CASE("dynamic and hybrid schedules agree with the simulation", "[schedule]") {
    const CostImage six_pixels{6, 1, {5, 1, 1, 1, 1, 2}};
    const raya_mapping two_pes{6, 1, 2, 0, RAYA_FOLD_BLOCK};  // pixel costs: PE 0 owns 5 1 1, PE 1 owns 1 1 2
    CHECK(dynamic_schedule(six_pixels, two_pes, {1, 0, 0}).load.per_pe == Cycles{5, 6});
    CHECK(dynamic_schedule(six_pixels, two_pes, {2, 10, 0}).load.per_pe ==
          Cycles{16, 12 + 13});  // PE 0: chunk 5 1; PE 1: chunks 1 1 and 1 2
    CHECK(dynamic_schedule(six_pixels, two_pes, {1, 10, 0.5}).load.per_pe ==
          Cycles{5 + 11 + 12, 1 + 11 + 11});  // static: 5 and 1; then chunks of one pixel: 1 1 1 2
    // The root answers PE 0 at cycle 3 (pixel of 5 cycles), and PE 1 at cycles 6 and 10 (pixels of 1 cycle).
    const raya_mapping one_row{3, 1, 2, 0, RAYA_FOLD_BLOCK};
    CHECK(dynamic_schedule({3, 1, {5, 1, 1}}, one_row, {1, 0, 0, 3}).load.per_pe == Cycles{3 + 5, 6 + 1 + 3 + 1});
    constexpr std::uint64_t kSeed = 3;
    SplitMix random(kSeed);
    for (int i = 0; i < 1'500; ++i) {
        const raya_mapping m = small_mapping(random, 14);
        const auto [width, height, pes, offset, fold] = m;
        const CostImage image = random_image(random, width, height);
        const DynamicPlan plan = random_plan(random, width * height);
        CAPTURE(kSeed, i, width, height, pes, offset, fold, plan.chunk, plan.overhead, plan.static_fraction);
        const Schedule schedule = dynamic_schedule(image, m, plan);
        const Simulated run = simulated(image, m, plan);
        CHECK(schedule.load.per_pe == run.finished);
        CHECK(schedule.requests == run.requests);
        CHECK(schedule.load.max == *std::max_element(run.finished.begin(), run.finished.end()));
    }
}

TEST_CASE("speed-up counts only the pixels' work, and is defined if all costs are 0", "[schedule]") {
    const CostImage equal_costs{4, 1, {30, 30, 30, 30}};
    const raya_mapping two_pes{4, 1, 2, 0, RAYA_FOLD_CYCLIC};
    const Schedule with_overhead = dynamic_schedule(equal_costs, two_pes, {1, 10, 0});
    CHECK(with_overhead.load.max == 80);
    CHECK(with_overhead.load.speedup == 1.5);  // 120 / 80
    CHECK(with_overhead.load.efficiency == 0.75);
    const CostImage zero_costs{4, 1, {0, 0, 0, 0}};
    CHECK(dynamic_schedule(zero_costs, two_pes, {1, 0, 0}).load.speedup == 2);
    CHECK(dynamic_schedule(zero_costs, two_pes, {1, 10, 0}).load.speedup == 0);
    CHECK(imbalance_of_offsets(zero_costs, 2, RAYA_FOLD_CYCLIC, {0, 1}) == std::vector<double>{0, 0});
    CHECK(lower_bound(equal_costs, 4) == 30);
    CHECK(lower_bound({3, 1, {5, 5, 5}}, 2) == 8);
    CHECK(lower_bound({3, 1, {1, 9, 1}}, 2) == 9);
    CHECK(lower_bound(zero_costs, 3) == 0);
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
