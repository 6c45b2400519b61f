// A PNG encoder that does not need OpenImageIO, for images in HTML pages and reports.
#pragma once
#include <string>

#include "host/image/image.hpp"

namespace raya {

/// Returns the bytes of a PNG file (ISO/IEC 15948) without attributes. It stores the 8-bit sRGB code nearest to each
/// value clamped to 0..1, as write_image() does by default. Throws std::logic_error if `image` has no pixels
/// or does not have 3 floats per pixel.
std::string plain_png(const Image& image);

// Reduced images for reports and pages.

inline constexpr int kPreviewSide = 256;  // default maximum of a preview's longer side, pixels

/// Returns the length of one side of a preview. All lengths are in pixels. `image_side`: the same side of the image;
/// `longer_side`: the image's longer side; `max_side`: maximum for the preview's longer side. Both sides are reduced by
/// the same factor, but to at least 1 pixel. If `longer_side` is at most `max_side`, the size does not change.
int preview_side(int image_side, int longer_side, int max_side = kPreviewSide);

/// Reduces an image to at most `max_side` pixels per side and keeps its proportions. Each pixel of the result is the
/// mean of the pixels that it covers, after clamping them to 0..1 (NaN: 0), in linear light. An image that is small
/// enough is only clamped. Throws std::logic_error if `image` has no pixels.
Image preview_of(const Image& image, int max_side = kPreviewSide);

/// Returns the linear light that an sRGB screen displays for the 8-bit codes of `image` multiplied by 2^exposure.
Image as_displayed(const Image& image, double exposure);

}  // namespace raya
