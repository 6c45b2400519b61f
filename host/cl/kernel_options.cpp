#include "host/cl/kernel_options.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "host/error.hpp"
#include "kernels/shared/trace_progress.h"

namespace raya {
namespace {

constexpr std::array<std::uint32_t, 4> kLanes = {1, 4, 8, 16};
constexpr std::uint32_t kMaxGroupSize = 1024;
constexpr std::uint32_t kMaxBounces = 31;  // the kernels store the pending rays of a tree as bits of one word

void check_tuning(const KernelTuning& values) {
    const auto check = [](const char* name, std::uint32_t value, std::uint32_t min, std::uint32_t max) {
        if (value != 0 && (value < min || value > max))
            throw UserError(fmt::format("{} {}: must be {}..{}", name, value, min, max));
    };
    check("sphere batch", values.sphere_batch, 1, 32);
    check("trees", values.trees, 1, 8);
    check("beams", values.beams, 1, 8);
    check("registers", values.registers, 16, 255);
}

}  // namespace

void check_kernel_options(const KernelOptions& options, const DeviceInfo& device) {
    if (std::find(kLanes.begin(), kLanes.end(), options.lanes) == kLanes.end())
        throw UserError(fmt::format("--lanes {}: must be 1, 4, 8 or 16", options.lanes));
    const std::uint32_t max_size = max_group_size_of(device);
    if (options.group_size < 1 || options.group_size > max_size)
        throw UserError(
            fmt::format("--group {}: must be 1..{} work-items on {}", options.group_size, max_size, device.name));
    if (options.bounces > kMaxBounces)
        throw UserError(fmt::format("--bounces {}: must be 0..{}", options.bounces, kMaxBounces));
    check_tuning(options.tuning);
}

std::uint32_t max_group_size_of(const DeviceInfo& device) {
    return static_cast<std::uint32_t>(std::min<std::size_t>(kMaxGroupSize, device.max_group_size));
}

bool supports_register_limit(const DeviceInfo& device) { return device.platform.find("NVIDIA") != std::string::npos; }

std::uint32_t trees_of(const KernelOptions& options) {
    const bool tuned = options.tuning.trees && options.accel == RAYA_ACCEL_GRID;
    return tuned ? options.tuning.trees : RAYA_DEFAULT_TREES(options.accel, options.lanes);
}

std::uint32_t default_lanes(const DeviceInfo& device) {
    if (device.type != "cpu" || is_llvmpipe(device)) return 1;
    std::uint32_t lanes = 4;
    for (const std::uint32_t width : kLanes)
        if (width <= device.native_float_width) lanes = std::max(lanes, width);
    return lanes;
}

std::uint32_t default_group_size(const DeviceInfo& device, bool torus, std::uint32_t pes) {
    constexpr std::size_t kGpuGroupSize = 128, kLlvmpipeGroupSize = 8, kWorkItemsPerUnit = 512;
    const bool cpu = device.type == "cpu";
    if (cpu && (torus || !is_llvmpipe(device))) return 1;
    std::size_t group = cpu ? kLlvmpipeGroupSize : kGpuGroupSize;
    if (!cpu && pes > 0)
        group = std::clamp<std::size_t>(std::bit_floor(kWorkItemsPerUnit * device.compute_units / pes), 32, 256);
    return static_cast<std::uint32_t>(std::min(group, device.max_group_size));
}

bool filters_are_valid(const NumberFormat& format, double extent) {
    constexpr int kMinFractionBits = 10;
    // A quarter of the square root of the format's largest number.
    const double max_extent = std::ldexp(1.0, (1 << (format.exponent_bits - 2)) - 2);
    return !format.is_fp32() && format.fraction_bits >= kMinFractionBits && extent <= max_extent;
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
    if (options.packets) define("RAY_PACKETS", 1);
    if (options.tuning.sphere_batch) define("SPHERE_BATCH", options.tuning.sphere_batch);
    if (options.tuning.trees && options.accel == RAYA_ACCEL_GRID) define("TREES", options.tuning.trees);
    if (options.tuning.beams && options.accel == RAYA_ACCEL_GRID) define("BEAMS", options.tuning.beams);
    if (options.tuning.registers && supports_register_limit(device))
        all.push_back(fmt::format("-cl-nv-maxrregcount={}", options.tuning.registers));
    return all;
}

}  // namespace raya
