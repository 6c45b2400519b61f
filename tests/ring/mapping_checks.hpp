// Checks for every mapping: the lists of the PEs' pixels (shares) must agree with raya_owner and with the mapping's
// definition.
#pragma once
#include <algorithm>
#include <cstdint>
#include <vector>

#include "kernels/shared/share_pixels.h"

namespace raya {

/// Returns the number of wrong pixels of a mapping. A pixel in a share's list is wrong if it lies outside the image or
/// was listed before, or if raya_owner, `defined_owner(row, column)`, raya_index_of or raya_pixel_run_at contradicts
/// the list. raya_pixel_run_at is not called for one of seven pixels, so it must skip pixels. A pixel of the image is
/// wrong if no share lists it. Appends the size of each share to `sizes`.
template <class Defined>
std::uint32_t count_wrong_owners(const raya_mapping& m, const Defined& defined_owner,
                                 std::vector<std::uint32_t>& sizes) {
    std::vector<bool> seen(std::size_t{m.width} * m.height);
    std::uint32_t wrong = 0;
    for (std::uint32_t pe = 0; pe < m.pes; ++pe) {
        const raya_share share = raya_share_of(m, pe);
        sizes.push_back(raya_share_size(share));
        if (sizes.back() > seen.size()) return ~0u;  // the size overflowed
        raya_pixel_run run{};
        for (std::uint32_t k = 0; k < sizes.back(); ++k) {
            const raya_pixel pixel = raya_pixel_of(m, share, k);
            if (k % 7 != 3) run = k == 0 ? raya_pixel_run_of(m, share, k) : raya_pixel_run_at(run, m, share, k);
            const bool run_matches = k % 7 == 3 || (run.pixel.row == pixel.row && run.pixel.column == pixel.column);
            const bool inside = pixel.row < m.height && pixel.column < m.width;
            const std::size_t image_index = std::size_t{pixel.row} * m.width + pixel.column;
            const bool good = inside && run_matches && !seen[image_index] &&
                              raya_owner(m, pixel.row, pixel.column) == pe &&
                              defined_owner(pixel.row, pixel.column) == pe && raya_index_of(m, share, pixel) == k;
            if (inside) seen[image_index] = true;
            wrong += !good;
        }
    }
    return wrong + static_cast<std::uint32_t>(std::count(seen.begin(), seen.end(), false));
}

/// Returns true if the pixel's owner lists the pixel at the index that raya_index_of returns.
inline bool round_trip_holds(const raya_mapping& m, const raya_pixel& pixel) {
    const raya_share share = raya_share_of(m, raya_owner(m, pixel.row, pixel.column));
    const std::uint32_t k = raya_index_of(m, share, pixel);
    if (k >= raya_share_size(share)) return false;
    const raya_pixel listed_pixel = raya_pixel_of(m, share, k);
    return listed_pixel.row == pixel.row && listed_pixel.column == pixel.column;
}

}  // namespace raya
