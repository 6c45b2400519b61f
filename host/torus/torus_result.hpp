// Results of a render on the torus: the image, counts, the work of kernels and the modelled time on T805 transputers.
// This file also declares the records that observers receive during a render.
#pragma once
#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "host/error.hpp"
#include "host/model/machine.hpp"
#include "host/model/t805.hpp"
#include "host/report/render_report.hpp"
#include "host/report/trace_file.hpp"
#include "host/torus/topology.hpp"
#include "kernels/shared/packet.h"
#include "kernels/shared/torus.h"
#include "kernels/shared/traffic.h"

namespace raya {

/// Record of a packet when it leaves the node that created or changed it. Returns that the model does not charge as
/// separate messages (PacketCharge::one_return_per_ray) have no record.
struct PacketRecord {
    std::uint32_t superstep = 0, source = 0, destination = 0;  // source, destination: nodes
    raya_head head{};
    std::uint32_t words = 0;  // number of words charged on each link of the packet's route
};
using PacketSink = std::function<void(const PacketRecord&)>;

/// Work of a node in a superstep.
struct NodeWork {
    std::uint32_t node = 0;
    std::uint64_t injection_cycles = 0;           // cycles for primary rays that the node generated or discarded
    std::span<const raya_processed> processed{};  // [slot of the queue before trace_voxel]: cost of the packet
    std::span<const raya_packet> queue{};         // queue after trace_voxel; RAYA_STATE_FRESH: packet new or changed
};
using NodeWorkSink = std::function<void(const NodeWork&)>;

/// Counts of a superstep, used by time models and traces.
struct Superstep {
    std::uint64_t max_node_cycles = 0;  // modelled cycles of the busiest node
    std::uint64_t max_link_words = 0;   // number of words sent over the busiest link, in one direction
    std::uint64_t live = 0;             // number of packets in queues and mailboxes at the superstep's end
};

/// Counts of a superstep, in total and for each node.
struct SuperstepDetail {
    const Superstep& all;
    std::vector<std::uint64_t> cycles;             // [node]: modelled cycles of the node
    const std::vector<std::uint64_t>& link_words;  // [node][RAYA_LINKS]: number of words sent over the link
};
using SuperstepSink = std::function<void(const SuperstepDetail&)>;

/// Callbacks during a render; an empty callback is not called. With several ranks, only rank 0 calls them.
struct RenderObservers {
    PacketSink packets{};  // called for each packet sent to another node, in the order of supersteps, then sources
    SuperstepSink supersteps{};  // called for each superstep
    NodeWorkSink work{};         // called for each node and superstep; needs TorusSettings::history and one rank
};

/// [RAYA_KIND_*]: name of the kind of packets, in files and reports.
inline constexpr std::array<const char*, RAYA_KINDS> kPacketKinds = {"",          "primary", "reflected",
                                                                     "refracted", "shadow",  "return"};

/// Number of packets of each kind (RAYA_KIND_* of kernels/shared/packet.h).
using PacketCounts = std::array<std::uint64_t, RAYA_KINDS>;

/// Result of a render.
struct TorusResult : RenderResult {  // pixels outside TorusSettings::pixels are 0
    std::vector<Superstep> supersteps;
    PacketCounts made{}, ended{};             // packets that nodes created, and packets that nodes processed to the end
    PacketCounts rank_made{};                 // packets that this rank's nodes created
    std::uint64_t returns = 0;                // number of returns charged as messages (TorusSettings::packets)
    std::uint64_t hops = 0;                   // sum of link_packets
    std::vector<std::uint64_t> link_words;    // [node][RAYA_LINKS]: number of words charged for the link
    std::vector<std::uint64_t> link_packets;  // [node][RAYA_LINKS]: number of messages over the link
    std::uint64_t sent_rays = 0, received_rays = 0;  // of this rank's nodes: numbers of packets over links
    std::uint64_t received_returns = 0;              // of this rank's nodes
    std::uint64_t queue_max = 0;                     // maximum number of packets in a queue
    std::uint64_t copies = 0;                        // Partition::copies()
    NodeBuffers buffers;
    std::uint64_t node_bytes = 0;     // number of bytes of the fullest node: words and buffers
    std::uint64_t copied_words = 0;   // number of words that this rank's nodes copy to local memory in each launch
    std::uint64_t contributions = 0;  // number of return packets that reached the host
};

/// Thrown if the torus is in a deadlock: no packet can move, because full nodes wait for each other. Longer queues
/// prevent the deadlock.
struct TorusDeadlock : UserError {
    TorusDeadlock(const std::string& message, std::uint32_t queue_capacity)
        : UserError(message), queue(queue_capacity) {}

    std::uint32_t queue;  // capacity of a queue, packets
};

/// Returns the work of each kernel of this rank. Nodes count events for all kernels together. Events of the generation
/// of primary rays count as operations of inject; all other events, including those of the entry of primary rays into
/// the bounding box, count as operations of trace_voxel. Bytes are lower bounds:
///   - trace_voxel, inject, route: read the words of all nodes in each launch, if kernels copy them to local memory;
///   - trace_voxel: reads a ray packet for each voxel in which the ray was tested, and writes each packet that it
///     creates; inject: writes a packet for each primary ray;
///   - route: reads and writes a ray for each link of its route, and a return once; accept: reads and writes each
///     packet once for each link;
///   - compose: reads each contribution and the start of each pixel, and writes the colour of each pixel.
/// Not included: the status and counters of nodes, and packets that wait.
std::vector<KernelWork> torus_kernel_work(const TorusSettings& settings, const TorusResult& result);

/// Returns modelled times of a render on `torus` (host/model/t805.hpp):
///   - overlapped: the time of the busiest processor (its computation and its work for every message over its links) or
///     of the busiest link, whichever is longer. A lower bound for a real machine.
///   - stepwise: the sum over supersteps of the busiest node's computation and the busiest link's transfers, at the
///     rate of a link with both directions in use. The processors' work for messages is not added, because it overlaps
///     with the transfers and is shorter. A processor works at most 12 link directions x (2 + 19 / 6) = 62 cycles
///     for each word over the busiest link direction (packets of 6 words). The word's transfer takes 83 cycles.
/// So overlapped <= stepwise.
TorusTime torus_time(const raya_torus& torus, const TorusResult& result);

// State of a torus render on the host.

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
    std::uint64_t max_live = 0;        // maximum number of live packets so far
    TorusResult result{};              // only in rank 0: supersteps and link_words, of the finished supersteps
    std::vector<raya_head> returns{};  // only in rank 0: returns that have reached the host
};

// The torus's part of a render report.

/// Returns nodes, packets, links, operations and modelled time. `asynchronous`: the time of the machine without
/// supersteps, if it was simulated.
MachineReport torus_report(const TorusSettings& settings, const TorusResult& result,
                           const std::optional<AsynchronousTime>& asynchronous);

/// Lists the members of the torus's part of a render report.
void torus_members(Members& m, const TorusSettings& settings, const TorusResult& result, const TorusTime& time);

/// Lists the numbers of operations of all counted events on T805s (host/model/t805.hpp).
void t805_members(Members& m, const EventCounts& events, const PacketCharge& packets);

// Trace of the modelled torus: the work of each node in each superstep, in modelled time.

/// Adds a track for the supersteps and a track for each of `nodes` nodes to `trace`, from time 0 on, in the stepwise
/// time of torus_time(): in each superstep a node computes and waits for the busiest node, then it sends and waits for
/// the busiest link. Counters: live packets, load imbalance u of the superstep, words over the busiest link and mean
/// words over a link. `cycles`, [superstep][node], and `link_words`, [superstep][node][RAYA_LINKS], are those of the
/// same render (SuperstepDetail). If `nodes` is 0, adds only a remark to the metadata.
void add_torus_machine(TraceFile& trace, const raya_torus& torus, const TorusResult& result,
                       const std::vector<std::uint64_t>& cycles, const std::vector<std::uint64_t>& link_words,
                       std::size_t nodes);

}  // namespace raya
