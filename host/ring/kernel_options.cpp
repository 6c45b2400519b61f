#include "ring/kernel_options.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "error.hpp"

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

std::vector<std::string> build_options(const KernelOptions& options, const DeviceInfo& device) {
    check_kernel_options(options, device);
    std::vector<std::string> all = {
        "-cl-std=CL1.2",
        fmt::format("-DRAYA_LANES={}", options.lanes),
        fmt::format("-DRAYA_GROUP={}", options.group_size),
        fmt::format("-DRAYA_BOUNCES={}", options.bounces),
        fmt::format("-DRAYA_WORDS_LOCAL={:d}", options.words_local),
        fmt::format("-DRAYA_POLYGONS={:d}", options.polygons),
        fmt::format("-DRAYA_PATCHES={:d}", options.patches),
        fmt::format("-DRAYA_CONES={:d}", options.cones),
    };
    if (!options.format.is_fp32()) {
        all.push_back(fmt::format("-DRAYA_EXPONENT_BITS={}", options.format.exponent_bits));
        all.push_back(fmt::format("-DRAYA_FRACTION_BITS={}", options.format.fraction_bits));
        all.push_back(fmt::format("-DRAYA_TRUNCATE={:d}", options.format.truncates));
    }
    all.push_back(fmt::format("-DRAYA_EXACT_DIVIDE={:d}", device.correctly_rounded_divide_sqrt));
    if (device.correctly_rounded_divide_sqrt) all.emplace_back("-cl-fp32-correctly-rounded-divide-sqrt");
    return all;
}

}  // namespace raya
