// Pictures as files hold them, read by OpenImageIO. Library raya_read_image, so that other tests load none of its
// libraries.
#pragma once
#include <cmath>
#include <cstdint>
#include <filesystem>

#include "host/image/image.hpp"

namespace raya {

/// The floats of a file; the codes of a PNG become linear values. Throws std::runtime_error if it cannot be read, or
/// has not three channels, or one.
Image read_image(const std::filesystem::path& path);
GreyImage read_grey_image(const std::filesystem::path& path);

/// The linear value in 0..1 that a code of a PNG stands for.
float linear_from_srgb_code(std::uint8_t code);

/// The curve of IEC 61966-2-1, from a linear value in 0..1 to a code in 0..1.
inline double srgb_curve(double linear) {
    return linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1 / 2.4) - 0.055;
}

}  // namespace raya
