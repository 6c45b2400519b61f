// Results of a render on the torus: records for observers of packets, supersteps and the work of nodes, the image and
// its counts, the work of kernels, and the modelled time on T805s.
#pragma once
#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "host/cl/profile.hpp"
#include "host/error.hpp"
#include "host/image/image.hpp"
#include "host/model/machine.hpp"
#include "host/model/time_model.hpp"
#include "host/ranks/ranks.hpp"
#include "host/report/roofline.hpp"
#include "host/scene/length_scale.hpp"
#include "host/torus/torus_settings.hpp"
#include "kernels/shared/packet.h"
#include "kernels/shared/torus.h"
#include "kernels/shared/traffic.h"

namespace raya {

/// A packet that leaves the node that made or changed it. There is no record of a return that travels within another
/// one of its ray (TorusSettings::packets).
struct PacketRecord {
    std::uint32_t superstep = 0, source = 0, destination = 0;  // source, destination: nodes
    raya_head head{};
    std::uint32_t words = 0;  // charged for on each link
};
using PacketSink = std::function<void(const PacketRecord&)>;

/// Work of a node in a superstep.
struct NodeWork {
    std::uint32_t node = 0;
    std::uint64_t injection_cycles = 0;           // for the primary rays that it made or discarded
    std::span<const raya_processed> processed{};  // [slot of the queue before the superstep]
    std::span<const raya_packet> queue{};         // after it; RAYA_STATE_FRESH marks new and changed packets
};
using NodeWorkSink = std::function<void(const NodeWork&)>;

/// Counts of a superstep, for time models and traces.
struct Superstep {
    std::uint64_t max_node_cycles = 0;  // computation of the busiest node
    std::uint64_t max_link_words = 0;   // over the busiest link, in one direction
    std::uint64_t live = 0;             // packets in queues and mailboxes at its end
};

/// Counts of a superstep by node.
struct SuperstepDetail {
    const Superstep& all;
    std::vector<std::uint64_t> cycles;             // [node]: computation
    const std::vector<std::uint64_t>& link_words;  // [node][RAYA_LINKS]: sent over each link
};
using SuperstepSink = std::function<void(const SuperstepDetail&)>;

/// Callbacks for the events of a render; empty ones are not called. In several ranks, only rank 0 calls them.
struct RenderObservers {
    PacketSink packets{};             // each packet between nodes, ordered by superstep, then by source
    std::uint32_t packets_every = 1;  // only packets of supersteps 0, packets_every, ...: reading them takes time
    SuperstepSink supersteps{};       // each superstep
    NodeWorkSink work{};              // work of each node in each superstep; needs TorusSettings::history and one rank
};

/// Number of packets of each kind (RAYA_KIND_* of kernels/shared/packet.h).
using PacketCounts = std::array<std::uint64_t, RAYA_KINDS>;

struct TorusResult {
    Image image;  // pixels outside the subset are 0
    EventCounts events{};
    Load load;  // modelled cycles of each node
    std::vector<Superstep> supersteps;
    PacketCounts made{}, ended{};
    std::uint64_t returns = 0;                        // charged as messages of their own (TorusSettings::packets)
    std::uint64_t hops = 0;                           // messages over links
    std::vector<std::uint64_t> link_words;            // [node][RAYA_LINKS]: charged for over each link
    std::vector<std::uint64_t> link_packets;          // [node][RAYA_LINKS]: messages
    std::uint64_t moved_rays = 0, moved_returns = 0;  // packets that the device moved over links
    std::uint64_t queue_max = 0;                      // maximum length of a queue, packets
    std::uint64_t copies = 0;                         // of objects that lie in several voxels
    LengthScale scale;
    NodeBuffers buffers;
    std::uint64_t node_bytes = 0;     // of the fullest node: words and buffers
    std::uint64_t copied_words = 0;   // words that all nodes copy into local memory at each start of a kernel
    bool links_by_kernel = false;     // a kernel transferred packets over links, else copies
    std::string links_origin;         // of that choice: "options", file and date of a tuning, "measured" or "defaults"
    std::uint64_t contributions = 0;  // return packets that reached the host
    std::uint32_t parts_here = 0;     // nodes of this rank
    RankTraffic traffic;              // of this rank during the render
    std::uint32_t lanes = 0, group_size = 0;
    std::string build_options;
    std::string tuned;                 // origin of lanes, group size and related settings (host/cl/tuned.hpp)
    double build_s = 0, render_s = 0;  // measured on the host: kernel build; everything after it
    std::vector<LabelSummary> commands;
};

/// State of a machine in a deadlock: no packet can move, since nodes wait for each other's links.
struct DeadlockFigures {
    std::string scene;
    std::uint64_t superstep = 0;
    std::uint64_t live = 0;   // packets in the machine
    std::uint64_t full = 0;   // nodes whose queue is full
    std::uint32_t nodes = 0;  // all nodes
    std::uint32_t queue = 0;  // capacity of a queue, packets
};

/// A deadlock of the torus. The remedy is a longer queue; find_longer_queue() finds one (host/torus/buffer_plan.hpp).
struct TorusDeadlock : UserError {
    explicit TorusDeadlock(const DeadlockFigures& state, const std::string& remedy = "use a longer queue");

    DeadlockFigures figures;
};

/// Work of each kernel. Events are counted for a node as a whole: those of making primary rays count as operations of
/// inject, all others as operations of trace_voxel, including the entry of primary rays into the bounding box. Bytes
/// are lower bounds:
///   - trace_voxel, inject, route: at each launch the words of all nodes, if kernels copy them;
///   - trace_voxel: a ray packet read for each voxel in which it was tested, a packet written for each one made except
///     primary rays; inject: a packet written for each primary ray;
///   - route: a ray read and written for each link that it takes, a return once; accept: each packet read and written
///     for each link;
///   - compose: each contribution read; of each pixel the start read and the colour written.
/// The status and counters of nodes and waiting packets are not included.
std::vector<KernelWork> torus_kernel_work(const TorusSettings& settings, const TorusResult& result);

/// Modelled times of a render on `torus` (host/model/t805.hpp):
///   - overlapped: the busiest processor (computation and its part of every message over its links) or the busiest
///     link, whichever takes longer. A lower bound for that machine.
///   - stepwise: the sum over supersteps of the busiest node's computation and the busiest link's transfers, at the
///     rate of a link with both directions in use. The transfers hide the processors' part of messages: at most 12 link
///     directions x (2 + 19 / 8) cycles for a word of the busiest direction, which takes 83 cycles on its link.
/// So overlapped <= stepwise. Throws std::invalid_argument if `result` is of another torus.
TorusTime torus_time(const raya_torus& torus, const TorusResult& result);

}  // namespace raya
