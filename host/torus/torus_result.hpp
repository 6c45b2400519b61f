// What comes of a render on the torus: packets, the nodes' work and supersteps for those that want to be told, the
// result, the work of its kernels and the modelled time of T805s.
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

/// A packet that leaves the node where it was made or changed, on its way to another one. A return that goes with
/// another one of its ray (TorusSettings::packets) is none.
struct PacketRecord {
    std::uint32_t superstep = 0, source = 0, destination = 0;  // nodes
    raya_head head{};
    std::uint32_t words = 0;  // that it is charged for on each link
};
using PacketSink = std::function<void(const PacketRecord&)>;

struct NodeWork {
    std::uint32_t node = 0;
    std::uint64_t injection_cycles = 0;       // for the primary rays that it made, and those that it looked at in vain
    std::span<const raya_treated> treated{};  // of each slot of its queue as it was before
    std::span<const raya_packet> queue{};     // as it is now: what was made or changed is RAYA_STATE_FRESH
};
using NodeWorkSink = std::function<void(const NodeWork&)>;

/// What was counted in one superstep, for time models and traces.
struct Superstep {
    std::uint64_t most_cycles = 0;      // computing, of the busiest node
    std::uint64_t most_link_words = 0;  // over one link in one direction, the busiest
    std::uint64_t live = 0;             // packets in queues and boxes at its end
};

/// What every node did in one superstep.
struct SuperstepDetail {
    const Superstep& all;
    std::vector<std::uint64_t> cycles;             // [node]: computing
    const std::vector<std::uint64_t>& link_words;  // [node][RAYA_LINKS]: sent over each link
};
using SuperstepSink = std::function<void(const SuperstepDetail&)>;

/// Packets of each kind (RAYA_KIND_* of kernels/shared/packet.h).
using PacketCounts = std::array<std::uint64_t, RAYA_KINDS>;

struct TorusResult {
    Image image;  // pixels outside the subset are 0
    EventCounts events{};
    Load load;  // modelled cycles of each node
    std::vector<Superstep> supersteps;
    PacketCounts made{}, ended{};
    std::uint64_t returns = 0;                        // that are messages of their own (TorusSettings::packets)
    std::uint64_t hops = 0;                           // messages over links
    std::vector<std::uint64_t> link_words;            // [node][RAYA_LINKS]: charged for over each link
    std::vector<std::uint64_t> link_packets;          // [node][RAYA_LINKS]: messages
    std::uint64_t moved_rays = 0, moved_returns = 0;  // packets over links, as the device moved them
    std::uint64_t queue_max = 0;                      // most packets that any node's queue held
    std::uint64_t copies = 0;                         // of objects in several voxels
    LengthScale scale;
    NodeBuffers buffers;
    std::uint64_t node_bytes = 0;    // of the fullest node: words and buffers
    std::uint64_t copied_words = 0;  // of the scene, by all nodes into local memory, whenever a kernel starts
    bool links_by_kernel = false;    // packets came over the device's links by a kernel, else by copies
    std::string links_origin;  // who chose: "options", the file and date of what was tuned, "measured", "defaults"
    std::uint64_t contributions = 0;  // return packets that reached the host
    std::uint32_t parts_here = 0;     // nodes of this rank
    RankTraffic traffic;              // of this rank, while it rendered
    std::uint32_t lanes = 0, group_size = 0;
    std::string build_options;
    std::string tuned;                 // where lanes, group and what goes with them come from (host/cl/tuned.hpp)
    double build_s = 0, render_s = 0;  // measured on the host: kernel build; everything after it
    std::vector<LabelSummary> commands;
};

/// The figures of a machine that has come to a stand before its image was done: its packets wait for each other's
/// links.
struct StandstillFigures {
    std::string scene;
    std::uint64_t superstep = 0;
    std::uint64_t live = 0;   // packets in the machine
    std::uint64_t full = 0;   // nodes whose queue is full, of
    std::uint32_t nodes = 0;  // so many
    std::uint32_t queue = 0;  // packets that a queue holds
};

/// A longer queue mends it; host/torus/buffer_plan.hpp finds one.
struct Standstill : UserError {
    explicit Standstill(const StandstillFigures& stand, const std::string& remedy = "use a longer queue");

    StandstillFigures figures;
};

/// One for each kernel. Events are counted for a node as a whole: those of primary rays are the operations of inject,
/// all others those of trace_voxel, the entry of primary rays into the box among them. Bytes, at least:
///   - trace_voxel, inject, route: at each launch the scene's words of all nodes, where kernels copy them;
///   - trace_voxel: a ray packet read for each voxel that one was tested in, a packet written for each one made that is
///     no primary ray; inject: a packet written for each primary ray;
///   - route: rays read and written for each link that they take, returns once; accept: each packet read and written
///     for each link;
///   - compose: each contribution read, each pixel's place read and its colour written.
/// Status and counters of nodes are not in it, nor packets that wait.
std::vector<KernelWork> torus_kernel_work(const TorusSettings& settings, const TorusResult& result);

/// The times of a render on `torus`, by machine/t805.hpp:
///   - overlapped: the busiest processor, which computes and has its part in every message that passes over one of its
///     links, or the busiest link, whichever takes longer. Nothing on that machine can be faster.
///   - stepwise: the sum over supersteps of what the busiest node computes and the busiest link carries, at the rate
///   that
///     is left to each way when both are busy. The processors' part of messages is hidden behind that: at most
///     12 ways x (2 + 19 / 8) cycles for a word of the busiest way, which takes 83 cycles on its link.
/// So overlapped <= stepwise. std::invalid_argument where `result` is not that torus's.
TorusTime torus_time(const raya_torus& torus, const TorusResult& result);

}  // namespace raya
