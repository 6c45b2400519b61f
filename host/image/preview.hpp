// Reduced images for reports and pages.
#pragma once
#include "host/image/image.hpp"
#include "host/image/tone.hpp"

namespace raya {

inline constexpr int kPreviewSide = 256;  // pixels

/// The number of pixels of one side of a preview. `own`: pixels of the same side of the image; `longest`: pixels of the
/// image's longer side; `side`: maximum for the preview's longer side. Both sides are reduced by the same factor, to at
/// least 1 pixel; an image within the maximum is not reduced.
int preview_side(int own, int longest, int side = kPreviewSide);

/// Reduces an image to at most `side` pixels per side, with the same proportions. Each pixel of the result is the mean
/// of the pixels that it covers, after clamping them to 0..1 (NaN: 0), in linear light. An image within the maximum is
/// only clamped. Throws std::logic_error if `image` has no pixels.
Image preview_of(const Image& image, int side = kPreviewSide);

/// The linear light that an sRGB screen displays for the 8-bit codes of the image with this tone.
Image as_displayed(const Image& image, const Tone& tone);

}  // namespace raya
