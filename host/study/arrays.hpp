// Offsets and grids that follow from the number of PEs.
#pragma once
#include <cmath>
#include <cstdint>
#include <string>

namespace raya {

/// sqrt(P), rounded: the offset at which P = n x n PEs share every n x n block (Kohata & Ito 1993, cyclic mapping).
inline std::uint32_t root_offset(std::uint32_t pes) { return static_cast<std::uint32_t>(std::lround(std::sqrt(pes))); }

/// "grid:AxB": A rows of B PEs, A the largest divisor of P up to its root.
inline std::string squarest_grid(std::uint32_t pes) {
    std::uint32_t rows = 1;
    for (std::uint32_t a = 1; a <= pes / a; ++a)
        if (pes % a == 0) rows = a;
    return "grid:" + std::to_string(rows) + "x" + std::to_string(pes / rows);
}

}  // namespace raya
