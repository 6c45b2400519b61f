// Pictures as plain data, and the hash by which two of them are compared.
#pragma once
#include <string>
#include <vector>

namespace raya {

/// A colour picture: linear, unclamped, row-major, row 0 on top, 3 floats (red, green, blue) a pixel.
struct Image {
    int width = 0;   // pixels
    int height = 0;  // pixels
    std::vector<float> rgb;
};

/// One number a pixel, such as its modelled cost: row-major, row 0 on top.
struct GreyImage {
    int width = 0;   // pixels
    int height = 0;  // pixels
    std::vector<float> values;
};

/// XXH3 (128 bits, 32 lower-case hex digits) over width, height and the bits of every float, as 32-bit little-endian
/// words on any machine. Equal for bit-identical pictures only: -0 and +0 differ, and so do NaNs of unlike bits.
std::string pixel_hash(const Image& image);

}  // namespace raya
