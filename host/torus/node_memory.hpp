// Memories of the torus nodes: the part of the scene that each node stores (kernels/shared/node.h).
#pragma once
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "host/accel/partition.hpp"
#include "host/model/machine.hpp"
#include "host/scene/packer.hpp"
#include "host/torus/topology.hpp"
#include "kernels/shared/node.h"

namespace raya {

/// Sizes of the memories of all nodes.
struct NodeSizes {
    std::vector<std::uint64_t> words;  // [node]
    std::uint64_t copies = 0;          // number of voxel list entries minus number of distinct objects in them

    /// Returns the number of the node with the most words, the first of several.
    std::uint32_t fullest() const;
};
NodeSizes node_sizes(const PackedJob& job, const Partition& partition, const raya_torus& torus);

/// Throws UserError if `nodes` have more than 2^30 words in total.
void check_words(const NodeSizes& sizes, std::span<const std::uint32_t> nodes);

/// Words of some nodes, in the order of their slots.
struct NodeMemories {
    std::vector<std::uint32_t> words;   // words of the nodes, node after node
    std::vector<std::uint32_t> starts;  // [slots + 1]: index of each node's first word
};

/// Packs the words of `nodes`, which check_words() has accepted. The nodes' objects, surfaces, lights and headers have
/// the same words as in the job, except for offsets (fields named "..._at").
NodeMemories pack_nodes(const PackedJob& job, const Partition& partition, const raya_torus& torus,
                        std::span<const std::uint32_t> nodes);

// Sizes of the nodes' queues and mailboxes. Checks that they fit the memory of a node, and suggests remedies if not.

/// Returns the capacities of a queue of `queue` packets and of mailboxes of max(1, queue / 4) packets.
NodeBuffers buffers_for(std::uint32_t queue);

/// Returns the memory that a node needs, in bytes: `words` scene words, the queue of rays, an outbox and an inbox of
/// rays for each of `links` links, an inbox of returns for each link, and one outbox of returns for the return link.
/// The returns that have reached the root are not included, because they are in the host's memory.
std::uint64_t node_bytes(std::uint64_t words, const NodeBuffers& buffers, std::uint32_t links);

/// Returns the default capacity of a queue in packets: 8,192, or less for more than 2,048 nodes, so that all queues and
/// mailboxes together take less than 6 GB.
std::uint32_t default_queue(std::uint32_t nodes);

/// Chooses the capacity of the queues. If `queue` > 0, it is `queue` packets. If `queue` is 0, it is as many packets as
/// fit `memory_bytes` (empty: no limit) together with the words of the fullest node, at most default_queue().
/// buffers_for() determines the size of the mailboxes. Throws DoesNotFit if words and buffers exceed `memory_bytes`.
/// The message states how many nodes fit, the bytes of the fullest node, and a remedy: more memory or a shorter queue.
/// `min_queue`: number of packets that the ray tree of a single primary ray may need. Throws UserError if
/// 0 < `queue` < `min_queue`.
NodeBuffers plan_buffers(const std::string& scene, const NodeSizes& sizes, const raya_torus& torus,
                         std::optional<std::uint64_t> memory_bytes, std::uint32_t queue, std::uint32_t min_queue);

}  // namespace raya
