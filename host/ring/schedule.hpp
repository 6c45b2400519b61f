// Costs of an image's pixels, and the PEs' loads with static and dynamic mappings, computed from these costs without
// tracing.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "host/model/mapping_rule.hpp"
#include "host/model/t805.hpp"
#include "kernels/shared/mapping.h"

namespace raya {

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
                // makespan. load.speedup is total_cycles() / makespan: the gain over one PE without requests
    std::uint64_t requests = 0;  // number of requests to which the root answered with pixels
};

// The functions below throw std::invalid_argument if cycles.size() is not W H, if the mapping is for another image
// size, if P is outside 1..W H, or if a member of a plan, an offset or a fold is out of range.

/// Returns the load with a static mapping: a PE's load is the sum of its pixels' costs.
Load static_load(const CostImage& image, const raya_mapping& mapping);

/// Returns static_load().imbalance of the cyclic mapping for each offset. `fold`: RAYA_FOLD_CYCLIC or _BLOCK. Faster
/// than calling static_load() for each offset, because it computes the owner once per pixel instead of once per pixel
/// and offset.
std::vector<double> imbalance_of_offsets(const CostImage& image, std::uint32_t pes, std::uint32_t fold,
                                         const std::vector<std::uint32_t>& offsets);

/// Simulates list scheduling. Each PE first renders its static part: the first floor(static_fraction x n) of the n
/// pixels that it owns under `static_mapping`. The other pixels, in scan-line order, are divided into chunks of
/// plan.chunk pixels; the last chunk may be smaller. The PE that becomes idle first (in a tie, the one with the lowest
/// number) takes the next chunk: it waits until the root has answered all earlier requests and the PE's own, then
/// spends the overhead plus the costs of the pixels. If static_fraction is 0, only the image size and the number of PEs
/// of `static_mapping` are used; if it is 1, the result is that of static_load(). Time: O(pixels + P + chunks log P).
Schedule dynamic_schedule(const CostImage& image, const raya_mapping& static_mapping, const DynamicPlan& plan);

/// Returns the sum of all pixels' costs, without overhead.
std::uint64_t total_cycles(const CostImage& image);

/// Returns a lower bound, in cycles, of the makespan of every distribution of whole pixels over P PEs: max(ceil(total /
/// P), cost of the most expensive pixel).
std::uint64_t lower_bound(const CostImage& image, std::uint32_t pes);

}  // namespace raya
