// Routes of neighbours' pixels over ring or bus: the PEs that hold them, and the number of moves.
#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "kernels/shared/neighbours.h"

namespace raya {

/// Direction of a rotation: every PE sends its block to the PE of the next lower (kDown) or higher (kUp) number.
enum class Turn { kDown, kUp };

/// Rotations in one direction, starting with the PEs' own blocks. After s turns downwards PE i holds the block of PE
/// i + s, after s turns upwards that of PE i - s, modulo P.
struct Leg {
    Turn turn = Turn::kDown;
    std::vector<std::uint32_t> stops;  // turns after which the block is used, ascending; 0: the PE's own block

    std::uint32_t turns() const { return stops.empty() ? 0 : stops.back(); }
};

/// All d in 0..P-1, ascending, such that the neighbour on `side` (RAYA_LEFT..RAYA_BELOW) of some pixel of some PE i
/// belongs to PE (i + d) mod P. Empty if no pixel has such a neighbour. If PEs own whole columns: left P - 1, right 1,
/// above p, below P - p (Kohata & Ito 1993, cyclic mapping).
std::vector<std::uint32_t> neighbour_distances(const raya_mapping& mapping, raya_u32 side);

/// The legs, at most one in each direction, that reach all `distances` with the minimum number of turns; downwards
/// first.
std::vector<Leg> shortest_route(std::uint32_t pes, const std::vector<std::uint32_t>& distances);

/// Method of the exchange of neighbours' pixels. The ring moves the data of all PEs at once, the bus those of one PE at
/// a time (Kohata & Ito 1993, section on the array).
enum class ExchangeMethod {
    kRing,      // rotations of all blocks; the paper's anti-aliasing
    kBus,       // transfers to each PE from those that own its neighbours
    kBroadcast  // broadcast of each PE in turn
};

/// "ring", "bus", "bus-broadcast"
std::string exchange_name(ExchangeMethod method);

/// [side]: number of successive rotations, transfers or broadcasts.
using MovesOfSides = std::array<std::uint64_t, RAYA_SIDES>;

/// Moves that bring every PE the whole shares with its neighbours on each side. `together`: the sides may be processed
/// in any order, so that one broadcast serves all of them; it counts for the first side that needs it.
MovesOfSides exchange_moves(const raya_mapping& mapping, ExchangeMethod method, bool together);

/// Sum over all sides.
std::uint64_t sum_of(const MovesOfSides& moves);

}  // namespace raya
