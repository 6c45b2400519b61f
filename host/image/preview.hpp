// A small picture of a picture, for reports and pages.
#pragma once
#include "host/image/image.hpp"
#include "host/image/tone.hpp"

namespace raya {

inline constexpr int kPreviewSide = 256;  // pixels

/// Pixels of a preview's side where the picture has `own`, and `longest` along its longer side: that one gets `side`,
/// the other its share, a pixel at least.
int preview_side(int own, int longest, int side = kPreviewSide);

/// At most `side` pixels a side, in the same proportions: each the mean of the pixels that it stands for, in linear
/// light, of colours clamped to 0..1 as an 8-bit file shows them (NaN: 0). A picture that is small enough stays as it
/// is, but for that. std::logic_error without pixels.
Image preview_of(const Image& image, int side = kPreviewSide);

/// Linear light as a screen shows it whose picture has the codes that this tone makes.
Image as_shown(const Image& image, const Tone& tone);

}  // namespace raya
