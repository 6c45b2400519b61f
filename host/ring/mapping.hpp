// Mappings of an image onto the PEs of a ring; the formulas are in kernels/shared/mapping.h.
#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "host/model/mapping_rule.hpp"
#include "host/model/t805.hpp"
#include "kernels/shared/mapping.h"
#include "kernels/shared/neighbours.h"

namespace raya {

/// Returns the mapping of an image of W x H pixels by this rule. Throws UserError, with the option and its legal range,
/// if W or H is outside 1..16384, the number of PEs is outside 1..W*H or is not R C for a mapping grid:RxC,
/// the offset is outside 0..W-1, or tiles do not divide the image.
raya_mapping make_mapping(const MappingRule& rule, const ImageSize& image, std::uint32_t pes);

/// Returns the argument of --mapping for this mapping, without the fold: "cyclic:16", "grid:16x16". The mapping of
/// whole columns is "cyclic:0".
std::string mapping_text(const MappingRule& rule);
std::string mapping_text(const raya_mapping& mapping);

/// Returns the maximum number of pixels that a PE owns.
std::uint32_t largest_share(const raya_mapping& mapping);

// Routes of neighbouring pixels over ring or bus: the PEs that own the pixels next to a PE's pixels, and the number of
// moves that bring them.

/// Direction of a rotation: every PE sends its block to the PE with the next lower (kDown) or next higher (kUp) number.
enum class RingDirection { kDown, kUp };

/// A sequence of rotations in one direction, starting with each PE's own block. After s downward rotations, PE i holds
/// the block of PE (i + s) mod P; after s upward rotations, that of PE (i - s) mod P.
struct Leg {
    RingDirection direction = RingDirection::kDown;
    // Ascending. After each of these numbers of rotations, the PEs use the blocks that they then hold. 0: their own.
    std::vector<std::uint32_t> stops;

    std::uint32_t rotations() const { return stops.empty() ? 0 : stops.back(); }
};

/// Returns all d in 0..P-1, ascending, for which at least one PE i owns a pixel whose neighbour on `side`
/// (RAYA_LEFT..RAYA_BELOW) belongs to PE (i + d) mod P; empty if no pixel has such a neighbour. For the cyclic mapping
/// with offset p and P = W: left P - 1, right 1, above p, below P - p (Kohata & Ito 1993).
std::vector<std::uint32_t> neighbour_distances(const raya_mapping& mapping, raya_u32 side);

/// Returns the legs that bring the blocks at all `distances` with the minimum number of rotations: at most one leg in
/// each direction, the downward leg first.
std::vector<Leg> shortest_route(std::uint32_t pes, const std::vector<std::uint32_t>& distances);

/// Methods of exchanging neighbouring pixels. The ring moves data of all PEs at the same time; the bus moves data of
/// one PE at a time (Kohata & Ito 1993, section on the array).
enum class ExchangeMethod {
    kRing,      // rotations of all blocks; the paper's anti-aliasing
    kBus,       // transfers to each PE from the PEs that own the neighbours of its pixels
    kBroadcast  // broadcasts from one PE after another
};

/// Returns "ring", "bus" or "bus-broadcast".
std::string exchange_name(ExchangeMethod method);

/// [side]: number of rotations, transfers or broadcasts, which take place one after another.
using MovesOfSides = std::array<std::uint64_t, RAYA_SIDES>;

/// Returns the numbers of moves. The moves bring to every PE the whole shares that contain neighbours of its pixels.
/// `any_order`: the sides may be processed in any order, so that one series of broadcasts serves all sides. The series
/// is counted for the first side that needs a broadcast.
MovesOfSides exchange_moves(const raya_mapping& mapping, ExchangeMethod method, bool any_order);

/// Returns the sum of the numbers.
std::uint64_t sum_of(std::span<const std::uint64_t> numbers);

// Costs of an image's pixels, and the PEs' loads with static and dynamic mappings, computed from these costs without
// tracing.

/// Modelled cycles of each pixel, including all its rays. The sum must be below 2^63, so that adding the overhead of
/// requests does not overflow.
struct CostImage {
    std::uint32_t width = 0, height = 0;  // pixels
    std::vector<std::uint64_t> cycles;    // height x width, row-major
};

/// Returns the argument of --mapping for this plan.
std::string dynamic_text(const DynamicPlan& plan);

/// Result of a simulated run.
struct Schedule {
    Load load;  // finishing time of each PE in cycles, including overhead and waiting for the root. load.max is the
                // makespan. load.speedup is the sum of all costs / makespan: the gain over one PE without requests
    std::uint64_t requests = 0;  // number of requests to which the root answered with pixels
};

// The functions below throw std::invalid_argument if cycles.size() is not W H, if the mapping is for another image
// size, if P is outside 1..W H, or if a member of a plan, an offset or a fold is out of range.

/// Returns the load with a static mapping: a PE's load is the sum of its pixels' costs.
Load static_load(const CostImage& image, const raya_mapping& mapping);

/// Returns static_load().imbalance of the cyclic mapping for each offset. `fold`: RAYA_FOLD_CYCLIC or _BLOCK.
std::vector<double> imbalance_of_offsets(const CostImage& image, std::uint32_t pes, std::uint32_t fold,
                                         const std::vector<std::uint32_t>& offsets);

/// Simulates list scheduling. Each PE first renders its static part: the first floor(static_fraction x n) of the n
/// pixels that it owns under `static_mapping`. The other pixels, in scan-line order, are divided into chunks of
/// plan.chunk pixels; the last chunk may be smaller. The PE that becomes idle first (in a tie, the one with the lowest
/// number) takes the next chunk: it waits until the root has answered all earlier requests and the PE's own, then
/// spends the overhead plus the costs of the pixels. If static_fraction is 0, only the image size and the number of PEs
/// of `static_mapping` are used; if it is 1, the result is that of static_load(). Time: O(pixels + (P + chunks) log P).
Schedule dynamic_schedule(const CostImage& image, const raya_mapping& static_mapping, const DynamicPlan& plan);

/// Returns a lower bound, in cycles, of the makespan of every distribution of whole pixels over P PEs: max(ceil(total /
/// P), cost of the most expensive pixel).
std::uint64_t lower_bound(const CostImage& image, std::uint32_t pes);

}  // namespace raya
