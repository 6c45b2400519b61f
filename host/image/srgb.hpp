// Transfer curves between linear light and the 8-bit codes of a picture: that of sRGB (IEC 61966-2-1), or another.
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>

namespace raya {

/// borders[k] = the linear value half way, on the curve, between the codes k and k + 1.
using CodeBorders = std::array<double, 255>;

/// `linear_from`: the curve's inverse, from 0..1 to linear light.
template <class Curve>
CodeBorders code_borders(Curve&& linear_from) {
    CodeBorders borders;
    for (std::size_t k = 0; k < borders.size(); ++k) borders[k] = linear_from((static_cast<double>(k) + 0.5) / 255);
    return borders;
}

const CodeBorders& srgb_borders();

/// The code 0..255 nearest to 255 curve(linear); below 0 and NaN give 0, above 1 gives 255.
std::uint8_t code_between(const CodeBorders& borders, double linear);

/// That code on the sRGB curve. Has the same answer on every machine: the value is compared with the 255 borders
/// between codes, which no float comes near (the nearest is more than 10^-11 of itself away, the C library's pow is
/// right to about 10^-16).
std::uint8_t srgb_code(float linear);

/// The linear value that a code stands for.
float srgb_light(std::uint8_t code);

}  // namespace raya
