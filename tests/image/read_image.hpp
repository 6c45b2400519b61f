// Reads image files with OpenImageIO. This code is a separate library (raya_read_image), so that other tests do not
// load OpenImageIO.
#pragma once
#include <cmath>
#include <cstdint>
#include <filesystem>

#include "host/image/image_io.hpp"

namespace raya {

/// Reads an image with three channels as floats. 8-bit codes are converted to linear values. Throws std::runtime_error
/// if the file cannot be read or has another number of channels.
Image read_image(const std::filesystem::path& path);
/// Reads an image with one channel in the same way.
GreyImage read_grey_image(const std::filesystem::path& path);

/// Returns the linear value, in 0..1, of an 8-bit sRGB code.
float linear_from_srgb_code(std::uint8_t code);

/// The sRGB curve of IEC 61966-2-1: returns the encoded value in 0..1 of a linear value in 0..1.
inline double srgb_curve(double linear) {
    return linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1 / 2.4) - 0.055;
}

}  // namespace raya
