#include "host/torus/buffer_plan.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <ranges>

#include "host/error.hpp"
#include "host/model/number_format.hpp"
#include "host/scene/packer.hpp"
#include "host/torus/node_memory.hpp"
#include "host/torus/topology.hpp"
#include "kernels/shared/packet.h"

namespace raya {
namespace {

constexpr std::uint64_t kPacketBytes = RAYA_PACKET_WORDS * sizeof(std::uint32_t);
constexpr std::uint64_t kReturnBytes = RAYA_RETURN_WORDS * sizeof(std::uint32_t);

// Returns the longest queue in [min_queue, max_queue] with which the queue, the mailboxes and `words` words fit
// `memory` bytes. The queue `min_queue` must fit.
std::uint32_t longest_queue(std::uint64_t words, std::uint32_t links, std::uint64_t memory, std::uint32_t min_queue,
                            std::uint32_t max_queue) {
    const auto fits = [&](std::uint32_t queue) { return node_bytes(words, buffers_for(queue), links) <= memory; };
    return *std::ranges::partition_point(std::views::iota(min_queue + 1, max_queue + 1), fits) - 1;
}

// Memory that the nodes need for a scene and their buffers, and memory that a node has.
struct MemoryDemand {
    const std::string& scene;
    const NodeSizes& sizes;
    const raya_torus& torus;
    std::uint64_t limit;  // memory of a node, bytes
    NodeBuffers buffers;

    std::uint32_t nodes() const { return raya_nodes(torus); }
    std::uint64_t bytes(std::uint64_t words) const { return node_bytes(words, buffers, links_of_node(torus)); }
};

// Returns text such as "node 219 (voxel 3, 3, 3 with 2310 objects)".
std::string node_text(const NodeSizes& sizes, const raya_torus& torus, std::uint32_t number) {
    const std::uint32_t count = raya_node_voxels(torus, sizes.grid, number);
    std::string voxels = counted(count, "voxel");
    if (count == 1) {
        const std::uint32_t voxel = raya_voxel_of_node(torus, sizes.grid, number, 0);
        const raya_place at = raya_place_of(voxel, sizes.grid.divisions[0], sizes.grid.divisions[1]);
        voxels = fmt::format("voxel {}, {}, {}", at.at[0], at.at[1], at.at[2]);
    }
    return fmt::format("node {} ({} with {})", number, voxels, counted(sizes.objects[number], "object"));
}

std::string remedies(const MemoryDemand& demand, std::uint64_t words, std::uint32_t min_queue) {
    const std::uint32_t links = links_of_node(demand.torus);
    const std::uint64_t whole_kb = (demand.bytes(words) + 1023) / 1024;
    const std::string memory = fmt::format("--pe-memory {}", 1024 * whole_kb);
    if (node_bytes(words, buffers_for(min_queue), links) > demand.limit) return "use more --nodes or " + memory;
    return fmt::format("use --queue {} or {}",
                       longest_queue(words, links, demand.limit, min_queue, demand.buffers.queue), memory);
}

[[noreturn]] void throw_does_not_fit(const MemoryDemand& demand, std::uint32_t min_queue) {
    const std::uint32_t fullest = demand.sizes.fullest();
    std::uint32_t fitting = 0;
    for (const std::uint64_t words : demand.sizes.words) fitting += demand.bytes(words) <= demand.limit;
    const std::uint64_t words = demand.sizes.words[fullest];
    throw NodesDoNotFit(
        fmt::format("{}: does not fit: {} of {} nodes can hold their voxels, {} cannot; {} needs {} for the "
                    "scene and {} for buffers, a node has {}; {}",
                    demand.scene, fitting, demand.nodes(), demand.nodes() - fitting,
                    node_text(demand.sizes, demand.torus, fullest), required_size_text(4 * words),
                    required_size_text(demand.bytes(0)), available_size_text(demand.limit),
                    remedies(demand, words, min_queue)),
        demand.bytes(words), demand.limit, demand.nodes(), fitting, fullest);
}

}  // namespace

NodeBuffers buffers_for(std::uint32_t queue) { return {queue, std::max(1u, queue / 4)}; }

std::uint32_t default_queue(std::uint32_t nodes) { return std::min(8192u, (1u << 24) / nodes); }

std::uint64_t node_bytes(std::uint64_t words, const NodeBuffers& buffers, std::uint32_t links) {
    const std::uint64_t return_boxes = links > 0 ? links + 1 : 0;
    return sizeof(std::uint32_t) * words + kPacketBytes * (buffers.queue + std::uint64_t{2} * links * buffers.box) +
           kReturnBytes * return_boxes * buffers.box;
}

NodeBuffers plan_buffers(const std::string& scene, const NodeSizes& sizes, const raya_torus& torus,
                         std::optional<std::uint64_t> memory_bytes, std::uint32_t queue, std::uint32_t min_queue) {
    min_queue = std::max(1u, min_queue);
    if (queue > 0 && queue < min_queue)
        throw UserError(
            fmt::format("{}: --queue {}: the tree of a single ray may need {} packets; use --queue {} or more", scene,
                        queue, min_queue, min_queue));
    const std::uint32_t max_queue = queue > 0 ? queue : std::max(default_queue(raya_nodes(torus)), min_queue);
    if (!memory_bytes) return buffers_for(max_queue);
    const MemoryDemand demand{scene, sizes, torus, *memory_bytes, buffers_for(queue > 0 ? queue : min_queue)};
    const std::uint64_t words = sizes.words[sizes.fullest()];
    if (demand.bytes(words) > *memory_bytes) throw_does_not_fit(demand, min_queue);
    return buffers_for(longest_queue(words, links_of_node(torus), *memory_bytes, demand.buffers.queue, max_queue));
}

bool fits_device(const NodeBuffers& buffers, std::uint32_t nodes, const DeviceMemory& memory) {
    const std::uint64_t queue_bytes = kPacketBytes * nodes * buffers.queue;
    const std::uint64_t box_bytes = kPacketBytes * RAYA_LINKS * nodes * (std::uint64_t{1} + buffers.box);
    const std::uint64_t all_bytes = queue_bytes + 2 * box_bytes + 2 * box_bytes * kReturnBytes / kPacketBytes;
    return std::max(queue_bytes, box_bytes) <= memory.max_buffer && all_bytes <= memory.total;
}

void check_device_memory(const std::string& scene, const NodeBuffers& buffers, std::uint32_t nodes,
                         const std::string& device, const DeviceMemory& memory) {
    if (fits_device(buffers, nodes, memory)) return;
    std::uint32_t queue = buffers.queue;
    while (queue > 1 && !fits_device(buffers_for(queue), nodes, memory)) queue /= 2;
    throw UserError(
        fmt::format("{}: queues of {} packets and their mailboxes in {} nodes do not fit the memory of {}; use "
                    "--queue {} or fewer nodes",
                    scene, buffers.queue, nodes, device, queue));
}

}  // namespace raya
