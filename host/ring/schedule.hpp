// What every pixel of an image costs: from it follows the load of every mapping, without tracing again.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "host/model/mapping_rule.hpp"
#include "host/model/time_model.hpp"
#include "kernels/shared/mapping.h"

namespace raya {

/// Modelled cycles of each pixel, all its rays included. Their sum must stay below 2^63, which leaves room for
/// requests.
struct CostImage {
    std::uint32_t width = 0, height = 0;  // pixels
    std::vector<std::uint64_t> cycles;    // height x width, row-major
};

/// The text that --mapping reads as this plan; a hybrid's with all its figures.
std::string dynamic_text(const DynamicPlan& plan);

/// A run that has been simulated. A PE never waits before its last pixel, so the time at which it has finished is also
/// the time that it has been busy: `load` is of pixels and requests together.
struct Schedule {
    Load load;                   // finishing time of each PE, cycles. Its speedup is sum / max of busy times, overhead
                                 // included: how evenly PEs are busy, not what the run gains; for that see speedup()
    std::uint64_t requests = 0;  // that were answered with pixels
};

// Functions of a cost image throw std::invalid_argument where cycles.size() is not W H, where the mapping is of another
// size, for P outside 1..W H, and for a plan's figure, an offset or a fold of their own that is out of its range.

/// The load of a static mapping: a PE's load is the sum of its pixels' costs.
Load static_load(const CostImage& image, const raya_mapping& mapping);

/// static_load(...).imbalance for the same PEs and fold (RAYA_FOLD_*) and each of the offsets, much faster: the owner
/// is asked for once a pixel, not once a pixel and offset.
std::vector<double> imbalance_of_offsets(const CostImage& image, std::uint32_t pes, std::uint32_t fold,
                                         const std::vector<std::uint32_t>& offsets);

/// Each PE first does the first floor(static_share x size) pixels of its share under `start`, in the share's order. All
/// other pixels in scan-line order make the chunks, the last of which may be smaller; the PE that is free first, of
/// equals the lowest number, takes the next, pays the overhead, then the pixels' costs. With a share of 0 only the size
/// and the PEs of `start` matter, with 1 it is static_load(). Takes O(pixels + P + chunks log P).
Schedule dynamic_schedule(const CostImage& image, const raya_mapping& start, const DynamicPlan& plan);

/// The pure work: the sum of all pixels' costs.
std::uint64_t total_cycles(const CostImage& image);

/// When the last PE has finished, cycles.
std::uint64_t makespan(const Schedule& schedule);

/// The pure work / makespan: how many times faster than one PE that has all pixels and asks nobody. Overhead counts as
/// time and not as work, so it is at most Schedule::load.speedup. P where the makespan is 0, as in Load.
double speedup(const Schedule& schedule, const CostImage& image);

/// No distribution of whole pixels over P PEs finishes earlier: max(ceil(total / P), largest pixel), cycles.
std::uint64_t lower_bound(const CostImage& image, std::uint32_t pes);

}  // namespace raya
