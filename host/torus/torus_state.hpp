// State of a torus render between routing and the transfer of packets, for checkpoints. It does not depend on the
// number of ranks.
#pragma once
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "host/base/checkpoint.hpp"
#include "host/torus/node_distribution.hpp"
#include "host/torus/torus_result.hpp"
#include "host/torus/torus_settings.hpp"
#include "kernels/shared/packet.h"

namespace raya {

/// Number of free queue slots that a packet needs before a node accepts or processes it (kernels/shared/traffic.h).
enum class Reserve : std::uint32_t {
    kWholeTree,  // enough for the packet's whole ray tree
    kTight       // the minimum, used after a superstep without progress
};

/// Progress of a render, on the host.
struct TorusRun {
    std::uint32_t superstep = 0;
    std::uint32_t stalled = 0;  // consecutive supersteps without progress
    Reserve reserve = Reserve::kWholeTree;
    std::uint64_t max_live = 0;  // maximum number of live packets so far
    // Only in rank 0: counts of the finished supersteps; [node][RAYA_LINKS]: words charged for the link; returns that
    // have reached the host
    std::vector<Superstep> supersteps{};
    std::vector<std::uint64_t> link_words{};
    std::vector<raya_head> returns{};
};

/// Counts of the links of all nodes, [node][RAYA_LINKS].
struct LinkCounts {
    std::vector<std::uint64_t> messages;  // numbers of charged packets
    std::vector<std::uint64_t> packets;   // numbers of packets, including those that are not charged
};

/// State of the nodes of all ranks.
struct NodesState {
    std::vector<std::uint32_t> status;               // [node][RAYA_STATUS_WORDS]
    std::vector<std::uint64_t> events, made, ended;  // [node][RAYA_EVENTS], [node][RAYA_KINDS], [node][RAYA_KINDS]
    LinkCounts rays, returns;
    // Words of the packets of each node: those in the queue; in the mailboxes of rays, outbox and inbox of each link;
    // in the mailboxes of returns.
    std::vector<std::uint32_t> packets;
};

/// Returns the number of words of a node in NodesState::packets.
std::size_t packet_words(const NodeStatus& status, std::uint32_t node);

/// Contents of a checkpoint.
struct TorusState {
    TorusRun run;
    NodesState nodes;
    RenderedPart part;
};

/// Returns the bytes of a checkpoint file.
std::string state_bytes(const TorusRun& run, const NodesState& nodes, const RenderedPart& part,
                        const StateSettings& settings);

/// Reads a checkpoint of a machine of `nodes` nodes. Throws UserError as CheckpointReader does.
TorusState read_state(std::string_view bytes, const StateSettings& settings, std::uint32_t nodes,
                      const NodeBuffers& buffers);

}  // namespace raya
