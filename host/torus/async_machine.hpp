// Asynchronous model of the torus, without supersteps: nodes compute while links carry messages, as the paper's
// transputers do (Yoshitani & Yamazaki, method). Discrete-event simulation over the history of a render.
//
// A node has one processor and two tasks (the paper's terms):
//   - The main task processes rays in the order of their arrival. It puts new messages into its own queue or into the
//     output port of a link, and blocks while that port is full. When its queue is empty, it makes the node's next
//     primary ray, if there is one.
//   - The communication task has an input and an output thread for every link, and one of each for the main task. It
//     preempts the main task, one message at a time: at each end, a message costs the processor `message_cycles` plus
//     `word_cycles` a word, before and after its transfer over the link.
// A link transfers one message at a time in each direction, at the rate `one_way` or, while the other direction is in
// use, at half of `both_ways`. Routing is store-and-forward: raya_next_link for rays, raya_return_link for returns.
//
// Buffers are finite. An output thread holds up to `buffer` rays and `buffer` returns, an input thread one of each. A
// message starts over a link only when the input thread at its end has a free slot. Rays that wait for the main task
// lie in the node's memory, which has no limit; AsyncNode::queue_max is their maximum.
//
// The machine cannot deadlock:
//   - Returns have slots of their own, their routes form a tree, and the root accepts every return. So returns drain.
//   - Rays travel along the axes of the torus in a fixed order, so a ray waits only for rays of its own ring or of a
//     later axis. A ring always keeps a free slot: a ray moves on within a ring if one slot is free, but enters it
//     (from the main task or another axis) only if `entering` = 2 slots are. This is bubble flow control (V. Puente et
//     al., "The Adaptive Bubble Router", J. Parallel and Distributed Computing 61, 2001).
//   - The main task's queue takes every arrival, even while the main task waits for a port.
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
    double cycle_ns = kT805CycleNs;
    std::uint32_t message_cycles = kT805MessageCycles, word_cycles = kT805MessageWordCycles;
    double one_way = kT805OneWayBytesPerS, both_ways = kT805BothWaysBytesPerS;  // bytes/s; 0: links take no time
    std::uint32_t buffer = 4;    // slots for each of the two classes in an output thread; at least `entering`
    std::uint32_t entering = 2;  // free slots that a ray needs to enter a ring; with 1 the machine can deadlock
};

struct AsyncNode {
    double compute_ms = 0, messages_ms = 0;  // processor time of the main and of the communication task
    double port_ms = 0;                      // time for which the main task waited for a free slot in a port
    std::uint64_t queue_max = 0;             // maximum number of rays that waited for the main task
};

struct AsyncLink {
    double busy_ms = 0;
    std::uint64_t messages = 0, words = 0;
};

struct AsyncResult {
    double finish_ms = 0;  // end of the last task and delivery of the last return
    std::uint64_t delivered = 0;
    std::vector<AsyncNode> nodes;
    std::vector<AsyncLink> links;  // [node][RAYA_LINKS]

    AsynchronousTime time() const;
};

/// Simulates the history on the machine. Deterministic. Throws UserError if buffer < entering or entering is 0,
/// std::logic_error for an invalid history (check_history), and std::runtime_error on a deadlock, which cannot happen
/// with `entering` >= 2.
AsyncResult simulate(const raya_torus& torus, const History& history, const AsyncMachine& machine = {});

/// SimGrid's platform file (XML): a host for each node, named by its number, at one operation a cycle; a link for each
/// direction of a wire and one for the wire itself, which both directions share; routes between neighbours only, as
/// routing is store-and-forward. SimGrid's own torus (<cluster topology="TORUS">) is no substitute: a message would
/// occupy all links of its route at once, and the two directions would not share a wire.
std::string simgrid_platform(const raya_torus& torus, const AsyncMachine& machine);

/// The replay file, in the format that tools/simgrid/replay.cpp documents.
std::string simgrid_replay(const raya_torus& torus, const History& history, const AsyncMachine& machine);

}  // namespace raya
