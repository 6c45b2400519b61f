// How far one image is from another, in three figures.
#pragma once
#include <cstddef>
#include <span>

#include "host/scene/scene.hpp"

namespace raya {

/// All on values clamped to 0..1, as they are shown. A value that is not finite, in either image, is infinitely far.
struct ImageDifference {
    double psnr_db = 0;     // over all channels of all pixels, peak 1; inf for equal images, -inf for values not finite
    double largest = 0;     // of any channel; inf for values not finite
    std::size_t over = 0;   // pixels with any channel off by more than the limit
    double share_over = 0;  // of all pixels, 0..1
};

/// Compares `rgb` (3 values for each pixel) with `expected` (one colour for each pixel), both linear and in the same
/// order. Throws std::invalid_argument where the sizes differ or there is no pixel.
ImageDifference image_difference(std::span<const Colour> expected, std::span<const float> rgb, double limit);

}  // namespace raya
