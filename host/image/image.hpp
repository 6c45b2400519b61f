// Images in memory, and the hash of an image.
#pragma once
#include <string>
#include <vector>

namespace raya {

/// A colour image: linear, unclamped, row-major, row 0 on top, 3 floats (red, green, blue) per pixel.
struct Image {
    int width = 0;   // pixels
    int height = 0;  // pixels
    std::vector<float> rgb;
};

/// One number per pixel, such as its modelled cost: row-major, row 0 on top.
struct GreyImage {
    int width = 0;   // pixels
    int height = 0;  // pixels
    std::vector<float> values;
};

/// Returns the XXH3 hash (128 bits, as 32 lower-case hexadecimal digits) of width, height and the bits of all floats,
/// as 32-bit little-endian words on any machine. Because bits are hashed, the hashes of -0 and +0 differ, and so do
/// those of NaNs with different bits.
std::string pixel_hash(const Image& image);

}  // namespace raya
