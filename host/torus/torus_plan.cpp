#include "host/torus/torus_plan.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cstddef>

#include "host/cl/tuned.hpp"
#include "host/error.hpp"
#include "host/scene/packer.hpp"
#include "host/torus/topology.hpp"
#include "kernels/shared/packet.h"
#include "kernels/shared/traffic.h"

namespace raya {
namespace {

PackedJob packed_job(const Session& session, const Scene& scene, const TorusSettings& settings,
                     const LengthScale& scale) {
    const SpanLog::Span span = session.span("pack scene");
    return pack_job(scene, job_settings(settings, scale));
}

// Returns a job that has only a header, no objects.
PackedJob header_only_job(const raya_job& header, bool has_patches) {
    PackedJob job(header, std::vector<std::uint32_t>(kWordsOf<raya_job>), has_patches);
    job.set_header(header);
    return job;
}

std::uint64_t fullest_words(const NodeMemories& memories) {
    std::uint64_t words = 0;
    for (std::size_t node = 0; node + 1 < memories.starts.size(); ++node)
        words = std::max<std::uint64_t>(words, memories.starts[node + 1] - memories.starts[node]);
    return words;
}

NodeBuffers buffers_of(const Scene& scene, const NodeMemories& memories, const TorusSettings& s,
                       const NodeTrial& trial) {
    return plan_buffers(scene.name, memories, s.torus, s.memory_bytes, s.queue,
                        raya_min_queue(static_cast<std::uint32_t>(scene.lights.size()), s.bounces), trial);
}

// Packs the job and divides it among all nodes.
TorusJob divide_scene(const Session& session, const Scene& scene, const TorusSettings& s, const NodeShare& share,
                      const DeviceMemory& device) {
    const LengthScale scale = length_scale(scene, s.format);
    const PackedJob job = packed_job(session, scene, s, scale);
    const SpanLog::Span span = session.span("divide scene");
    const Partition partition = raya::partition(job, s.format, s.voxels);
    TorusJob all{
        header_only_job(job.header(), job.has_patches()), pack_nodes(job, partition, s.torus), scale, {}, 0, 0};
    all.buffers = buffers_of(scene, all.memories, s, make_node_trial(job, s.format, s.voxels));
    check_device_memory(scene.name, all.buffers, share.max_nodes_of_rank(), session.device().name, device);
    set_windows(all.memories, s, job, partition);
    all.words = all.memories.words.size();
    all.fullest_words = fullest_words(all.memories);
    return all;
}

// Returns the memories of `nodes`, in this order.
NodeMemories select_memories(const NodeMemories& all, const std::vector<std::uint32_t>& nodes) {
    NodeMemories own;
    own.copies = all.copies;
    own.max_objects = all.max_objects;
    own.starts.push_back(0);
    for (const std::uint32_t node : nodes) {
        own.words.insert(own.words.end(), all.words.begin() + all.starts[node],
                         all.words.begin() + all.starts[node + 1]);
        own.starts.push_back(static_cast<std::uint32_t>(own.words.size()));
    }
    return own;
}

// A job without the nodes' words, in the form that is sent to other ranks.
struct TorusJobHeader {
    raya_job header;
    bool has_patches;
    LengthScale scale;
    NodeBuffers buffers;
    std::uint64_t words, fullest_words, copies;
    std::uint32_t max_objects;
};

void send_to_ranks(const TorusJob& all, const NodeShare& share, Ranks& ranks) {
    const NodeMemories& m = all.memories;
    TorusJobHeader f{all.header_only.header(),
                     all.header_only.has_patches(),
                     all.scale,
                     all.buffers,
                     all.words,
                     all.fullest_words,
                     m.copies,
                     m.max_objects};
    ranks.broadcast(f);
    for (std::uint32_t rank = 1; rank < ranks.count(); ++rank) {
        const NodeMemories of_rank = select_memories(m, share.nodes_of(rank));
        ranks.send(rank, std::span<const std::uint32_t>(of_rank.starts));
        ranks.send(rank, std::span<const std::uint32_t>(of_rank.words));
    }
}

TorusJob receive_job(const NodeShare& share, Ranks& ranks) {
    TorusJobHeader f;
    ranks.broadcast(f);
    NodeMemories m;
    m.copies = f.copies;
    m.max_objects = f.max_objects;
    m.starts.resize(share.nodes() + 1);
    ranks.receive(0, std::span(m.starts));
    m.words.resize(m.starts.back());
    ranks.receive(0, std::span(m.words));
    return {header_only_job(f.header, f.has_patches), std::move(m), f.scale, f.buffers, f.words, f.fullest_words};
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

void check_packets(const TorusSettings& s, const Scene& scene) {
    for (std::uint32_t axis = 0; axis < 3; ++axis)
        if (s.voxels[axis] > RAYA_MAX_PLACES)
            throw UserError(
                fmt::format("--voxels {}: must be at most {} along an axis", sides_text(s.voxels), RAYA_MAX_PLACES));
    if (scene.lights.size() > RAYA_MAX_LIGHTS)
        throw UserError(fmt::format("{}: {} lights: the torus supports at most {}; use fewer, or a ring machine",
                                    scene.name, scene.lights.size(), RAYA_MAX_LIGHTS));
}

TorusSettings checked_settings(TorusSettings s, const Scene& scene, const DeviceInfo& device) {
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
                      filters_are_valid(s.format, job.header().extent),
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

NodeNeeds node_needs(const Scene& scene, const TorusSettings& s) {
    check_packets(s, scene);
    const LengthScale scale = length_scale(scene, s.format);
    const PackedJob job = pack_job(scene, job_settings(s, scale));
    const NodeMemories memories = pack_nodes(job, partition(job, s.format, s.voxels), s.torus);
    const std::uint64_t words = fullest_words(memories);
    const NodeBuffers buffers = buffers_of(scene, memories, s, {});
    return {scale, words, node_bytes(words, buffers, links_of_node(s.torus))};
}

DeviceMemory smallest_device_memory(const DeviceInfo& device, Ranks& ranks) {
    DeviceMemory smallest{device.global_memory_bytes, device.max_allocation_bytes};
    for (const DeviceMemory& other : ranks.all_gather(smallest))
        smallest = {std::min(smallest.total, other.total), std::min(smallest.max_buffer, other.max_buffer)};
    return smallest;
}

TorusJob make_torus_job(const Session& session, const Scene& scene, const TorusSettings& settings,
                        const NodeShare& share, const DeviceMemory& device, Ranks& ranks) {
    if (!ranks.first()) return receive_job(share, ranks);
    TorusJob all = divide_scene(session, scene, settings, share, device);
    if (!ranks.many()) return all;
    const SpanLog::Span span = session.span("send nodes");
    send_to_ranks(all, share, ranks);
    all.memories = select_memories(all.memories, share.own_nodes());
    return all;
}

}  // namespace raya
