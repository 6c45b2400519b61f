#include "host/kernels/kernel_options.hpp"

#include <fmt/format.h>

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

bool sphere_filter_holds(const NumberFormat& format, double extent) {
    constexpr int kFewestBits = 10;
    const double room =
        std::ldexp(1.0, (1 << (format.exponent_bits - 2)) - 2);  // a quarter of the square root of the largest number
    return !format.is_fp32() && format.fraction_bits >= kFewestBits && extent <= room;
}

std::vector<std::string> format_options(const NumberFormat& format, const DeviceInfo& device) {
    std::vector<std::string> all = {"-cl-std=CL1.2"};
    if (!format.is_fp32()) {
        all.push_back(fmt::format("-DRAYA_EXPONENT_BITS={}", format.exponent_bits));
        all.push_back(fmt::format("-DRAYA_FRACTION_BITS={}", format.fraction_bits));
        all.push_back(fmt::format("-DRAYA_TRUNCATE={:d}", format.truncates));
    }
    all.push_back(fmt::format("-DRAYA_EXACT_DIVIDE={:d}", device.correctly_rounded_divide_sqrt));
    all.push_back(fmt::format("-DRAYA_EXACT_FMA={:d}", device.fused_multiply_add));
    if (device.correctly_rounded_divide_sqrt) all.emplace_back("-cl-fp32-correctly-rounded-divide-sqrt");
    return all;
}

std::vector<std::string> build_options(const KernelOptions& options, const DeviceInfo& device) {
    check_kernel_options(options, device);
    std::vector<std::string> all = format_options(options.format, device);
    all.push_back(fmt::format("-DRAYA_LANES={}", options.lanes));
    all.push_back(fmt::format("-DRAYA_GROUP={}", options.group_size));
    all.push_back(fmt::format("-DRAYA_BOUNCES={}", options.bounces));
    all.push_back(fmt::format("-DRAYA_WORDS_LOCAL={:d}", options.words_local));
    all.push_back(fmt::format("-DRAYA_POLYGONS={:d}", options.polygons));
    all.push_back(fmt::format("-DRAYA_PATCHES={:d}", options.patches));
    all.push_back(fmt::format("-DRAYA_CONES={:d}", options.cones));
    if (options.accel) all.emplace_back("-DRAYA_ACCEL=1");
    if (options.filter) all.emplace_back("-DRAYA_FILTER=1");
    return all;
}

std::vector<std::string> without_local_words() { return {"-DRAYA_WITHOUT_LOCAL_WORDS"}; }

std::vector<std::string> without_exact_arithmetic() { return {"-DRAYA_WITHOUT_EXACT_ARITHMETIC"}; }

}  // namespace raya
