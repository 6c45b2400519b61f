// The torus without supersteps: nodes compute while links carry, as the paper's transputers do (Yoshitani & Yamazaki,
// method). Discrete events over the history of a render.
//
// A node has one processor for two tasks (the paper's words):
//   - the main task treats rays, one after another in the order in which they come to it; what it makes goes to its own
//     queue or to the port of a link, where it waits while that is full. Where no ray waits it makes the next of its
//     primary rays, if it makes any.
//   - the communication task has a thread for the input and one for the output of every link, and one of each for the
//     main task. It goes before the main task, message by message: at each end a message costs the processor
//     `message_cycles` and `word_cycles` a word, before the link carries it and after.
// A link carries one message at a time each way, at `one_way` or, while the other way is in use, at half `both_ways`.
// Messages are stored in every node and sent on, rays by raya_next_link, returns by raya_home_link.
//
// Buffers are finite. An output thread has room for `buffer` rays and as many returns, an input thread for one of each;
// a message starts over a link only when the input thread at its end has room for it. A ray that the main task is to
// treat lies in the node's memory, and the result tells how many there ever were.
//
// Nothing stands still for ever, since
//   - returns have room of their own, their ways are a tree, and the root takes in what comes: returns always drain;
//   - rays take the sides of the torus in one order, so a ray waits for rays of its own ring or of a later side's. In a
//     ring some room is always left: a ray goes on in it where there is room for one, but enters it (from the main task
//     or from another side) only where there is room for `entering` = 2. So the ring turns (bubble flow control;
//     V. Puente & others, "The Adaptive Bubble Router", J. Parallel and Distributed Computing 61 (2001));
//   - the main task's queue takes all that arrives, even while the main task waits for a port.
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
    std::uint32_t buffer = 4;  // messages of each of the two classes, in an output thread; `entering` at least
    std::uint32_t entering =
        2;  // of them free before a ray may enter a ring of links; with 1 a machine can stand still
};

struct AsyncNode {
    double compute_ms = 0, messages_ms = 0;  // of its processor
    double port_ms = 0;                      // that the main task waited for room in a port
    std::uint64_t queue_max = 0;             // rays that waited for the main task, at most
};

struct AsyncLink {
    double busy_ms = 0;
    std::uint64_t messages = 0, words = 0;
};

struct AsyncResult {
    double finish_ms = 0;  // the last task has been done and the last return taken in
    std::uint64_t delivered = 0;
    std::vector<AsyncNode> nodes;
    std::vector<AsyncLink> links;  // [node][RAYA_LINKS]

    AsynchronousTime time() const;
};

/// Carries the history out on the machine. The same history gives the same result. UserError for a machine without
/// buffers; std::logic_error for a history that is none (check_history); std::runtime_error where the machine stands
/// still, which it cannot with 2 or more as `entering`.
AsyncResult simulate(const raya_torus& torus, const History& history, const AsyncMachine& machine = {});

/// The platform file (XML): a host for each node, by its number, of one operation a cycle; a link for each way of a
/// wire and one for the wire itself, which both ways share; routes between neighbours alone, as messages are stored in
/// every node and sent on. SimGrid's own torus (<cluster topology="TORUS">) would let a message hold all links of its
/// way at once, and has no wire that two ways share.
std::string simgrid_platform(const raya_torus& torus, const AsyncMachine& machine);

/// The replay, in the lines that tools/simgrid/replay.cpp tells of.
std::string simgrid_replay(const raya_torus& torus, const History& history, const AsyncMachine& machine);

}  // namespace raya
