// Tests of the tuner's search space.
#include <algorithm>
#include <catch2/catch.hpp>
#include <set>

#include "host/tune/tune.hpp"

namespace raya {
namespace {

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
            const std::vector<TunedValues> candidates = space.candidates();
            CHECK(candidates.front() == default_values(device, {.accel = accel}));
            std::size_t combinations = 1;
            for (const TuningParameter& parameter : space.parameters) combinations *= parameter.values.size();
            CHECK(candidates.size() == combinations);
            long differences = 0;  // candidates near the defaults come first
            std::set<std::string> texts;
            for (const TunedValues& values : candidates) {
                CHECK(texts.insert(change_text(space, values, values)).second);
                const long different = std::ranges::count_if(space.parameters, [&](const TuningParameter& p) {
                    return values.*p.value != space.defaults.*p.value;
                });
                CHECK(different >= differences);
                differences = different;
                const KernelChoice kernels = with_values({}, values);
                CHECK_NOTHROW(build_options({.lanes = kernels.lanes,
                                             .group_size = kernels.group_size,
                                             .accel = accel,
                                             .sphere_batch = kernels.sphere_batch},
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
        for (const TuningParameter& parameter : space_of(device, workload).parameters)
            if (parameter.value == &TunedValues::group) return parameter.values;
        return std::vector<std::uint32_t>{};
    };
    CHECK(groups_of(false, {}) == std::vector<std::uint32_t>{1, 2, 4});
    CHECK(groups_of(true, {}) == std::vector<std::uint32_t>{1, 2, 4, 8, 16});
    for (const bool llvmpipe : {false, true})
        CHECK(groups_of(llvmpipe, {.torus = true}) == std::vector<std::uint32_t>{1});
}

}  // namespace
}  // namespace raya
