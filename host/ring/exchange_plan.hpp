// How the PEs come by their neighbours' pixels, and how many moves of ring or bus that takes.
#pragma once
#include <array>
#include <cstdint>
#include <string>

#include "kernels/shared/neighbours.h"

namespace raya {

/// Kohata & Ito 1993, section on the array: the ring moves the data of all PEs at once, the bus one PE's at a time.
enum class ExchangeWay {
    kRing,      // rotations, every PE's block to the next PE; what the paper's anti-aliasing does
    kBus,       // transfers from PE to PE, to each from those that have its neighbours
    kBroadcast  // each PE in turn to all, which take what they need as it passes
};

/// "ring", "bus", "bus-broadcast"
std::string exchange_name(ExchangeWay way);

/// Rotations, transfers or broadcasts, made one after another.
using MovesOfSides = std::array<std::uint64_t, RAYA_SIDES>;

/// Those that bring every PE the whole shares in which its neighbours on each side lie. `together`: the order in which
/// sides come is of no account, so that each PE's broadcast serves all of them; it counts for the first that needs it.
MovesOfSides exchange_moves(const raya_mapping& mapping, ExchangeWay way, bool together);

/// ... for all sides.
std::uint64_t sum_of(const MovesOfSides& moves);

}  // namespace raya
