#include "tests/image/read_image.hpp"

#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <stdexcept>

namespace raya {
namespace {

template <class T>
std::vector<T> read_values(OIIO::ImageInput& input, const OIIO::TypeDesc& type) {
    const OIIO::ImageSpec& spec = input.spec();
    std::vector<T> values(spec.image_pixels() * static_cast<std::size_t>(spec.nchannels));
    const int subimage = 0, level = 0, first_channel = 0, end_channel = -1;  // -1: after the last channel
    if (!input.read_image(subimage, level, first_channel, end_channel, type, values.data()))
        throw std::runtime_error(input.geterror());
    return values;
}

/// Reads the file's channels as floats. Sets `width` and `height` to the image's size.
std::vector<float> read_floats(const std::filesystem::path& path, int channels, int& width, int& height) {
    const OIIO::ImageSpec defaults;  // without it OpenImageIO 2.5 to 3.1 return the rows of a PFM file bottom first
    const auto input = OIIO::ImageInput::open(path.string(), &defaults);
    if (!input) throw std::runtime_error(OIIO::geterror());
    const OIIO::ImageSpec& spec = input->spec();
    if (spec.nchannels != channels) throw std::runtime_error(path.string() + ": wrong number of channels");
    width = spec.width;
    height = spec.height;
    if (spec.format != OIIO::TypeDesc::UINT8) return read_values<float>(*input, OIIO::TypeDesc::FLOAT);
    const auto codes = read_values<std::uint8_t>(*input, OIIO::TypeDesc::UINT8);
    std::vector<float> values(codes.size());
    std::transform(codes.begin(), codes.end(), values.begin(), linear_from_srgb_code);
    return values;
}

}  // namespace

float linear_from_srgb_code(std::uint8_t code) {
    const double encoded = code / 255.0;
    return static_cast<float>(encoded <= 0.04045 ? encoded / 12.92 : std::pow((encoded + 0.055) / 1.055, 2.4));
}

Image read_image(const std::filesystem::path& path) {
    Image image;
    image.rgb = read_floats(path, 3, image.width, image.height);
    return image;
}

GreyImage read_grey_image(const std::filesystem::path& path) {
    GreyImage image;
    image.values = read_floats(path, 1, image.width, image.height);
    return image;
}

}  // namespace raya
