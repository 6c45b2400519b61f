// Which PEs hold the neighbours of a PE's pixels, how they come over ring or bus, and how many moves that takes.
#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "kernels/shared/neighbours.h"

namespace raya {

/// Every PE hands its block to the PE of the next lower number (kDown), or of the next higher one (kUp).
enum class Turn { kDown, kUp };

/// Rotations one way round, from the PEs' own blocks on. After s turns downwards PE i holds the block of PE i + s,
/// after s turns upwards that of PE i - s, modulo P.
struct Leg {
    Turn turn = Turn::kDown;
    std::vector<std::uint32_t> stops;  // turns after which the block is used, ascending; 0 is the PE's own

    std::uint32_t turns() const { return stops.empty() ? 0 : stops.back(); }
};

/// All d in 0..P-1, ascending, such that the neighbour on `side` (RAYA_LEFT..RAYA_BELOW) of some pixel of some PE i
/// belongs to PE (i + d) mod P. Empty where no pixel has one. Where a PE owns whole columns: left P - 1, right 1,
/// above p, below P - p (Kohata & Ito 1993, cyclic mapping).
std::vector<std::uint32_t> neighbour_distances(const raya_mapping& mapping, raya_u32 side);

/// The legs, at most one each way, that reach all `distances` with the fewest turns; downwards first.
std::vector<Leg> shortest_route(std::uint32_t pes, const std::vector<std::uint32_t>& distances);

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
