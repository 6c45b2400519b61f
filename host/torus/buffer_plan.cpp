#include "host/torus/buffer_plan.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <numeric>

#include "host/error.hpp"
#include "host/model/unit_text.hpp"
#include "host/scene/packer.hpp"
#include "host/torus/node_memory.hpp"
#include "host/torus/topology.hpp"
#include "kernels/shared/packet.h"

namespace raya {
namespace {

// Returns the queue length to try after `queue`. It is the longest queue that fits a node if that is longer than
// `queue` and shorter than twice `queue`, else twice `queue`.
std::uint32_t next_queue(std::uint32_t queue, const QueueTrial& trial) {
    const auto fits = [&](std::uint32_t length) { return trial.node_bytes(buffers_for(length)) <= trial.node_memory; };
    const std::uint32_t next = std::min(2 * queue, trial.max_queue);
    if (!fits(queue) || fits(next)) return next;
    const std::uint32_t longest = largest_where(queue, next, fits);
    return longest > queue ? longest : next;
}

// Maximum number of entries in the voxels' lists of a trial. A trial with so many entries takes a fraction of a second.
constexpr std::uint64_t kMaxTrialEntries = std::uint64_t{1} << 24;

std::uint64_t voxels_of(const Divisions& divisions) {
    return std::uint64_t{divisions[0]} * divisions[1] * divisions[2];
}

// See make_node_trial().
class PartitionTrial {
  public:
    PartitionTrial(const PackedJob& job, const NumberFormat& format, const Divisions& voxels)
        : job_(job), format_(format), voxels_(voxels) {}

    std::optional<NodeTrialResult> operator()(const std::array<std::uint32_t, 3>& nodes) {
        NodeTrialResult result{0, voxels_};
        for (std::size_t axis = 0; axis < 3; ++axis)
            while (result.voxels[axis] < nodes[axis]) result.voxels[axis] *= 2;
        const std::uint64_t voxels = voxels_of(result.voxels);
        if (voxels > kMaxPartitionVoxels || objects_everywhere_ * voxels > kMaxTrialEntries) return {};
        try {
            const Partition tried_partition = partition(job_, format_, result.voxels);
            const bool all_everywhere = tried_partition.objects.size() == tried_partition.listed_objects * voxels;
            objects_everywhere_ = all_everywhere ? tried_partition.listed_objects : 0;
            // The assignment of voxels to nodes does not depend on the links.
            const NodeSizes sizes = node_sizes(job_, tried_partition, make_torus(nodes, Links::kTorus3d));
            result.words = sizes.words[sizes.fullest()];
            return result;
        } catch (const TooManyEntries&) {
            return {};
        }
    }

  private:
    const PackedJob& job_;
    const NumberFormat format_;
    const Divisions voxels_;
    // Number of objects if the last trial registered every object in every voxel, else 0. A partition for a format
    // without an error bound registers every object in every voxel, for any number of voxels. Then more nodes do not
    // reduce the words of a node, and the lists become long.
    std::uint64_t objects_everywhere_ = 0;
};

constexpr std::uint64_t kPacketBytes = RAYA_PACKET_WORDS * sizeof(std::uint32_t);
constexpr std::uint64_t kReturnBytes = RAYA_RETURN_WORDS * sizeof(std::uint32_t);

// Returns the longest queue in [min_queue, max_queue] with which the queue, the mailboxes and `words` words fit
// `memory` bytes. The queue `min_queue` must fit.
std::uint32_t longest_queue(std::uint64_t words, std::uint32_t links, std::uint64_t memory, std::uint32_t min_queue,
                            std::uint32_t max_queue) {
    return largest_where(min_queue, std::uint64_t{max_queue} + 1,
                         [&](std::uint32_t queue) { return node_bytes(words, buffers_for(queue), links) <= memory; });
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

// Doubles the first of the shortest sides.
std::array<std::uint32_t, 3> doubled(std::array<std::uint32_t, 3> nodes) {
    *std::min_element(nodes.begin(), nodes.end()) *= 2;
    return nodes;
}

// Returns options such as "--nodes 16x16x8", with which the scene fits; empty if it does not fit any machine of up to
// 65,536 nodes.
std::string larger_machine_options(const MemoryDemand& demand, const NodeTrial& trial) {
    const std::uint32_t* const present_nodes = demand.torus.nodes;
    // A torus with sides I x J x 1 may be 2-D or 3-D. It is taken as 3-D, because a 3-D torus needs at least as much
    // memory.
    const Links links = demand.torus.sides[2] != present_nodes[2] ? Links::kTorus2d : Links::kTorus3d;
    const std::uint64_t all_words = std::accumulate(demand.sizes.words.begin(), demand.sizes.words.end(), 0ull);
    std::array<std::uint32_t, 3> nodes = doubled({present_nodes[0], present_nodes[1], present_nodes[2]});
    for (std::uint64_t count = 2 * demand.nodes(); count <= kMaxNodes; count *= 2, nodes = doubled(nodes)) {
        const std::uint32_t node_links = links_of_node(make_torus(nodes, links));
        const auto fits = [&](std::uint64_t words) {
            return node_bytes(words, demand.buffers, node_links) <= demand.limit;
        };
        // Smaller voxels only add copies of objects, so an even division of the present words is a lower bound.
        if (!fits(all_words / count)) continue;
        const std::optional<NodeTrialResult> result = trial(nodes);
        if (result && fits(result->words))
            return fmt::format("--nodes {}{}", sides_text(nodes),
                               result->voxels == nodes ? "" : " --voxels " + sides_text(result->voxels));
    }
    return {};
}

std::string remedies(const MemoryDemand& demand, std::uint64_t words, std::uint32_t min_queue, const NodeTrial& trial) {
    const std::uint32_t links = links_of_node(demand.torus);
    const std::uint64_t whole_kb = (demand.bytes(words) + 1023) / 1024;
    const std::string memory = fmt::format("--pe-memory {}", 1024 * whole_kb);
    if (node_bytes(words, buffers_for(min_queue), links) <= demand.limit)
        return fmt::format("use --queue {} or {}",
                           longest_queue(words, links, demand.limit, min_queue, demand.buffers.queue), memory);
    if (!trial) return "use " + memory;
    const std::string machine = larger_machine_options(demand, trial);
    if (machine.empty()) return fmt::format("no machine of up to {} nodes is large enough; use {}", kMaxNodes, memory);
    return fmt::format("use {} or {}", machine, memory);
}

[[noreturn]] void throw_does_not_fit(const MemoryDemand& demand, std::uint32_t min_queue, const NodeTrial& trial) {
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
                    remedies(demand, words, min_queue, trial)),
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

QueueSearchResult find_longer_queue(std::uint32_t queue, const QueueTrial& trial) {
    QueueSearchResult found{.queue = queue};
    try {
        while (!found.completes && found.queue < trial.max_queue) {
            const std::uint32_t next = next_queue(found.queue, trial);
            const NodeBuffers buffers = buffers_for(next);
            if (!trial.fits_device(buffers)) break;
            found.completes = trial.completes(buffers);
            found.queue = next;
        }
    } catch (const DeviceError&) {  // the device cannot allocate queues of this length
    }
    found.bytes = trial.node_bytes(buffers_for(found.queue));
    found.fits = found.bytes <= trial.node_memory;
    return found;
}

std::string queue_remedy(const QueueSearchResult& found) {
    if (!found.completes)
        return fmt::format(
            "no queue up to {} packets is long enough, and the device cannot hold longer ones; use fewer nodes",
            found.queue);
    if (found.fits) return fmt::format("--queue {} is long enough (tried)", found.queue);
    return fmt::format("no queue that fits a node's memory is long enough; use --queue {} --pe-memory {} (tried)",
                       found.queue, (found.bytes + 1023) / 1024 * 1024);
}

NodeTrial make_node_trial(const PackedJob& job, const NumberFormat& format, const Divisions& voxels) {
    return PartitionTrial(job, format, voxels);
}

NodeBuffers plan_buffers(const std::string& scene, const NodeSizes& sizes, const raya_torus& torus,
                         std::optional<std::uint64_t> memory_bytes, std::uint32_t queue, std::uint32_t min_queue,
                         const NodeTrial& trial) {
    min_queue = std::max(1u, min_queue);
    if (queue > 0 && queue < min_queue)
        throw UserError(
            fmt::format("{}: --queue {}: the tree of a single ray may need {} packets; use --queue {} or more", scene,
                        queue, min_queue, min_queue));
    const std::uint32_t max_queue = queue > 0 ? queue : std::max(default_queue(raya_nodes(torus)), min_queue);
    if (!memory_bytes) return buffers_for(max_queue);
    const MemoryDemand demand{scene, sizes, torus, *memory_bytes, buffers_for(queue > 0 ? queue : min_queue)};
    const std::uint64_t words = sizes.words[sizes.fullest()];
    if (demand.bytes(words) > *memory_bytes) throw_does_not_fit(demand, min_queue, trial);
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
