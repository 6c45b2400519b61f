#include "host/ring/ring_plan.hpp"

#include <algorithm>

#include "kernels/shared/bvh.h"

namespace raya {
namespace {

// Local memory is as fast as a CPU's other memory, and each launch copies the words into it for each PE: where
// they are many and few of them are read, they stay where they are.
bool words_local(const PackedJob& job, const DeviceInfo& device, AccelKind accel) {
    constexpr std::size_t kMostCopied = 64 * 1024;
    const std::size_t bytes = 4 * job.words().size() + sizeof(std::uint32_t);
    return bytes <=
           (accel != AccelKind::kNone ? std::min(kMostCopied, device.local_memory_bytes) : device.local_memory_bytes);
}

}  // namespace

JobSettings job_settings(const RingSettings& settings, const LengthScale& scale) {
    return {{settings.mapping.width, settings.mapping.height},
            settings.sampling,
            settings.bounces,
            cycles_of_events(),
            settings.format,
            scale.exponent};
}

RingSettings checked(RingSettings settings, const DeviceInfo& device) {
    check_antialias(settings.antialias.method, settings.mapping, settings.dynamic.has_value());
    if (!settings.kernels.lanes) settings.kernels.lanes = default_lanes(device);
    if (!settings.kernels.group_size) settings.kernels.group_size = default_group_size(device);
    check_kernel_options(
        {.lanes = settings.kernels.lanes, .group_size = settings.kernels.group_size, .bounces = settings.bounces},
        device);
    return settings;
}

LaunchSlices slices(const RingSettings& settings, std::size_t objects, std::uint32_t lanes, std::uint32_t share) {
    if (const std::uint32_t pixels = settings.pixels_per_launch) return {pixels, pixels, pixels};
    constexpr double kTestsPerLaunch = 1e9;  // about a second of two CPU cores
    constexpr double kRaysPerPixel = 6;      // of the project's scenes
    const double tests_of_one = kRaysPerPixel * static_cast<double>(objects) * settings.mapping.pes;
    const auto affordable = static_cast<std::uint32_t>(std::min(kTestsPerLaunch / tests_of_one, double(share)));
    const std::uint32_t least = std::min(8 * lanes, share);  // below, lanes are idle too often at the end of a launch
    return {std::min(lanes, share), least, std::clamp(affordable, least, share)};
}

KernelOptions kernel_options(const RingSettings& settings, const PackedJob& job, const AccelSummary& accel,
                             const DeviceInfo& device) {
    return {.lanes = settings.kernels.lanes,
            .group_size = settings.kernels.group_size,
            .bounces = settings.bounces,
            .format = settings.format,
            .exact_divide = settings.kernels.exact_arithmetic,
            .exact_fma = settings.kernels.exact_arithmetic,
            .words_local = settings.kernels.local_words && words_local(job, device, settings.accel.kind),
            .accel = static_cast<std::uint32_t>(settings.accel.kind),
            .stack = (RAYA_BVH_WIDTH - 1) * accel.depth,
            .filter = settings.kernels.filter && (job.header().objects.spheres > 0 || job.has_polygons()) &&
                      filters_hold(settings.format, job.header().extent),
            .polygons = job.has_polygons(),
            .patches = job.has_patches(),
            .cones = job.has_cones()};
}

}  // namespace raya
