#include "host/torus/torus_plan.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "host/base/encoding.hpp"
#include "host/cl/kernel_options.hpp"
#include "host/error.hpp"
#include "host/scene/scene.hpp"
#include "host/version.hpp"
#include "kernels/shared/packet.h"
#include "kernels/shared/traffic.h"

namespace raya {
namespace {

NodeBuffers buffers_of(const Scene& scene, const NodeSizes& sizes, const TorusSettings& s) {
    return plan_buffers(scene.name, sizes, s.torus, s.memory_bytes, s.queue,
                        raya_min_queue(static_cast<std::uint32_t>(scene.lights.size()), s.bounces));
}

TorusJob receive_job(const NodeDistribution& distribution) {
    TorusJob job;
    distribution.ranks().broadcast<TorusJobHeader>(job);
    job.memories.starts.resize(distribution.count() + 1);
    distribution.ranks().receive(0, std::span(job.memories.starts));
    job.memories.words.resize(job.memories.starts.back());
    distribution.ranks().receive(0, std::span(job.memories.words));
    return job;
}

// Collective: returns, in rank 0, a hash of the words of all nodes. It does not depend on the number of ranks.
std::string memories_hash(const NodeMemories& memories, const NodeDistribution& distribution) {
    std::vector<char> digits;
    for (std::uint32_t slot = 0; slot < distribution.count(); ++slot) {
        const std::size_t words = memories.starts[slot + 1] - memories.starts[slot];
        const std::string hash = words_hash(std::span(memories.words).subspan(memories.starts[slot], words));
        digits.insert(digits.end(), hash.begin(), hash.end());
    }
    constexpr std::size_t kHashDigits = 32;
    const std::vector<char> all = distribution.gather(std::move(digits), kHashDigits);
    return bytes_hash({all.data(), all.size()});
}

/// Throws UserError if there are more voxels or lights than the fields of a packet can number.
void check_packet_fields(const TorusSettings& s, const Scene& scene) {
    for (std::uint32_t axis = 0; axis < 3; ++axis)
        if (s.voxels[axis] > RAYA_MAX_PLACES)
            throw UserError(
                fmt::format("--voxels {}: must be at most {} along an axis", sides_text(s.voxels), RAYA_MAX_PLACES));
    if (scene.lights.size() > RAYA_MAX_LIGHTS)
        throw UserError(fmt::format("{}: {} lights: the torus supports at most {}; use fewer, or a ring machine",
                                    scene.name, scene.lights.size(), RAYA_MAX_LIGHTS));
}

}  // namespace

TorusSettings default_torus(const ImageSize& size) {
    TorusSettings s;
    s.machine = machine_named("torus");
    s.width = size.width;
    s.height = size.height;
    s.torus = make_torus(kDefaultNodes, s.links);
    s.voxels = kDefaultNodes;
    s.bounces = s.machine.bounces;
    s.format = s.machine.format;
    return s;
}

JobSettings job_settings(const TorusSettings& s, const LengthScale& scale) {
    return {{s.width, s.height}, s.sampling, s.bounces, t805_cycles(s.packets), s.format, scale.exponent};
}

TorusSettings checked_settings(TorusSettings s, const Scene& scene, const DeviceInfo& device) {
    check_packet_fields(s, scene);
    s.kernels = chosen_kernels(s.kernels, device, {.torus = true, .fp32 = s.format.is_fp32()});
    check_kernel_options({.lanes = s.kernels.lanes, .group_size = s.kernels.group_size, .bounces = s.bounces}, device);
    return s;
}

std::uint64_t traced_pixels(const TorusSettings& s) {
    const std::uint64_t image_pixels = std::uint64_t{s.width} * s.height;
    return s.pixels.first < image_pixels ? (image_pixels - s.pixels.first - 1) / s.pixels.stride + 1 : 0;
}

NodeNeeds node_needs(const Scene& scene, const TorusSettings& s) {
    check_packet_fields(s, scene);
    const LengthScale scale = length_scale(scene, s.format);
    const PackedJob job = pack_job(scene, job_settings(s, scale));
    const NodeSizes sizes = node_sizes(job, partition(job, s.format, s.voxels), s.torus);
    const std::uint64_t words = std::ranges::max(sizes);
    const NodeBuffers buffers = buffers_of(scene, sizes, s);
    return {scale, words, node_bytes(words, buffers, links_of_node(s.torus))};
}

// The words of other ranks' nodes are packed rank by rank, so that this rank never holds all of them.
TorusJob make_torus_job(const Session& session, const Scene& scene, const TorusSettings& s,
                        const NodeDistribution& distribution, const std::function<void()>& packed) {
    Ranks& ranks = distribution.ranks();
    if (!ranks.is_first()) return receive_job(distribution);
    const LengthScale scale = length_scale(scene, s.format);
    const PackedJob job = [&] {
        const SpanLog::Span span = session.span("pack scene");
        return pack_job(scene, job_settings(s, scale));
    }();
    if (packed) packed();
    const SpanLog::Span span = session.span("divide scene");
    const Partition partition = raya::partition(job, s.format, s.voxels);
    const NodeSizes sizes = node_sizes(job, partition, s.torus);
    for (std::uint32_t rank = 0; rank < ranks.count(); ++rank) check_words(sizes, distribution.pes_of(rank));
    const std::vector<PixelWindow> windows = pixel_windows(job.header(), partition.grid, s.torus, s.format);
    const auto memories_of = [&](std::uint32_t rank) {
        const std::vector<std::uint32_t>& nodes = distribution.pes_of(rank);
        NodeMemories memories = pack_nodes(job, partition, s.torus, nodes);
        for (std::size_t slot = 0; slot < nodes.size(); ++slot)
            put_record(memories.words, memories.starts[slot] + offsetof(raya_node, window) / sizeof(std::uint32_t),
                       windows[nodes[slot]]);
        return memories;
    };
    TorusJobHeader header{
        job.header(),      job.has_patches(), scale, buffers_of(scene, sizes, s), std::ranges::max(sizes),
        partition.copies()};
    if (ranks.has_several()) ranks.broadcast(header);
    for (std::uint32_t rank = 1; rank < ranks.count(); ++rank) {
        const NodeMemories memories = memories_of(rank);
        ranks.send(rank, std::span<const std::uint32_t>(memories.starts));
        ranks.send(rank, std::span<const std::uint32_t>(memories.words));
    }
    return {header, memories_of(0)};
}

StateSettings state_settings(const TorusSettings& s, const TorusJob& job, const NodeDistribution& distribution) {
    return {{"raya", raya_version()},
            {"a machine of type", "torus"},
            {"--size", fmt::format("{}x{}", s.width, s.height)},
            {"--nodes", sides_text({s.torus.nodes[0], s.torus.nodes[1], s.torus.nodes[2]})},
            {"--links", links_name(s.links)},
            {"--voxels", sides_text(s.voxels)},
            {"--inject", s.inject == Injection::kRoot ? "root" : "all"},
            {"--returns", s.packets.one_return_per_ray ? "rays" : "terms"},
            {"--packet-words", std::to_string(s.packets.ray_words)},
            {"--queue", std::to_string(job.buffers.queue)},
            {"--format", format_name(s.format)},
            {"--bounces", std::to_string(s.bounces)},
            {"--sampling", s.sampling == Sampling::kCorners ? "corners" : "centres"},
            {"every Nth pixel, from", fmt::format("{}, {}", s.pixels.stride, s.pixels.first)},
            {"another scene, camera or light", memories_hash(job.memories, distribution)}};
}

namespace {

Vec3 vec3(const float (&v)[3]) { return {v[0], v[1], v[2]}; }

const Box kEverywhere{-Box().min, -Box().max};

// Projects a point P onto the image: solves P - eye = c (corner + x column_step + y row_step) for depth c, column x and
// row y.
struct Projection {
    Projection(const raya_job& job, const NumberFormat& format)
        : eye(vec3(job.eye)),
          corner(vec3(job.corner)),
          column_step(vec3(job.column_step)),
          row_step(vec3(job.row_step)),
          normal(column_step.cross(row_step)),
          pixel_distance(std::min(column_step.length(), row_step.length())) {
        const double width = job.mapping.width, height = job.mapping.height;
        // Bound of the rounding error of a direction, in pixels: 16 units in the last place of the sum of the lengths
        // of the direction's terms. The margin is one pixel larger, because the edge of a window is half-open.
        const double unit = std::ldexp(1.0, -format.fraction_bits);
        margin = 1 + 16 * unit * (corner.length() + width * column_step.length() + height * row_step.length()) /
                         pixel_distance;
        for (const double x : {-1.0, width})
            for (const double y : {-1.0, height})
                max_distance = std::max(max_distance, (corner + x * column_step + y * row_step).length());
    }

    // Returns depth c of P.
    double depth(const Vec3& p) const { return (p - eye).dot(normal) / corner.dot(normal); }

    // Returns column and row of P, which must be in front of the eye.
    Vec3 pixel(const Vec3& p) const {
        const Vec3 flat = (p - eye) / depth(p) - corner;
        return {flat.dot(row_step.cross(normal)) / column_step.dot(row_step.cross(normal)),
                flat.dot(column_step.cross(normal)) / row_step.dot(column_step.cross(normal)), 0};
    }

    Vec3 eye, corner, column_step, row_step, normal;
    double pixel_distance;    // minimum distance of adjacent pixels at depth c = 1
    double margin;            // of a window, pixels
    double max_distance = 0;  // maximum |P - eye| of a pixel at depth c = 1
};

// Clips a face to the points with depth >= `min_depth` (Sutherland & Hodgman 1974).
std::vector<Vec3> clipped(const Projection& projection, const std::array<Vec3, 4>& face, double min_depth) {
    std::vector<Vec3> polygon;
    for (std::size_t i = 0; i < face.size(); ++i) {
        const Vec3 &a = face[i], &b = face[(i + 1) % face.size()];
        const double depth_a = projection.depth(a), depth_b = projection.depth(b);
        if (depth_a >= min_depth) polygon.push_back(a);
        if ((depth_a >= min_depth) != (depth_b >= min_depth))
            polygon.push_back(a + (min_depth - depth_a) / (depth_b - depth_a) * (b - a));
    }
    return polygon;
}

// Extends the box, of columns x and rows y, by a face of the voxel at place `at`. The face lies in plane `k` of the
// grid planes perpendicular to `axis`. `distance`: distance of plane `k` from the eye.
void add_face(Box& box, const Projection& projection, const raya_grid& grid, const raya_place& at, std::uint32_t axis,
              std::uint32_t k, double distance) {
    const std::uint32_t second = (axis + 1) % 3, third = (axis + 2) % 3;
    std::array<Vec3, 4> face;
    for (std::uint32_t corner = 0; corner < 4; ++corner) {
        face[corner][axis] = raya_voxel_plane(grid, axis, k);
        face[corner][second] = raya_voxel_plane(grid, second, at.at[second] + (corner == 1 || corner == 2 ? 1 : 0));
        face[corner][third] = raya_voxel_plane(grid, third, at.at[third] + corner / 2);
    }
    // The clipping depth is smaller than the depth of any visible point of the face.
    for (const Vec3& p : clipped(projection, face, distance / projection.max_distance / 2))
        box.extend(projection.pixel(p));
}

// Extends the box by a voxel. The box is infinite if no bound is known.
void add_voxel(Box& box, const Projection& projection, const raya_grid& grid, std::uint32_t voxel) {
    const raya_place at = raya_place_of(voxel, grid.divisions[0], grid.divisions[1]);
    bool contains_eye = true;
    for (std::uint32_t axis = 0; axis < 3; ++axis) {
        const double eye = projection.eye[axis];
        const double box_low = raya_voxel_plane(grid, axis, 0),
                     box_high = raya_voxel_plane(grid, axis, grid.divisions[axis]);
        // Bound of the rounding error of a ray's entry point (grid/traversal.clh), which is a few fp32 units in the
        // last place of the path length and of the origin.
        const double slack = std::ldexp(std::abs(eye) + std::max(std::abs(box_low), std::abs(box_high)), -20);
        const double low = raya_voxel_plane(grid, axis, at.at[axis]),
                     high = raya_voxel_plane(grid, axis, at.at[axis] + 1);
        contains_eye = contains_eye && eye >= low - slack && eye <= high + slack;
        const double distance_below = box_low - eye, distance_above = eye - box_high,
                     distance = std::max(distance_below, distance_above);
        const bool faces_eye =
            distance_below > 0 ? low <= box_low + slack : distance_above > 0 && high >= box_high - slack;
        if (!faces_eye) continue;
        // No bound is known if the eye is so close to the face that rounding may move the entry point by a pixel.
        if (slack * projection.max_distance > distance * projection.pixel_distance) box = kEverywhere;
        add_face(box, projection, grid, at, axis, at.at[axis] + (distance_above > 0 ? 1 : 0), distance);
    }
    if (contains_eye) box = kEverywhere;
}

}  // namespace

std::vector<PixelWindow> pixel_windows(const raya_job& job, const raya_grid& grid, const raya_torus& torus,
                                       const NumberFormat& format) {
    constexpr int kMinWindowBits = 10;  // with fewer fraction bits there is no error bound, so no window
    const Projection projection(job, format);
    const std::uint32_t width = job.mapping.width, height = job.mapping.height;
    const auto clamped = [](double value, std::uint32_t max) {
        return static_cast<std::uint32_t>(std::clamp<double>(value, 0, max));
    };
    std::vector<PixelWindow> windows;
    for (std::uint32_t node = 0; node < raya_nodes(torus); ++node) {
        Box box;
        const std::uint32_t voxels = raya_node_voxels(torus, grid, node);
        if (voxels > 0 && format.fraction_bits < kMinWindowBits) box = kEverywhere;
        for (std::uint32_t i = 0; i < voxels && box != kEverywhere; ++i)
            add_voxel(box, projection, grid, raya_voxel_of_node(torus, grid, node, i));
        const double m = projection.margin;
        if (box.is_empty())
            windows.push_back({});
        else
            windows.push_back(
                {{clamped(std::floor(box.min.y - m), height), clamped(std::ceil(box.max.y + m) + 1, height)},
                 {clamped(std::floor(box.min.x - m), width), clamped(std::ceil(box.max.x + m) + 1, width)}});
    }
    return windows;
}

}  // namespace raya
