#include "host/torus/torus_plan.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cstddef>

#include "host/base/encoding.hpp"
#include "host/cl/kernel_options.hpp"
#include "host/error.hpp"
#include "host/scene/packer.hpp"
#include "host/torus/topology.hpp"
#include "host/version.hpp"
#include "kernels/shared/packet.h"
#include "kernels/shared/traffic.h"

namespace raya {
namespace {

PackedJob packed_job(const Session& session, const Scene& scene, const TorusSettings& settings,
                     const LengthScale& scale) {
    const SpanLog::Span span = session.span("pack scene");
    return pack_job(scene, job_settings(settings, scale));
}

// Returns a job that contains a header and no objects.
PackedJob header_only_job(const raya_job& header, bool has_patches) {
    PackedJob job(header, std::vector<std::uint32_t>(kWordsOf<raya_job>), has_patches);
    job.set_header(header);
    return job;
}

NodeBuffers buffers_of(const Scene& scene, const NodeSizes& sizes, const TorusSettings& s) {
    return plan_buffers(scene.name, sizes, s.torus, s.memory_bytes, s.queue,
                        raya_min_queue(static_cast<std::uint32_t>(scene.lights.size()), s.bounces));
}

// The part of a TorusJob that is the same in all ranks: all but the nodes' words and their starts.
struct TorusJobHeader {
    raya_job header;
    bool has_patches;
    LengthScale scale;
    NodeBuffers buffers;
    std::uint64_t fullest_words, copies;
};

TorusJob with_memories(const TorusJobHeader& h, NodeMemories memories) {
    return {
        header_only_job(h.header, h.has_patches), std::move(memories), h.scale, h.buffers, h.fullest_words, h.copies};
}

// Writes windows of all nodes into the headers of `nodes`.
void set_windows(NodeMemories& memories, const std::vector<PixelWindow>& windows,
                 const std::vector<std::uint32_t>& nodes) {
    for (std::size_t slot = 0; slot < nodes.size(); ++slot)
        put_record(memories.words, memories.starts[slot] + offsetof(raya_node, window) / sizeof(std::uint32_t),
                   windows[nodes[slot]]);
}

// Packs the scene, divides it among all nodes, and sends each rank the words of its nodes. Returns this rank's job. The
// words of other ranks' nodes are packed rank by rank, so that this rank never holds all of them.
TorusJob divide_scene(const Session& session, const Scene& scene, const TorusSettings& s,
                      const NodeDistribution& distribution, const DeviceMemory& device, Ranks& ranks,
                      const std::function<void()>& packed) {
    const LengthScale scale = length_scale(scene, s.format);
    const PackedJob job = packed_job(session, scene, s, scale);
    if (packed) packed();
    const SpanLog::Span span = session.span("divide scene");
    const Partition partition = raya::partition(job, s.format, s.voxels);
    const NodeSizes sizes = node_sizes(job, partition, s.torus);
    for (std::uint32_t rank = 0; rank < ranks.count(); ++rank) check_words(sizes, distribution.pes_of(rank));
    const NodeBuffers buffers = buffers_of(scene, sizes, s);
    check_device_memory(scene.name, buffers, distribution.max_count(), session.device().name, device);
    const std::vector<PixelWindow> windows = pixel_windows(job.header(), partition.grid, s.torus, s.format);
    TorusJobHeader header{job.header(), job.has_patches(), scale, buffers, sizes.words[sizes.fullest()], sizes.copies};
    const auto memories_of = [&](std::uint32_t rank) {
        const std::vector<std::uint32_t>& nodes = distribution.pes_of(rank);
        NodeMemories memories = pack_nodes(job, partition, s.torus, nodes);
        set_windows(memories, windows, nodes);
        return memories;
    };
    if (ranks.has_several()) ranks.broadcast(header);
    for (std::uint32_t rank = 1; rank < ranks.count(); ++rank) {
        const NodeMemories memories = memories_of(rank);
        ranks.send(rank, std::span<const std::uint32_t>(memories.starts));
        ranks.send(rank, std::span<const std::uint32_t>(memories.words));
    }
    return with_memories(header, memories_of(0));
}

TorusJob receive_job(const NodeDistribution& distribution, Ranks& ranks) {
    TorusJobHeader header;
    ranks.broadcast(header);
    NodeMemories m;
    m.starts.resize(distribution.count() + 1);
    ranks.receive(0, std::span(m.starts));
    m.words.resize(m.starts.back());
    ranks.receive(0, std::span(m.words));
    return with_memories(header, std::move(m));
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

void check_packet_fields(const TorusSettings& s, const Scene& scene) {
    for (std::uint32_t axis = 0; axis < 3; ++axis)
        if (s.voxels[axis] > RAYA_MAX_PLACES)
            throw UserError(
                fmt::format("--voxels {}: must be at most {} along an axis", sides_text(s.voxels), RAYA_MAX_PLACES));
    if (scene.lights.size() > RAYA_MAX_LIGHTS)
        throw UserError(fmt::format("{}: {} lights: the torus supports at most {}; use fewer, or a ring machine",
                                    scene.name, scene.lights.size(), RAYA_MAX_LIGHTS));
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
    const std::uint64_t words = sizes.words[sizes.fullest()];
    const NodeBuffers buffers = buffers_of(scene, sizes, s);
    return {scale, words, node_bytes(words, buffers, links_of_node(s.torus))};
}

DeviceMemory smallest_device_memory(const DeviceInfo& device, Ranks& ranks) {
    DeviceMemory smallest{device.global_memory_bytes, device.max_allocation_bytes};
    for (const DeviceMemory& memory : ranks.all_gather(smallest))
        smallest = {std::min(smallest.total, memory.total), std::min(smallest.max_buffer, memory.max_buffer)};
    return smallest;
}

TorusJob make_torus_job(const Session& session, const Scene& scene, const TorusSettings& settings,
                        const NodeDistribution& distribution, const DeviceMemory& device, Ranks& ranks,
                        const std::function<void()>& packed) {
    if (!ranks.is_first()) return receive_job(distribution, ranks);
    return divide_scene(session, scene, settings, distribution, device, ranks, packed);
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

}  // namespace raya
