// A PNG encoder without OpenImageIO, for pages: these are also written where OpenImageIO is not installed.
#pragma once
#include <string>

#include "host/image/image.hpp"

namespace raya {

/// The bytes of a PNG file (ISO/IEC 15948) with the nearest 8-bit sRGB code of each value clamped to 0..1, the same as
/// by write_image(), without attributes. std::logic_error if `image` has no pixels or not 3 floats per pixel.
std::string plain_png(const Image& image);

}  // namespace raya
