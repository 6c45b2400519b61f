// Where the pixels that the PEs hold lie in the image.
#pragma once
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "host/ring/tracer.hpp"
#include "kernels/shared/mapping.h"

namespace raya {

/// Calls `move` for each pixel of a range of the share of every PE of a segment, with the PE's number in the segment,
/// the pixel's in the PE's block and its number in the image. Some PEs at a time, a run of each: where neighbours own
/// neighbouring columns, what is near in the image is moved together.
template <class Move>
void for_each_pixel(const raya_mapping& m, const PeSegment& segment, PixelRange range, Move&& move) {
    constexpr std::uint32_t kTogether = 16;
    for (std::uint32_t first = 0; first < segment.count; first += kTogether) {
        const std::uint32_t pes = std::min(kTogether, segment.count - first);
        std::array<raya_share, kTogether> shares{};
        for (std::uint32_t i = 0; i < pes; ++i) shares[i] = raya_share_of(m, segment.first + first + i);
        std::uint32_t pixels = 0;
        for (std::uint32_t k = range.begin; k < range.end; k += pixels) {
            std::array<raya_pixel_run, kTogether> runs{};
            pixels = range.end - k;
            for (std::uint32_t i = 0; i < pes; ++i) {
                const std::uint32_t size = raya_share_size(shares[i]);
                if (k >= size) continue;
                runs[i] = raya_pixel_run_of(m, shares[i], k);
                pixels = std::min({pixels, size - k, runs[i].left + 1});
            }
            for (std::uint32_t i = 0; i < pes; ++i) {
                if (k >= raya_share_size(shares[i])) continue;
                const std::size_t row = std::size_t{runs[i].pixel.row} * m.width;
                std::uint32_t column = runs[i].pixel.column;
                for (std::uint32_t j = 0; j < pixels; ++j) {
                    move(first + i, k - range.block + j, row + column);
                    column += runs[i].step;
                    if (column >= m.width) column -= m.width;
                }
            }
        }
    }
}

}  // namespace raya
