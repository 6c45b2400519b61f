// The tuner's search space, and the decision whether a candidate is faster.
#include <algorithm>
#include <catch2/catch.hpp>
#include <set>

#include "host/tune/tune.hpp"

namespace raya {
namespace {

TEST_CASE("space_of: starts at the defaults, and has only values that the device supports", "[tune]") {
    for (const auto& [type, group_limit] :
         {std::pair{"cpu", 4096}, {"cpu", 1}, {"gpu", 1024}, {"gpu", 8}, {"other", 16}})
        for (const std::uint32_t accel : {RAYA_ACCEL_NONE, RAYA_ACCEL_GRID, RAYA_ACCEL_BVH}) {
            DeviceInfo device;
            device.type = type;
            device.max_group_size = static_cast<std::size_t>(group_limit);
            device.native_float_width = 8;
            const Space space = space_of(device, {.accel = accel});
            CAPTURE(type, group_limit, accel);
            const std::vector<TunedValues>& candidates = space.candidates;
            CHECK(candidates.front() == default_values(device, {.accel = accel}));
            const auto changes = [&](const TunedValues& v) {  // candidates near the defaults come first
                return (v.lanes != space.defaults.lanes) + (v.group != space.defaults.group) +
                       (v.local_words != space.defaults.local_words) + (v.batch != space.defaults.batch);
            };
            CHECK(std::ranges::is_sorted(candidates, {}, changes));
            for (const TunedValues& values : candidates) {
                CHECK(std::ranges::count(candidates, values) == 1);
                const KernelChoice kernels = with_values({}, values);
                CHECK_NOTHROW(check_kernel_options(
                    {.lanes = kernels.lanes, .group_size = kernels.group_size, .sphere_batch = kernels.sphere_batch},
                    device));
            }
        }
}

TEST_CASE(
    "space_of: groups on CPUs have at most 4 work-items, 16 if the driver vectorises over work-items, 1 on the torus",
    "[tune]") {
    const auto groups_of = [](bool llvmpipe, const TuningKey& workload) {
        DeviceInfo device;
        device.type = "cpu";
        device.max_group_size = 256;
        device.ends_loops_early = llvmpipe;
        std::set<std::uint32_t> groups;
        for (const TunedValues& values : space_of(device, workload).candidates) groups.insert(values.group);
        return groups;
    };
    CHECK(groups_of(false, {}) == std::set<std::uint32_t>{1, 2, 4});
    CHECK(groups_of(true, {}) == std::set<std::uint32_t>{1, 2, 4, 8, 16});
    for (const bool llvmpipe : {false, true}) CHECK(groups_of(llvmpipe, {.torus = true}) == std::set<std::uint32_t>{1});
}

Trial trial_with(std::vector<double> first, std::vector<double> last, const std::string& error = {}) {
    Trial trial;
    trial.error = error;
    trial.samples = {std::move(first), std::move(last)};
    return trial;
}

TEST_CASE("wins_significantly: requires a gain in nearly all pairs of samples, and a gain above the noise", "[tune]") {
    const std::vector<double> defaults(9, 0.1), better(9, 0.09), noise(9, 0.099);
    std::vector<double> one_slow = better;
    one_slow[4] = 0.2;  // a sample that other programs slowed down
    std::vector<double> two_slow = one_slow;
    two_slow[7] = 0.2;
    CHECK(wins_significantly(trial_with(defaults, better)));
    CHECK(wins_significantly(trial_with(defaults, one_slow)));
    CHECK_FALSE(wins_significantly(trial_with(defaults, two_slow)));
    CHECK_FALSE(wins_significantly(trial_with(defaults, noise)));
    CHECK_FALSE(wins_significantly(trial_with(defaults, better, "correctness: image is x")));
}

TEST_CASE("ratio_of: is the larger of the ratio of minimum times and the median ratio of sample pairs", "[tune]") {
    CHECK(ratio_of(trial_with({0.2, 0.1, 0.3}, {0.08, 0.1, 0.24})) == Approx(0.8));
    CHECK(ratio_of(trial_with({0.2, 0.2, 0.2}, {0.1, 0.2, 0.21})) == Approx(1.0));
    CHECK(ratio_of(trial_with({0.1, 0.4, 0.4}, {0.2, 0.2, 0.2})) == Approx(2.0));
    CHECK(ratio_of({}) == 1);
}

}  // namespace
}  // namespace raya
