// A PNG encoder that does not need OpenImageIO, for images in HTML pages and reports.
#pragma once
#include <string>

#include "host/image/image.hpp"

namespace raya {

/// Returns the bytes of a PNG file (ISO/IEC 15948) without attributes. It stores the 8-bit sRGB code nearest to each
/// value clamped to 0..1, as write_image() does with the default Tone. Throws std::logic_error if `image` has no pixels
/// or does not have 3 floats per pixel.
std::string plain_png(const Image& image);

}  // namespace raya
