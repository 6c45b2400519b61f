// Mappings, offsets and grids that follow from the number of PEs.
#pragma once
#include <cmath>
#include <cstdint>

#include "host/ring/mapping.hpp"

namespace raya {

/// Kohata & Ito's cyclic mapping.
inline raya_mapping cyclic(std::uint32_t width, std::uint32_t height, std::uint32_t pes, std::uint32_t offset,
                           Fold fold = Fold::kCyclic) {
    return make_mapping(cyclic_mapping(offset, fold), {width, height}, pes);
}

/// The same with a PE for each column of a square image.
inline raya_mapping cyclic(std::uint32_t side, std::uint32_t offset) { return cyclic(side, side, side, offset); }

/// sqrt(P), rounded: the offset at which P = n x n PEs share every n x n block (Kohata & Ito 1993, cyclic mapping).
inline std::uint32_t root_offset(std::uint32_t pes) { return static_cast<std::uint32_t>(std::lround(std::sqrt(pes))); }

/// A rows of B PEs, A the largest divisor of P up to its root.
inline raya_mapping squarest_grid(std::uint32_t width, std::uint32_t height, std::uint32_t pes) {
    std::uint32_t rows = 1;
    for (std::uint32_t a = 1; a <= pes / a; ++a)
        if (pes % a == 0) rows = a;
    return make_mapping(grid_mapping(rows, pes / rows), {width, height}, pes);
}

/// Each pixel's PE drawn, shares even; seed 1.
inline raya_mapping random_pixels(std::uint32_t width, std::uint32_t height, std::uint32_t pes) {
    return make_mapping(random_mapping(1), {width, height}, pes);
}

}  // namespace raya
