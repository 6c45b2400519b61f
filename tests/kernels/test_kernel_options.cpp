// Build options of the kernels: -D options, default values, and values that are refused.
#include <algorithm>
#include <catch2/catch.hpp>
#include <string>
#include <vector>

#include "host/cl/kernel_options.hpp"
#include "host/error.hpp"

using namespace raya;
using Catch::Contains;

namespace {

DeviceInfo device_with(const std::string& type, std::uint32_t width, std::size_t max_group) {
    DeviceInfo device;
    device.name = "a device";
    device.type = type;
    device.native_float_width = width;
    device.max_group_size = max_group;
    return device;
}

const DeviceInfo kCpu = device_with("cpu", 8, 4096);

}  // namespace

TEST_CASE("exact arithmetic is used only if the device supports it and the options allow it", "[ring]") {
    using Options = std::vector<std::string>;
    DeviceInfo exact = kCpu;
    exact.correctly_rounded_divide_sqrt = exact.fused_multiply_add = true;
    const auto arithmetic_options = [&](const KernelOptions& options) {
        const Options all = build_options(options, exact);
        return Options(all.begin() + 1, std::find(all.begin(), all.end(), "-DRAYA_LANES=1"));
    };
    CHECK(build_options({}, kCpu)[1] == "-DRAYA_EXACT_DIVIDE=0");
    CHECK(arithmetic_options({}) ==
          Options{"-DRAYA_EXACT_DIVIDE=1", "-DRAYA_EXACT_FMA=1", "-cl-fp32-correctly-rounded-divide-sqrt"});
    CHECK(arithmetic_options({.exact_divide = false}) == Options{"-DRAYA_EXACT_DIVIDE=0", "-DRAYA_EXACT_FMA=1"});
    CHECK(arithmetic_options({.exact_fma = false}) ==
          Options{"-DRAYA_EXACT_DIVIDE=1", "-DRAYA_EXACT_FMA=0", "-cl-fp32-correctly-rounded-divide-sqrt"});
}

TEST_CASE("lanes, group sizes and bounces out of range are refused", "[ring]") {
    const auto check_error = [](const KernelOptions& options, const DeviceInfo& device, const auto& message) {
        CHECK_THROWS_AS(build_options(options, device), UserError);
        CHECK_THROWS_WITH(build_options(options, device), message);
    };
    for (const std::uint32_t lanes : {1u, 4u, 8u, 16u}) CHECK_NOTHROW(build_options({.lanes = lanes}, kCpu));
    for (const std::uint32_t lanes : {0u, 2u, 3u, 17u, 32u})
        check_error({.lanes = lanes}, kCpu,
                    Contains("--lanes " + std::to_string(lanes) + ":") && Contains("1, 4, 8 or 16"));
    CHECK_NOTHROW(build_options({.group_size = 1024}, kCpu));
    for (const std::uint32_t group : {0u, 1025u})
        check_error({.group_size = group}, kCpu,
                    Contains("--group " + std::to_string(group) + ":") && Contains("1..1024"));
    const DeviceInfo small = device_with("gpu", 1, 16);
    CHECK_NOTHROW(build_options({.group_size = 16}, small));
    check_error({.group_size = 17}, small, Contains("--group 17:") && Contains("1..16") && Contains("a device"));
    CHECK_NOTHROW(build_options({.bounces = 0}, kCpu));
    CHECK_NOTHROW(build_options({.bounces = 31}, kCpu));
    check_error({.bounces = 32}, kCpu, Contains("--bounces 32:") && Contains("0..31"));
}

TEST_CASE("default lanes and group size depend on the device", "[ring]") {
    CHECK(default_lanes(device_with("cpu", 16, 4096)) == 16);
    CHECK(default_lanes(device_with("cpu", 8, 4096)) == 8);
    CHECK(default_lanes(device_with("cpu", 2, 4096)) == 4);  // more lanes than the vector width do more work per branch
    CHECK(default_lanes(device_with("gpu", 1, 1024)) == 1);
    CHECK(default_group_size(device_with("cpu", 16, 4096)) == 1);
    CHECK(default_group_size(device_with("gpu", 1, 1024)) == 128);
    CHECK(default_group_size(device_with("gpu", 1, 8)) == 8);
    CHECK(default_group_size(device_with("gpu", 1, 1024), true) == 128);
    DeviceInfo h100 = device_with("gpu", 1, 1024);
    h100.compute_units = 132;
    for (const auto& [pes, group] : {std::pair{1U, 256U}, {256U, 256U}, {512U, 128U}, {2048U, 32U}, {100'000U, 32U}}) {
        CHECK(default_group_size(h100, false, pes) == group);
        CHECK(chosen_kernels({}, h100, {}, pes).group_size == group);
        CHECK(chosen_kernels({}, h100, {.accel = RAYA_ACCEL_BVH}, pes).group_size == 128);
    }
    h100.max_group_size = 64;
    CHECK(default_group_size(h100, false, 256) == 64);
}

TEST_CASE(
    "on llvmpipe, which vectorises over work-items, the defaults are one lane and groups of 8 (torus: 1) work-items",
    "[ring]") {
    DeviceInfo llvmpipe = device_with("cpu", 1, 1024);
    llvmpipe.ends_loops_early = true;
    CHECK(default_lanes(llvmpipe) == 1);
    CHECK(default_group_size(llvmpipe) == 8);
    CHECK(default_group_size(llvmpipe, true) == 1);
    CHECK(default_group_size(device_with("cpu", 16, 4096), true) == 1);
    for (const bool torus : {false, true}) {
        const KernelChoice defaults = chosen_kernels({}, llvmpipe, {.torus = torus});
        CHECK(defaults.group_size == default_group_size(llvmpipe, torus));
        CHECK(defaults.sphere_batch == (torus ? 0 : 16));
        const KernelChoice with_lanes = chosen_kernels({.lanes = 4}, llvmpipe, {.torus = torus});
        CHECK((with_lanes.lanes == 4 && with_lanes.group_size == defaults.group_size));
        CHECK(with_lanes.sphere_batch == defaults.sphere_batch);
    }
    for (const TuningKey& key :
         {TuningKey{.accel = RAYA_ACCEL_GRID}, TuningKey{.accel = RAYA_ACCEL_BVH}, {.fp32 = false}})
        CHECK(chosen_kernels({}, llvmpipe, key).sphere_batch == 0);
}
