// A PNG encoder that does not need OpenImageIO, for images in HTML pages and reports.
#pragma once
#include <string>

#include "host/image/image.hpp"

namespace raya {

/// The bytes of a PNG file (ISO/IEC 15948) with the nearest 8-bit sRGB code of each value clamped to 0..1, as from
/// write_image() with the default Tone, without attributes. Throws std::logic_error if `image` has no pixels or does
/// not have 3 floats per pixel.
std::string plain_png(const Image& image);

}  // namespace raya
