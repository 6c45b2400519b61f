// Costs of an image's pixels, and the loads of static and dynamic mappings that follow from them without tracing again.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "host/model/mapping_rule.hpp"
#include "host/model/time_model.hpp"
#include "kernels/shared/mapping.h"

namespace raya {

/// Modelled cycles of each pixel, including all its rays. The sum must be below 2^63, to leave range for requests.
struct CostImage {
    std::uint32_t width = 0, height = 0;  // pixels
    std::vector<std::uint64_t> cycles;    // height x width, row-major
};

/// The argument of --mapping for this plan, for a hybrid with all its numbers.
std::string dynamic_text(const DynamicPlan& plan);

/// A simulated run. A PE never waits before its last pixel, so its finishing time is also its busy time.
struct Schedule {
    Load load;  // finishing time of each PE, cycles, with pixels and requests. Its speedup is sum / max
                // of busy times with overhead, a measure of balance; see speedup() for the gain
    std::uint64_t requests = 0;  // that were answered with pixels
};

// Functions of a cost image throw std::invalid_argument if cycles.size() is not W H, if the mapping has another size,
// for P outside 1..W H, and for a number of a plan, an offset or a fold out of range.

/// The load of a static mapping: a PE's load is the sum of its pixels' costs.
Load static_load(const CostImage& image, const raya_mapping& mapping);

/// static_load(...).imbalance for each of the offsets, with these PEs and fold (RAYA_FOLD_*). Much faster, as it
/// computes the owner once for each pixel instead of once for each pixel and offset.
std::vector<double> imbalance_of_offsets(const CostImage& image, std::uint32_t pes, std::uint32_t fold,
                                         const std::vector<std::uint32_t>& offsets);

/// Simulates list scheduling. Each PE first renders the first floor(static_share x size) pixels of its share under
/// `start`. The other pixels, in scan-line order, are divided into chunks, the last of which may be smaller. The first
/// PE to become idle, in case of a tie the one with the lowest number, takes the next chunk, for the overhead and the
/// pixels' costs. With a static share of 0 only the size and the PEs of `start` matter; with 1 the result is that of
/// static_load(). O(pixels + P + chunks log P).
Schedule dynamic_schedule(const CostImage& image, const raya_mapping& start, const DynamicPlan& plan);

/// Work without overhead: the sum of all pixels' costs.
std::uint64_t total_cycles(const CostImage& image);

/// Finishing time of the last PE, cycles.
std::uint64_t makespan(const Schedule& schedule);

/// total_cycles() / makespan(): the gain over one PE that has all pixels and makes no requests. Overhead is time but
/// not work, so it is at most Schedule::load.speedup. P if the makespan is 0, as in Load.
double speedup(const Schedule& schedule, const CostImage& image);

/// Lower bound of the makespan of any distribution of whole pixels over P PEs: max(ceil(total / P), largest pixel),
/// cycles.
std::uint64_t lower_bound(const CostImage& image, std::uint32_t pes);

}  // namespace raya
