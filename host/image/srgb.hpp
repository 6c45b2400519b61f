// The sRGB transfer curve (IEC 61966-2-1) between linear light and the 8-bit codes of a PNG.
#pragma once
#include <cstdint>

namespace raya {

/// The code 0..255 nearest to 255 curve(linear); below 0 and NaN give 0, above 1 gives 255. Has the same answer on
/// every machine: the value is compared with the 255 borders between codes, which no float comes near (the nearest is
/// more than 10^-11 of itself away, the C library's pow is right to about 10^-16).
std::uint8_t srgb_code(float linear);

}  // namespace raya
