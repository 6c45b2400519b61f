// Reduced images for reports and pages.
#pragma once
#include "host/image/image.hpp"
#include "host/image/tone.hpp"

namespace raya {

inline constexpr int kPreviewSide = 256;  // pixels

/// The pixels of a side of a preview, if that side of the image has `own` pixels and its longer side has `longest`. The
/// longer side gets `side` pixels, the other is proportional, at least 1.
int preview_side(int own, int longest, int side = kPreviewSide);

/// Reduces an image to at most `side` pixels per side, with the same proportions. Each pixel is the mean of the pixels
/// that it covers, in linear light, clamped to 0..1 (NaN: 0). A small image is only clamped. std::logic_error without
/// pixels.
Image preview_of(const Image& image, int side = kPreviewSide);

/// The linear light that a screen displays for the image's 8-bit codes with this tone.
Image as_displayed(const Image& image, const Tone& tone);

}  // namespace raya
