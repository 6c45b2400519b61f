// Asynchronous model of the torus, without supersteps: nodes compute while links transfer messages, as the transputers
// of the paper do (Yoshitani & Yamazaki, section on the method). A discrete-event simulation replays the recorded
// history of a render.
//
// A node has one processor and two tasks (the paper's terms):
//   - The main task processes rays in the order of their arrival. It puts each new message into its own queue or into
//     the output port of a link. The main task is blocked as long as that port is full. If its queue is empty, it
//     generates the node's next primary ray, if one is left.
//   - The communication task has one input thread and one output thread for every link and for the main task. It
//     preempts the main task and handles one message at a time. A message of w words costs the sender's processor
//     `message_cycles` + w `word_cycles` before its transfer over the link, and the receiver's processor as much after
//     it.
// A link transfers one message at a time in each direction. Its rate is `one_way`, or half of `both_ways` while both
// directions are in use. Routing is store-and-forward, by raya_next_link for rays and raya_return_link for returns.
//
// Buffers are finite. An output thread holds up to `buffer` rays and `buffer` returns, an input thread one of each. The
// transfer of a message starts only when the input thread at the other end of the link has a free slot. Rays that wait
// for the main task are in the node's memory, which is unlimited; AsyncNode::queue_max is their maximum number.
//
// The machine cannot deadlock:
//   - Returns have separate slots, their routes form a tree, and the root accepts every return. So every return reaches
//     the root.
//   - Rays travel along the axes of the torus in a fixed order, so a ray waits only for rays on its own ring or on a
//     ring of a later axis. A ring always has a free slot: a ray advances within a ring if the next output thread has
//     one free slot. It enters the ring, from the main task or another axis, only if `entry_slots` = 2 slots are free.
//     This is bubble flow control (V. Puente et al., "The Adaptive Bubble Router", J. Parallel and Distributed
//     Computing 61, 2001).
//   - The main task's queue accepts every arriving ray, even while the main task waits for a port.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "host/model/t805.hpp"
#include "host/model/time_model.hpp"
#include "host/torus/history.hpp"
#include "kernels/shared/torus.h"

namespace raya {

struct AsyncMachine {
    double cycle_ns = kT805CycleNs;  // cycle time of a processor
    std::uint32_t message_cycles = kT805MessageCycles, word_cycles = kT805MessageWordCycles;  // see above
    double one_way = kT805OneWayBytesPerS, both_ways = kT805BothWaysBytesPerS;  // bytes/s; 0: transfers take no time
    std::uint32_t buffer = 4;       // number of slots of an output thread for rays, and for returns; >= `entry_slots`
    std::uint32_t entry_slots = 2;  // number of free slots that a ray needs to enter a ring; 1 allows deadlocks
};

struct AsyncNode {
    double compute_ms = 0, messages_ms = 0;  // processor times of the main task and of the communication task
    double port_ms = 0;                      // time for which a full port blocked the main task
    std::uint64_t queue_max = 0;             // maximum number of rays waiting for the main task
};

struct AsyncLink {
    double busy_ms = 0;                     // total time of the transfers
    std::uint64_t messages = 0, words = 0;  // numbers of transferred messages and of their words
};

struct AsyncResult {
    double finish_ms = 0;         // time at which the last task has ended and the last return is delivered
    std::uint64_t delivered = 0;  // number of delivered messages
    std::vector<AsyncNode> nodes;
    std::vector<AsyncLink> links;  // [node][RAYA_LINKS], each in the direction away from the node

    /// Returns the maxima over the nodes and links.
    AsynchronousTime time() const;
};

/// Simulates the history on the machine, deterministically. Throws UserError if buffer < entry_slots or
/// entry_slots is 0, std::logic_error for an invalid history (check_history), and std::runtime_error on a deadlock,
/// which is impossible with `entry_slots` >= 2.
AsyncResult simulate(const raya_torus& torus, const History& history, const AsyncMachine& machine = {});

/// Returns SimGrid's platform file (XML). It has a host for each node, named by the node's number, which executes one
/// operation per cycle. It has a SimGrid link for each direction of a wire, and another SimGrid link for the bandwidth
/// that both directions share. Routes are only between neighbours, because routing is store-and-forward. SimGrid's own
/// torus (<cluster topology="TORUS">) is not suitable: a message would occupy all links of its route at once, and the
/// two directions would not share bandwidth.
std::string simgrid_platform(const raya_torus& torus, const AsyncMachine& machine);

/// Returns the replay file in the format that tools/simgrid/replay.cpp documents.
std::string simgrid_replay(const raya_torus& torus, const History& history, const AsyncMachine& machine);

}  // namespace raya
