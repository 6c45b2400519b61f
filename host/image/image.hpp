// Images in memory, and the hash of an image.
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "host/image/encoder.hpp"

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

// Conversion of linear colours to 8-bit codes of image files: exposure and transfer curve (sRGB, IEC
// 61966-2-1, or a power).

/// borders[k]: the linear value at which the nearest code changes from k to k + 1. Its encoded value is
/// (k + 1/2) / 255.
using CodeBorders = std::array<double, 255>;

/// Returns the borders of the sRGB curve.
const CodeBorders& srgb_borders();

/// Returns the code 0..255 that is nearest to 255 curve(linear), for the curve of `borders`; 0 for negative values and
/// NaN, 255 above 1.
std::uint8_t nearest_code(const CodeBorders& borders, double linear);

/// Returns the nearest code on the sRGB curve. The code follows from comparisons with the 255 borders, which are
/// computed with the C library's pow(). The code is the same on every machine, because the relative error of pow() is
/// only about 10^-16, and the relative distance of every float from every border is more than 10^-11.
std::uint8_t srgb_code(float linear);

/// Returns the linear value of a code on the sRGB curve.
float srgb_light(std::uint8_t code);

/// Converts pixels to codes: multiplies by 2^exposure, clips to 0..1, and applies the sRGB curve. A NaN component
/// counts as 0, an infinite one as the largest float. The result is the same on every machine, except for values at the
/// border of two codes, which depend on the rounding of exp2().
class ToneCodes {
  public:
    explicit ToneCodes(double exposure = 0);

    /// Returns the codes of one pixel. `rgb`: 3 linear values, red, green and blue.
    std::array<std::uint8_t, 3> operator()(const float* rgb) const;

  private:
    double factor_;
    static constexpr int kCells = 4096;
    std::array<std::uint8_t, kCells + 1> codes_;  // [k]: the code of k / kCells; a search from there takes few steps
};

}  // namespace raya
