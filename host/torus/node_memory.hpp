// What each node of the torus holds (kernels/shared/node.h): packed, and weighed against its memory.
#pragma once
#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "host/cl/device.hpp"
#include "host/grid/partition.hpp"
#include "host/scene/packer.hpp"
#include "kernels/shared/node.h"

namespace raya {

struct NodeMemories {
    std::vector<std::uint32_t> words;   // of all nodes, one after another
    std::vector<std::uint32_t> starts;  // [nodes + 1]: where each node's words start
    std::uint64_t copies = 0;        // objects in voxels beyond each one's first; planes, which all hold, not counted
    std::uint32_t most_objects = 0;  // in one node, planes among them
};

/// Cuts the job up. Every word that a kernel reads of an object, surface, light or header is the job's, but for "at"
/// words. UserError where that makes more than 2^30 words.
NodeMemories pack_nodes(const PackedJob& job, const Partition& partition, const raya_torus& torus);

/// Words of the fullest node that pack_nodes would make, without making them.
std::uint64_t fullest_node_words(const PackedJob& job, const Partition& partition, const raya_torus& torus);

/// The same job on another number of nodes: words of its fullest node, and into which voxels the box was cut.
struct TrialNodes {
    std::uint64_t words = 0;
    Divisions voxels{};
};
using NodeTrial = std::function<std::optional<TrialNodes>(const std::array<std::uint32_t, 3>& nodes)>;

/// A trial that doubles `voxels` along each axis until every node has one; empty where the scene cannot be cut up so
/// far. It refers to the job.
NodeTrial trial_of(const PackedJob& job, const NumberFormat& format, const Divisions& voxels);

/// Buffers of a node beside its words, in packets of 16 words (kernels/shared/packet.h).
struct NodeBuffers {
    std::uint32_t queue = 0;  // packets that wait in the node
    std::uint32_t box = 0;    // packets in one outbox or one inbox
};

/// A queue and its boxes: a quarter of it, 1 at least.
NodeBuffers buffers_for(std::uint32_t queue);

/// Bytes of a node: its words, its queue of rays, an outbox and an inbox of rays for each of its links, an inbox of
/// returns for each and one outbox for the link home. What the root hands to the host lies in the host's memory.
std::uint64_t node_bytes(std::uint64_t words, const NodeBuffers& buffers, std::uint32_t links);

/// Links of each node that lead to another node: 6, 4, or fewer where a side of the torus is 1.
std::uint32_t links_of_node(const raya_torus& torus);

/// The queue asked for (`queue` > 0), or as many packets as the memory leaves beside the fullest node's words, at most
/// default_queue(); boxes as buffers_for() says.
/// UserError where words or buffers do not fit `memory_bytes` (empty: no limit): how many of the nodes fit and how many
/// do not, the fullest one with its number, voxels, objects and bytes beside the limit; the remedy: how many nodes
/// would do (found by `trial`, in a second or so; without one that is left out), or how much memory. UserError too
/// where the queue is shorter than `fewest` packets, which the tree of a single ray can ask for: the message names that
/// number.
NodeBuffers plan_buffers(const std::string& scene, const NodeMemories& memories, const raya_torus& torus,
                         std::optional<std::uint64_t> memory_bytes, std::uint32_t queue, std::uint32_t fewest,
                         const NodeTrial& trial = {});

/// UserError where the device cannot hold the queues and boxes of all nodes; it names the longest queue that it can.
void check_device_memory(const std::string& scene, const NodeBuffers& buffers, std::uint32_t nodes,
                         const DeviceInfo& device);

/// Packets: 8,192, fewer where there are more than 2,048 nodes, so that all queues and boxes stay below 6 GB.
std::uint32_t default_queue(std::uint32_t nodes);

}  // namespace raya
