// A render's history as SimGrid replays it (tools/simgrid/replay.cpp): the machine as a platform, and what it does.
#pragma once
#include <string>

#include "host/torus/async_machine.hpp"

namespace raya {

/// The platform file (XML): a host for each node, by its number, of one operation a cycle; a link for each way of a
/// wire and one for the wire itself, which both ways share; routes between neighbours alone, as messages are stored in
/// every node and sent on. SimGrid's own torus (<cluster topology="TORUS">) would let a message hold all links of its
/// way at once, and has no wire that two ways share.
std::string simgrid_platform(const raya_torus& torus, const AsyncMachine& machine);

/// The replay, in the lines that tools/simgrid/replay.cpp tells of.
std::string simgrid_replay(const raya_torus& torus, const History& history, const AsyncMachine& machine);

}  // namespace raya
