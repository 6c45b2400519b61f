// PNG files for pages, made without a library of pictures: a page is made on machines that have none, too.
#pragma once
#include <string>

#include "host/image/image.hpp"

namespace raya {

/// The bytes of a PNG file (ISO/IEC 15948): the nearest 8-bit sRGB code of each value, clamped to 0..1, as in those of
/// write_image(); no attributes. std::logic_error if `image` lacks pixels.
std::string plain_png(const Image& image);

}  // namespace raya
