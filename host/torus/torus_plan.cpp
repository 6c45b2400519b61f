#include "host/torus/torus_plan.hpp"

#include <fmt/core.h>

#include <cstddef>

#include "host/cl/tuned.hpp"
#include "host/error.hpp"
#include "host/scene/word_records.hpp"
#include "host/torus/topology.hpp"
#include "host/torus/windows.hpp"
#include "kernels/shared/packet.h"

namespace raya {

TorusSettings usual_torus(const ImageSize& size) {
    TorusSettings s;
    s.machine = machine_named("torus");
    s.width = size.width;
    s.height = size.height;
    s.torus = make_torus(kUsualNodes, s.links);
    s.voxels = kUsualNodes;
    s.bounces = s.machine.bounces;
    s.format = s.machine.format;
    return s;
}

JobSettings job_settings(const TorusSettings& s, const LengthScale& scale) {
    return {{s.width, s.height}, s.sampling, s.bounces, t805_cycles(s.packets), s.format, scale.exponent};
}

void check_packets(const TorusSettings& s, const Scene& scene) {
    for (std::uint32_t axis = 0; axis < 3; ++axis)
        if (s.voxels[axis] > RAYA_MOST_PLACES)
            throw UserError(
                fmt::format("--voxels {}: at most {} along an axis", sides_text(s.voxels), RAYA_MOST_PLACES));
    if (scene.lights.size() > RAYA_MOST_LIGHTS)
        throw UserError(fmt::format("{}: {} lights; packets of the torus name at most {}", scene.name,
                                    scene.lights.size(), RAYA_MOST_LIGHTS));
}

TorusSettings checked(TorusSettings s, const Scene& scene, const DeviceInfo& device) {
    check_packets(s, scene);
    s.kernels = chosen(s.kernels, device, {.torus = true, .fp32 = s.format.is_fp32()});
    check_kernel_options({.lanes = s.kernels.lanes, .group_size = s.kernels.group_size, .bounces = s.bounces}, device);
    return s;
}

std::uint64_t pixels_of(const TorusSettings& s) {
    const std::uint64_t all = std::uint64_t{s.width} * s.height;
    return s.pixels.first < all ? (all - s.pixels.first - 1) / s.pixels.stride + 1 : 0;
}

KernelOptions kernel_options(const TorusSettings& s, const PackedJob& job) {
    return {.lanes = s.kernels.lanes,
            .group_size = s.kernels.group_size,
            .bounces = s.bounces,
            .format = s.format,
            .exact_divide = s.kernels.exact_arithmetic,
            .exact_fma = s.kernels.exact_arithmetic,
            .words_local = s.kernels.local_words,
            .filter = s.kernels.filter && (job.header().objects.spheres > 0 || job.has_polygons()) &&
                      filters_hold(s.format, job.header().extent),
            .polygons = job.has_polygons(),
            .patches = job.has_patches(),
            .cones = job.has_cones(),
            .costs = s.history,
            .more = s.kernels.more};
}

void set_windows(NodeMemories& memories, const TorusSettings& s, const PackedJob& job, const Partition& partition) {
    const std::vector<PixelWindow> windows = pixel_windows(job.header(), partition.grid, s.torus, s.format);
    for (std::size_t node = 0; node < windows.size(); ++node)
        put_record(memories.words, memories.starts[node] + offsetof(raya_node, window) / sizeof(std::uint32_t),
                   windows[node]);
}

}  // namespace raya
