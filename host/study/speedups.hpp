// Speed-ups of one picture for every number of PEs: what Fig. 9 is made of.
#pragma once
#include <cstdint>
#include <vector>

#include "host/ring/cost_image.hpp"
#include "host/study/statistics.hpp"

namespace raya {

/// Of one number of PEs.
struct Speedups {
    std::uint32_t pes = 0;
    double columns = 0, columns_block = 0;  // p = 0, folds cyclic and block
    double cyclic = 0, cyclic_block = 0;    // p = 16, the paper's for 256 PEs
    double root = 0, root_block = 0;        // p = round(sqrt(P))
    double grid = 0;                        // A x A; 0 where P is no square

    bool is_square() const { return grid > 0; }
};
using SpeedupRows = std::vector<Speedups>;  // of 1, 2, .. W PEs

SpeedupRows speedups_of(const CostImage& image);

inline const Speedups& on(const SpeedupRows& rows, std::size_t pes) { return rows[pes - 1]; }

/// Of one number of PEs in many pictures.
struct SpeedupMeans {
    std::uint32_t pes = 0;
    Estimate columns, cyclic, root;
};
std::vector<SpeedupMeans> means_of(const std::vector<SpeedupRows>& pictures);

/// Powers of two, from one PE to one for each column, for images of several sizes; cyclic fold.
struct SizedSpeedup {
    std::uint32_t side, pes;
    double columns, cyclic, root;
    double efficiency() const { return root / pes; }
};
std::vector<SizedSpeedup> speedups_of_sizes(const std::vector<const CostImage*>& images);

}  // namespace raya
