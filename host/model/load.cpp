#include "host/model/load.hpp"

#include <algorithm>
#include <numeric>

namespace raya {

Load load_of(std::vector<std::uint64_t> per_pe) {
    Load load;
    load.per_pe = std::move(per_pe);
    const auto [least, most] = std::minmax_element(load.per_pe.begin(), load.per_pe.end());
    load.min = *least;
    load.max = *most;
    const auto pes = static_cast<double>(load.per_pe.size());
    const auto sum = static_cast<double>(std::accumulate(load.per_pe.begin(), load.per_pe.end(), std::uint64_t{0}));
    const auto max = static_cast<double>(load.max);
    load.mean = sum / pes;
    load.imbalance = sum > 0 ? (max - load.mean) / load.mean : 0;
    load.speedup = sum > 0 ? sum / max : pes;
    load.efficiency = load.speedup / pes;
    return load;
}

}  // namespace raya
