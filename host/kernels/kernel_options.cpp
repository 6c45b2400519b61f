#include "host/kernels/kernel_options.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "host/error.hpp"

namespace raya {
namespace {

constexpr std::array<std::uint32_t, 4> kLanes = {1, 4, 8, 16};
constexpr std::uint32_t kMostGroup = 64;
constexpr std::uint32_t kMostBounces = 31;  // waiting rays are bits of a word

}  // namespace

void check_kernel_options(const KernelOptions& options, const DeviceInfo& device) {
    if (std::find(kLanes.begin(), kLanes.end(), options.lanes) == kLanes.end())
        throw UserError(fmt::format("--lanes {}: must be 1, 4, 8 or 16", options.lanes));
    const auto most = std::min<std::size_t>(kMostGroup, device.max_group_size);
    if (options.group_size < 1 || options.group_size > most)
        throw UserError(
            fmt::format("--group {}: must be 1..{} work-items on {}", options.group_size, most, device.name));
    if (options.bounces > kMostBounces)
        throw UserError(fmt::format("--bounces {}: must be 0..{}", options.bounces, kMostBounces));
}

std::uint32_t default_lanes(const DeviceInfo& device) {
    if (device.type != "cpu") return 1;
    std::uint32_t lanes = 4;
    for (const std::uint32_t width : kLanes)
        if (width <= device.native_float_width) lanes = std::max(lanes, width);
    return lanes;
}

std::uint32_t default_group_size(const DeviceInfo& device) {
    return device.type == "cpu" ? 1 : static_cast<std::uint32_t>(std::min<std::size_t>(32, device.max_group_size));
}

bool filters_hold(const NumberFormat& format, double extent) {
    constexpr int kFewestBits = 10;
    const double room =
        std::ldexp(1.0, (1 << (format.exponent_bits - 2)) - 2);  // a quarter of the square root of the largest number
    return !format.is_fp32() && format.fraction_bits >= kFewestBits && extent <= room;
}

std::vector<std::string> build_options(const KernelOptions& options, const DeviceInfo& device) {
    check_kernel_options(options, device);
    const NumberFormat& format = options.format;
    const bool exact_divide = options.exact_divide && device.correctly_rounded_divide_sqrt;
    std::vector<std::string> all = {"-cl-std=CL1.2"};
    const auto define = [&](const char* name, std::uint32_t value) {
        all.push_back(fmt::format("-DRAYA_{}={}", name, value));
    };
    if (!format.is_fp32()) {
        define("EXPONENT_BITS", static_cast<std::uint32_t>(format.exponent_bits));
        define("FRACTION_BITS", static_cast<std::uint32_t>(format.fraction_bits));
        define("TRUNCATE", format.truncates);
    }
    define("EXACT_DIVIDE", exact_divide);
    define("EXACT_FMA", options.exact_fma && device.fused_multiply_add);
    if (exact_divide) all.emplace_back("-cl-fp32-correctly-rounded-divide-sqrt");
    define("LANES", options.lanes);
    define("GROUP", options.group_size);
    define("BOUNCES", options.bounces);
    define("WORDS_LOCAL", options.words_local);
    define("POLYGONS", options.polygons);
    define("PATCHES", options.patches);
    define("CONES", options.cones);
    if (options.accel != RAYA_ACCEL_NONE) define("ACCEL", options.accel);
    if (options.accel == RAYA_ACCEL_BVH) define("BVH_STACK", options.stack);
    if (options.filter) define("FILTER", 1);
    if (options.costs) define("COSTS", 1);
    return all;
}

}  // namespace raya
