// Queue and boxes of a torus node, and what a node takes with them.
#pragma once
#include <cstdint>

namespace raya {

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

/// Packets: 8,192, fewer where there are more than 2,048 nodes, so that all queues and boxes stay below 6 GB.
std::uint32_t default_queue(std::uint32_t nodes);

}  // namespace raya
