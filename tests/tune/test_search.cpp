// Tests of the search with synthetic cost functions: the cost of the best candidate relative to the minimum, and the
// number of trials.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <map>
#include <random>

#include "host/tune/search.hpp"

namespace raya {
namespace {

using Cost = std::function<double(const Candidate&)>;

const ShouldStop kNeverStop = [] { return false; };

Space random_space(std::mt19937& random) {
    const auto random_below = [&](std::uint32_t end) { return static_cast<std::size_t>(random() % end); };
    Space space;
    const std::size_t parameters = 3 + random_below(3);
    for (std::size_t k = 0; k < parameters; ++k) {
        space.parameters.push_back({&TunedValues::lanes, std::vector<std::uint32_t>(2 + random_below(5))});
        space.start.push_back(random_below(static_cast<std::uint32_t>(space.parameters.back().values.size())));
    }
    return space;
}

double minimum_cost(const Space& space, const Cost& cost) {
    double minimum = INFINITY;
    for_each_candidate(space, [&](const Candidate& c) { minimum = std::min(minimum, cost(c)); });
    return minimum;
}

// Cost factors of the parameters. Each parameter has a random best value and a random growth factor. Each step away
// from the best value multiplies the cost by the growth factor.
struct CostValley {
    CostValley(const Space& space, std::mt19937& random) {
        std::uniform_real_distribution<double> step(0.02, 0.6);
        for (const TuningParameter& parameter : space.parameters) {
            best.push_back(random() % parameter.values.size());
            steps.push_back(step(random));
        }
    }
    double factor(std::size_t parameter, double value_index) const {
        return std::exp(steps[parameter] * std::abs(value_index - static_cast<double>(best[parameter])));
    }

    std::vector<std::size_t> best;  // [parameter]: index of the best value
    std::vector<double> steps;      // [parameter]: logarithm of the growth factor
};

// Returns a cost in which the parameters do not interact.
Cost separable(const Space& space, std::mt19937& random) {
    return [valley = CostValley(space, random)](const Candidate& c) {
        double cost = 1;
        for (std::size_t k = 0; k < c.size(); ++k) cost *= valley.factor(k, static_cast<double>(c[k]));
        return cost;
    };
}

// Returns a cost in which the best value of parameter 1 depends on the value of parameter 0. Example: lanes and group
// size share a device's registers.
Cost coupled(const Space& space, std::mt19937& random) {
    const double coupling = std::uniform_real_distribution<double>(-0.8, 0.8)(random);
    return [valley = CostValley(space, random), coupling](const Candidate& c) {
        double cost = 1;
        for (std::size_t k = 0; k < c.size(); ++k) {
            const double deviation = k == 1 ? static_cast<double>(c[0]) - static_cast<double>(valley.best[0]) : 0;
            cost *= valley.factor(k, static_cast<double>(c[k]) - coupling * deviation);
        }
        return cost;
    };
}

// Returns a cost that is 1.5 times higher if the sum of two parameters exceeds a limit, as when a kernel spills
// registers.
Cost spilling(const Space& space, std::mt19937& random) {
    const std::size_t limit = 2 + random() % 5;
    return [valley = CostValley(space, random), limit](const Candidate& c) {
        double cost = c[0] + c[1] > limit ? 1.5 : 1.0;
        for (std::size_t k = 0; k < c.size(); ++k) cost *= valley.factor(k, static_cast<double>(c[k]));
        return cost;
    };
}

/// The result of a search, compared with an exhaustive search.
struct SearchQuality {
    double loss;            // cost of the best candidate found / minimum cost
    double tried_fraction;  // number of candidates tried / size of the space
};

// Searches `space`. Each measured ratio has a random relative error, uniformly distributed in -noise..noise.
SearchQuality search_quality(const Space& space, const Cost& cost, std::mt19937& random, double noise) {
    std::uniform_real_distribution<double> error(-noise, noise);
    std::map<Candidate, int> measurements;
    const MeasureRatio measure = [&](const Candidate& best, const Candidate& candidate) -> std::optional<double> {
        CHECK(++measurements[candidate] == 1);
        CHECK(candidate != space.start);
        return cost(candidate) / cost(best) * (1 + error(random));
    };
    const SearchResult result = search(space, measure, kNeverStop);
    CHECK(result.complete);
    CHECK(result.tried == measurements.size());
    return {cost(result.best) / minimum_cost(space, cost),
            static_cast<double>(result.tried) / static_cast<double>(space.size())};
}

TEST_CASE("search: ends within 5 % of the minimum after trying a fraction of the space", "[tune]") {
    struct Family {
        const char* name;
        Cost (*make_cost)(const Space&, std::mt19937&);
        int max_missed;  // maximum number of searches, of 200, that may end more than 5 % above the minimum
    };
    constexpr int kSpaces = 200;
    for (const Family& family :
         {Family{"separable", separable, 0}, Family{"coupled", coupled, 10}, Family{"spilling", spilling, 4}})
        for (const double noise : {0.0, 0.01}) {
            int missed = 0;
            double tried_fraction = 0;
            for (unsigned seed = 1; seed <= kSpaces; ++seed) {
                std::mt19937 random(seed);
                const Space space = random_space(random);
                const SearchQuality found = search_quality(space, family.make_cost(space, random), random, noise);
                missed += found.loss > 1.05;
                tried_fraction += found.tried_fraction / kSpaces;
                INFO(family.name << ", noise " << noise << ", seed " << seed << ": cost / minimum cost " << found.loss);
                CHECK(found.loss < 1.5);
            }
            INFO(family.name << ", noise " << noise << ": " << missed << " of " << kSpaces
                             << " searches ended more than 5 % above the minimum; mean fraction of candidates tried "
                             << tried_fraction);
            CHECK(missed <= family.max_missed);
            CHECK(tried_fraction < 0.2);
        }
}

TEST_CASE("search: never returns a dropped candidate", "[tune]") {
    for (unsigned seed = 1; seed <= 100; ++seed) {
        std::mt19937 random(seed);
        const Space space = random_space(random);
        const Cost cost = separable(space, random);
        const std::size_t dropped_value = random() % space.parameters[0].values.size();
        const MeasureRatio measure = [&](const Candidate& best, const Candidate& candidate) -> std::optional<double> {
            if (candidate[0] == dropped_value) return {};
            return cost(candidate) / cost(best);
        };
        const SearchResult result = search(space, measure, kNeverStop);
        CAPTURE(seed, dropped_value);
        CHECK((result.best[0] != dropped_value || space.start[0] == dropped_value));
    }
}

TEST_CASE("search: ends when ShouldStop returns true, with the best candidate so far", "[tune]") {
    std::mt19937 random(7);
    const Space space = random_space(random);
    const Cost cost = separable(space, random);
    for (const std::size_t limit : {0, 1, 3}) {
        std::size_t measured = 0;
        const MeasureRatio measure = [&](const Candidate& best, const Candidate& candidate) {
            ++measured;
            return std::optional(cost(candidate) / cost(best));
        };
        const SearchResult result = search(space, measure, [&] { return measured >= limit; });
        CHECK(result.tried == limit);
        CHECK_FALSE(result.complete);
        CHECK(cost(result.best) <= cost(space.start));
    }
}

TEST_CASE("search: tries the parameters with two values first", "[tune]") {
    for (unsigned seed = 1; seed <= 200; ++seed) {
        std::mt19937 random(seed);
        Space space = random_space(random);
        const std::size_t added = space.parameters.size();  // index of the parameter added in the next line
        space.parameters.push_back({&TunedValues::link_exchange, {0, 1}});
        space.start.push_back(random() % 2);
        const auto two_valued = static_cast<std::size_t>(
            std::count_if(space.parameters.begin(), space.parameters.end(),
                          [](const TuningParameter& parameter) { return parameter.values.size() == 2; }));
        std::size_t measured = 0;
        const MeasureRatio measure = [&](const Candidate& best, const Candidate& candidate) {
            ++measured;
            return std::optional(candidate[added] != best[added] ? 0.7 : 1.1);  // only the added parameter gives a gain
        };
        const SearchResult result = search(space, measure, [&] { return measured >= two_valued; });
        CAPTURE(seed, two_valued);
        CHECK(result.best[added] != space.start[added]);
    }
}

TEST_CASE("search: a candidate with a gain within the noise is not better", "[tune]") {
    std::mt19937 random(1);
    const Space space = random_space(random);
    const MeasureRatio measure = [&](const Candidate&, const Candidate&) { return std::optional(0.985); };
    CHECK(search(space, measure, kNeverStop).best == space.start);
}

TEST_CASE("search_all: finds the minimum", "[tune]") {
    std::mt19937 random(3);
    const Space space = random_space(random);
    const Cost cost = coupled(space, random);
    const MeasureRatio measure = [&](const Candidate& best, const Candidate& candidate) {
        return std::optional(cost(candidate) / cost(best));
    };
    const SearchResult exhaustive = search_all(space, space.start, measure, kNeverStop);
    CHECK(exhaustive.tried == space.size() - 1);
    CHECK(cost(exhaustive.best) <= minimum_cost(space, cost) / kMaxWinRatio);
}

TEST_CASE("space_of: starts at the defaults, and has only values that the device supports", "[tune]") {
    for (const auto& [type, group_limit, platform] : {std::tuple{"cpu", 4096, "PoCL"},
                                                      {"cpu", 1, "PoCL"},
                                                      {"gpu", 1024, "NVIDIA CUDA"},
                                                      {"gpu", 8, "rusticl"},
                                                      {"other", 16, "x"}})
        for (const std::uint32_t accel : {RAYA_ACCEL_NONE, RAYA_ACCEL_GRID, RAYA_ACCEL_BVH}) {
            DeviceInfo device;
            device.type = type;
            device.platform = platform;
            device.max_group_size = static_cast<std::size_t>(group_limit);
            device.native_float_width = 8;
            const Space space = space_of(device, {.accel = accel});
            CAPTURE(type, group_limit, platform, accel);
            CHECK(space.values_of(space.start) == default_values(device, {.accel = accel}));
            bool limits_registers = false;
            for (const TuningParameter& parameter : space.parameters)
                limits_registers |= parameter.value == &TunedValues::registers;
            CHECK(limits_registers == (device.platform == "NVIDIA CUDA"));
            for_each_candidate(space, [&](const Candidate& candidate) {
                const KernelChoice kernels = with_values({}, space.values_of(candidate));
                CHECK_NOTHROW(build_options({.lanes = kernels.lanes,
                                             .group_size = kernels.group_size,
                                             .accel = accel,
                                             .tuning = kernels.tuning},
                                            device));
            });
        }
}

TEST_CASE(
    "space_of: groups on CPUs have at most 4 work-items, 16 if the driver vectorises over work-items, 1 on the torus",
    "[tune]") {
    const auto groups_of = [](std::uint32_t max_loop_iterations, const TuningKey& workload) {
        DeviceInfo device;
        device.type = "cpu";
        device.max_group_size = 256;
        device.max_loop_iterations = max_loop_iterations;
        for (const TuningParameter& parameter : space_of(device, workload).parameters)
            if (parameter.value == &TunedValues::group) return parameter.values;
        return std::vector<std::uint32_t>{};
    };
    const std::uint32_t llvmpipe_iterations = 65'535;
    CHECK(groups_of(0, {}) == std::vector<std::uint32_t>{1, 2, 4});
    CHECK(groups_of(llvmpipe_iterations, {}) == std::vector<std::uint32_t>{1, 2, 4, 8, 16});
    for (const std::uint32_t max_iterations : {0u, llvmpipe_iterations})
        CHECK(groups_of(max_iterations, {.torus = true}) == std::vector<std::uint32_t>{1});
}

TEST_CASE(
    "space_of: link exchange is a parameter of the torus only; value 2, the kernel, only if it is not the default",
    "[tune]") {
    const auto link_exchanges_of = [](const char* type, const TuningKey& workload) {
        DeviceInfo device;
        device.type = type;
        device.max_group_size = 256;
        for (const TuningParameter& parameter : space_of(device, workload).parameters)
            if (parameter.value == &TunedValues::link_exchange) return parameter.values;
        return std::vector<std::uint32_t>{};
    };
    CHECK(link_exchanges_of("cpu", {}).empty());
    CHECK(link_exchanges_of("cpu", {.torus = true}) == std::vector<std::uint32_t>{0, 1});
    CHECK(link_exchanges_of("gpu", {.torus = true}) == std::vector<std::uint32_t>{0, 1, 2});
    DeviceInfo cpu;
    cpu.type = "cpu";
    const Space space = space_of(cpu, {.torus = true});
    TunedValues copies = space.defaults;
    copies.link_exchange = 1;
    CHECK_THAT(change_text(space, space.defaults, copies), Catch::EndsWith(", link exchange default -> copies"));
}

}  // namespace
}  // namespace raya
