// How evenly work is spread over the PEs, in the words of the papers.
#pragma once
#include <cstdint>
#include <vector>

namespace raya {

/// Loads of P PEs, in modelled cycles.
struct Load {
    std::vector<std::uint64_t> per_pe;
    double mean = 0;
    std::uint64_t max = 0, min = 0;
    double imbalance = 0;   // u = (max - mean) / mean (Kohata & Ito 1993, Fig. 8); 0 where there is no load
    double speedup = 0;     // sum / max
    double efficiency = 0;  // speedup / P
};

/// `per_pe` holds one load for each PE, at least one.
Load load_of(std::vector<std::uint64_t> per_pe);

}  // namespace raya
