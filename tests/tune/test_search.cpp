// The search with synthetic cost functions: the cost found relative to the minimum, and the number of trials.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <map>
#include <random>

#include "host/tune/search.hpp"

namespace raya {
namespace {

using Cost = std::function<double(const Candidate&)>;

const ShouldStop kNeverEnds = [] { return false; };

Space random_space(std::mt19937& random) {
    const auto below = [&](std::uint32_t end) { return static_cast<std::size_t>(random() % end); };
    Space space;
    const std::size_t parameters = 3 + below(3);
    for (std::size_t k = 0; k < parameters; ++k) {
        space.parameters.push_back({&TunedValues::lanes, std::vector<std::uint32_t>(2 + below(5))});
        space.start.push_back(below(static_cast<std::uint32_t>(space.parameters.back().values.size())));
    }
    return space;
}

double minimum_cost(const Space& space, const Cost& cost) {
    double minimum = INFINITY;
    for_each_candidate(space, [&](const Candidate& c) { minimum = std::min(minimum, cost(c)); });
    return minimum;
}

// A cost factor for each parameter, with its minimum at a random best value of the parameter. Each step away from this
// value multiplies the cost by the same factor, which is random for each parameter.
struct CostValley {
    CostValley(const Space& space, std::mt19937& random) {
        std::uniform_real_distribution<double> step(0.02, 0.6);
        for (const TuningParameter& parameter : space.parameters) {
            best.push_back(random() % parameter.values.size());
            steps.push_back(step(random));
        }
    }
    double at(std::size_t parameter, double place) const {
        return std::exp(steps[parameter] * std::abs(place - static_cast<double>(best[parameter])));
    }

    std::vector<std::size_t> best;
    std::vector<double> steps;
};

Cost separable(const Space& space, std::mt19937& random) {
    return [valley = CostValley(space, random)](const Candidate& c) {
        double cost = 1;
        for (std::size_t k = 0; k < c.size(); ++k) cost *= valley.at(k, static_cast<double>(c[k]));
        return cost;
    };
}

// The best value of parameter 1 depends on the value of parameter 0. Example: lanes and group size share a device's
// registers.
Cost shared(const Space& space, std::mt19937& random) {
    const double share = std::uniform_real_distribution<double>(-0.8, 0.8)(random);
    return [valley = CostValley(space, random), share](const Candidate& c) {
        double cost = 1;
        for (std::size_t k = 0; k < c.size(); ++k) {
            const double other = k == 1 ? static_cast<double>(c[0]) - static_cast<double>(valley.best[0]) : 0;
            cost *= valley.at(k, static_cast<double>(c[k]) - share * other);
        }
        return cost;
    };
}

// The cost jumps where the sum of two parameters exceeds a limit, as when a kernel spills registers.
Cost spilling(const Space& space, std::mt19937& random) {
    const std::size_t limit = 2 + random() % 5;
    return [valley = CostValley(space, random), limit](const Candidate& c) {
        double cost = c[0] + c[1] > limit ? 1.5 : 1.0;
        for (std::size_t k = 0; k < c.size(); ++k) cost *= valley.at(k, static_cast<double>(c[k]));
        return cost;
    };
}

/// The result of a search, compared with an exhaustive search.
struct SearchQuality {
    double loss;   // cost found / minimum cost
    double share;  // candidates tried / size of the space
};

// Searches `space`. Each measurement has a relative error, uniform in -noise..noise.
SearchQuality search_quality(const Space& space, const Cost& cost, std::mt19937& random, double noise) {
    std::uniform_real_distribution<double> error(-noise, noise);
    std::map<Candidate, int> asked;
    const MeasureRatio judge = [&](const Candidate& best, const Candidate& candidate) -> std::optional<double> {
        CHECK(++asked[candidate] == 1);
        CHECK(candidate != space.start);
        return cost(candidate) / cost(best) * (1 + error(random));
    };
    const SearchResult result = search(space, judge, kNeverEnds);
    CHECK(result.ended);
    CHECK(result.tried == asked.size());
    return {cost(result.best) / minimum_cost(space, cost),
            static_cast<double>(result.tried) / static_cast<double>(space.size())};
}

TEST_CASE("search: ends within 5 % of the minimum after trying a fraction of the space", "[tune]") {
    struct Family {
        const char* name;
        Cost (*make)(const Space&, std::mt19937&);
        int max_missed;  // searches that may end more than 5 % above the minimum, of 200
    };
    constexpr int kSpaces = 200;
    for (const Family& family :
         {Family{"separable", separable, 0}, Family{"shared", shared, 10}, Family{"spilling", spilling, 4}})
        for (const double noise : {0.0, 0.01}) {
            int missed = 0;
            double share = 0;
            for (unsigned seed = 1; seed <= kSpaces; ++seed) {
                std::mt19937 random(seed);
                const Space space = random_space(random);
                const SearchQuality found = search_quality(space, family.make(space, random), random, noise);
                missed += found.loss > 1.05;
                share += found.share / kSpaces;
                INFO(family.name << ", noise " << noise << ", seed " << seed << ": " << found.loss);
                CHECK(found.loss < 1.5);
            }
            INFO(family.name << ", noise " << noise << ": " << missed << " of " << kSpaces << " missed, " << share
                             << " tried");
            CHECK(missed <= family.max_missed);
            CHECK(share < 0.2);
        }
}

TEST_CASE("search: never returns a dropped candidate", "[tune]") {
    for (unsigned seed = 1; seed <= 100; ++seed) {
        std::mt19937 random(seed);
        const Space space = random_space(random);
        const Cost cost = separable(space, random);
        const std::size_t bad = random() % space.parameters[0].values.size();
        const MeasureRatio judge = [&](const Candidate& best, const Candidate& candidate) -> std::optional<double> {
            if (candidate[0] == bad) return {};
            return cost(candidate) / cost(best);
        };
        const SearchResult result = search(space, judge, kNeverEnds);
        CAPTURE(seed, bad);
        CHECK((result.best[0] != bad || space.start[0] == bad));
    }
}

TEST_CASE("search: ends when the caller says so, with the best candidate so far", "[tune]") {
    std::mt19937 random(7);
    const Space space = random_space(random);
    const Cost cost = separable(space, random);
    for (const std::size_t limit : {0, 1, 3}) {
        std::size_t judged = 0;
        const MeasureRatio judge = [&](const Candidate& best, const Candidate& candidate) {
            ++judged;
            return std::optional(cost(candidate) / cost(best));
        };
        const SearchResult result = search(space, judge, [&] { return judged >= limit; });
        CHECK(result.tried == limit);
        CHECK_FALSE(result.ended);
        CHECK(cost(result.best) <= cost(space.start));
    }
}

TEST_CASE("search: tries the parameters with two values first", "[tune]") {
    for (unsigned seed = 1; seed <= 200; ++seed) {
        std::mt19937 random(seed);
        Space space = random_space(random);
        const std::size_t gains =
            space.parameters.size();  // index of the parameter added below, the only one with a gain
        space.parameters.push_back({&TunedValues::link_exchange, {0, 1}});
        space.start.push_back(random() % 2);
        const auto switches = static_cast<std::size_t>(
            std::count_if(space.parameters.begin(), space.parameters.end(),
                          [](const TuningParameter& parameter) { return parameter.values.size() == 2; }));
        std::size_t judged = 0;
        const MeasureRatio judge = [&](const Candidate& best, const Candidate& candidate) {
            ++judged;
            return std::optional(candidate[gains] != best[gains] ? 0.7 : 1.1);
        };
        const SearchResult result = search(space, judge, [&] { return judged >= switches; });
        CAPTURE(seed, switches);
        CHECK(result.best[gains] != space.start[gains]);
    }
}

TEST_CASE("search: a gain within the noise does not win", "[tune]") {
    std::mt19937 random(1);
    const Space space = random_space(random);
    const MeasureRatio judge = [&](const Candidate&, const Candidate&) { return std::optional(0.985); };
    CHECK(search(space, judge, kNeverEnds).best == space.start);
}

TEST_CASE("search_all: finds the minimum", "[tune]") {
    std::mt19937 random(3);
    const Space space = random_space(random);
    const Cost cost = shared(space, random);
    const MeasureRatio judge = [&](const Candidate& best, const Candidate& candidate) {
        return std::optional(cost(candidate) / cost(best));
    };
    const SearchResult all = search_all(space, space.start, judge, kNeverEnds);
    CHECK(all.tried == space.size() - 1);
    CHECK(cost(all.best) <= minimum_cost(space, cost) / kMaxWinRatio);
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
                CHECK_NOTHROW(build_options(
                    {.lanes = kernels.lanes, .group_size = kernels.group_size, .accel = accel, .more = kernels.more},
                    device));
            });
        }
}

TEST_CASE("space_of: groups on CPUs have a few work-items, more if they form vectors, one per torus node", "[tune]") {
    const auto groups_of = [](std::uint32_t max_loop_iterations, const TuningKey& workload) {
        DeviceInfo device;
        device.type = "cpu";
        device.max_group_size = 256;
        device.max_loop_iterations = max_loop_iterations;
        for (const TuningParameter& parameter : space_of(device, workload).parameters)
            if (parameter.value == &TunedValues::group) return parameter.values;
        return std::vector<std::uint32_t>{};
    };
    const std::uint32_t llvmpipe = 65'535;
    CHECK(groups_of(0, {}) == std::vector<std::uint32_t>{1, 2, 4});
    CHECK(groups_of(llvmpipe, {}) == std::vector<std::uint32_t>{1, 2, 4, 8, 16});
    for (const std::uint32_t max_iterations : {0u, llvmpipe})
        CHECK(groups_of(max_iterations, {.torus = true}) == std::vector<std::uint32_t>{1});
}

TEST_CASE(
    "space_of: link exchange is a parameter of the torus only, with an explicit kernel if that is not the default",
    "[tune]") {
    const auto moves_of = [](const char* type, const TuningKey& workload) {
        DeviceInfo device;
        device.type = type;
        device.max_group_size = 256;
        for (const TuningParameter& parameter : space_of(device, workload).parameters)
            if (parameter.value == &TunedValues::link_exchange) return parameter.values;
        return std::vector<std::uint32_t>{};
    };
    CHECK(moves_of("cpu", {}).empty());
    CHECK(moves_of("cpu", {.torus = true}) == std::vector<std::uint32_t>{0, 1});
    CHECK(moves_of("gpu", {.torus = true}) == std::vector<std::uint32_t>{0, 1, 2});
    DeviceInfo cpu;
    cpu.type = "cpu";
    const Space space = space_of(cpu, {.torus = true});
    TunedValues copies = space.defaults;
    copies.link_exchange = 1;
    CHECK_THAT(change_text(space, space.defaults, copies), Catch::EndsWith(", link exchange own -> copies"));
}

}  // namespace
}  // namespace raya
