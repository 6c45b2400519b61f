// Asynchronous model of the torus, without supersteps: nodes compute while links transfer messages, as the transputers
// of the paper do (Yoshitani & Yamazaki, section on the method). A discrete-event simulation replays the recorded
// history of a render.
//
// A node has one processor and two tasks (the paper's terms):
//   - The main task processes rays in the order of their arrival. It puts a new message for the same node into the main
//     task's queue, and any other new message into the port of a link. As long as the port is full, the main task is
//     blocked. If the queue is empty, the main task generates the node's next primary ray, if one is left.
//   - The communication task has one input thread and one output thread for every link and for the main task. It
//     preempts the main task and handles one message at a time. A message of w words costs the sender's processor
//     `message_cycles` + w `word_cycles` before its transfer over the link. After the transfer it costs the receiver's
//     processor the same number of cycles.
// A link transfers one message at a time in each direction. The rate of a direction is `one_way`; while both directions
// are in use, it is half of `both_ways`. Routing is store-and-forward, by raya_next_link for rays and raya_return_link
// for returns.
//
// Buffers are finite. The port of a link is the buffer of its output thread: it has `buffer` slots for rays and
// `buffer` slots for returns. An input thread has one slot for a ray and one for a return. The transfer of a message
// starts only when the input thread at the end of the link has a free slot. Rays that wait for the main task are in the
// node's memory, which is unlimited; AsyncNode::queue_max is their maximum number.
//
// The machine cannot deadlock:
//   - Returns have separate slots, their routes form a tree, and the root accepts every return. So every return reaches
//     the root.
//   - A ring of the torus is a line of nodes along an axis, which the wrap-around link closes to a circle. Rays travel
//     along the axes in a fixed order, so a ray waits only for rays on its own ring or on a ring of a later axis. A ray
//     advances within a ring if the next port has one free slot. A ray enters a ring, from the main task or from
//     another axis, only if the port has `entry_slots` = 2 free slots. So a ring always has a free slot. This method is
//     called bubble flow control (V. Puente et al., "The Adaptive Bubble Router", J. Parallel and Distributed Computing
//     61, 2001).
//   - The main task's queue accepts every arriving ray, even if a full port blocks the main task.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "host/model/t805.hpp"
#include "host/torus/history.hpp"
#include "kernels/shared/torus.h"

namespace raya {

/// Parameters of the machine.
struct AsyncMachine {
    double cycle_ns = kT805CycleNs;                      // cycle time of a processor
    double primary_factor = 1;                           // factor of the cycles in which a node makes primary rays
    std::uint32_t message_cycles = kT805MessageCycles;   // processor cycles per message at each end of a link
    std::uint32_t word_cycles = kT805MessageWordCycles;  // processor cycles per word at each end of a link
    double one_way = kT805OneWayBytesPerS;               // rate of a link in one direction, bytes/s; 0: infinite
    double both_ways = kT805BothWaysBytesPerS;           // rate of a link, sum of both directions, bytes/s
    std::uint32_t buffer = 4;       // number of slots of a port for rays, and for returns; >= `entry_slots`
    std::uint32_t entry_slots = 2;  // number of free slots that a ray needs to enter a ring; 1 allows deadlocks
};

/// Times of a node.
struct AsyncNode {
    double compute_ms = 0, messages_ms = 0;  // processor times of the main task and of the communication task
    double port_ms = 0;                      // total time for which full ports blocked the main task
    std::uint64_t queue_max = 0;             // maximum number of rays waiting for the main task
};

/// Traffic of one direction of a link.
struct AsyncLink {
    double busy_ms = 0;                     // total time of the transfers
    std::uint64_t messages = 0, words = 0;  // numbers of transferred messages and of their words
};

/// Result of simulate().
struct AsyncResult {
    double finish_ms = 0;         // time at which the last task has ended and the last return is delivered
    std::uint64_t delivered = 0;  // number of delivered messages, including those from a node to itself
    std::vector<AsyncNode> nodes;
    std::vector<AsyncLink> links;  // [node][RAYA_LINKS], each in the direction away from the node

    /// Returns the maxima over the nodes and links.
    AsynchronousTime time() const;
};

/// Simulates the history on the machine, deterministically. Throws UserError if buffer < entry_slots or entry_slots is
/// 0, and std::runtime_error on a deadlock, which is impossible with `entry_slots` >= 2.
AsyncResult simulate(const raya_torus& torus, const History& history, const AsyncMachine& machine = {});

}  // namespace raya
