#include "host/image/image_io.hpp"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>
#include <fmt/core.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <cstdint>
#include <stdexcept>

#include "host/error.hpp"
#include "host/files/whole_file.hpp"
#include "host/image/pfm.hpp"
#include "host/image/srgb.hpp"

namespace raya {
namespace fs = std::filesystem;
namespace {

constexpr OIIO::imagesize_t kMaxPixelsRead = 1 << 28;  // so that a damaged header does not ask for all memory

/// Floats as they lie in Image and GreyImage.
struct Pixels {
    int width;
    int height;
    int channels;
    std::span<const float> values;
};

std::string lower_case_extension(const fs::path& path) {
    std::string extension = path.extension().string();
    for (char& c : extension) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    return extension;
}

void check_extension(const fs::path& path, std::span<const std::string_view> extensions) {
    if (std::find(extensions.begin(), extensions.end(), lower_case_extension(path)) != extensions.end()) return;
    throw UserError(fmt::format("cannot write '{}': its extension names no image format; use one of {}", path.string(),
                                fmt::join(extensions, ", ")));
}

void check_shape(int width, int height, std::size_t channels, std::size_t floats) {
    const bool positive = width > 0 && height > 0;
    if (!positive || floats != static_cast<std::size_t>(width) * static_cast<std::size_t>(height) * channels)
        throw std::logic_error(
            fmt::format("{} floats are no {} x {} image of {} channels", floats, width, height, channels));
}

OIIO::ImageSpec make_spec(const Pixels& pixels, const OIIO::TypeDesc& type, const ImageAttributes& attributes) {
    OIIO::ImageSpec spec(pixels.width, pixels.height, pixels.channels, type);
    if (pixels.channels == 1) spec.channelnames = {"Y"};
    spec.attribute("oiio:ColorSpace", type == OIIO::TypeDesc::UINT8 ? "sRGB" : "Linear");
    for (const auto& [key, text] : attributes) spec.attribute("raya:" + key, text);
    return spec;
}

/// The bytes of a file in OpenImageIO's format of that name. Made in memory, so that writing is checked in one place.
std::string encode(const fs::path& path, const char* format, const OIIO::ImageSpec& spec, const void* data) {
    const auto fail = [&](const std::string& reason) {
        throw UserError(fmt::format("cannot write '{}': {}; name a .pfm file instead", path.string(), reason));
    };
    OIIO::Filesystem::IOVecOutput bytes;
    const auto output = OIIO::ImageOutput::create(format, &bytes);
    if (!output) fail(OIIO::geterror());
    const std::string name = std::string("memory.") + format;  // stands in no file
    if (!output->open(name, spec) || !output->write_image(spec.format, data) || !output->close())
        fail(output->geterror());
    return {bytes.buffer().begin(), bytes.buffer().end()};
}

std::string encode_png(const fs::path& path, const Pixels& pixels, const ImageAttributes& attributes) {
    std::vector<std::uint8_t> codes(pixels.values.size());
    std::transform(pixels.values.begin(), pixels.values.end(), codes.begin(), srgb_code);
    return encode(path, "png", make_spec(pixels, OIIO::TypeDesc::UINT8, attributes), codes.data());
}

std::string encode_exr(const fs::path& path, const Pixels& pixels, const ImageAttributes& attributes) {
    OIIO::ImageSpec spec = make_spec(pixels, OIIO::TypeDesc::FLOAT, attributes);
    spec.attribute("compression", "zip");
    // Without a date OpenImageIO puts in today's; one that is no string it leaves out, with a debugging message.
    spec.attribute("DateTime", 0);
    OIIO::attribute("debug", 0);
    return encode(path, "exr", spec, pixels.values.data());
}

void write_pixels(const fs::path& path, const Pixels& pixels, const ImageAttributes& attributes) {
    const std::string extension = lower_case_extension(path);
    if (extension == ".png") return write_whole_file(path, encode_png(path, pixels, attributes));
    if (extension == ".exr") return write_whole_file(path, encode_exr(path, pixels, attributes));
    write_whole_file(path, encode_pfm(pixels.width, pixels.height, pixels.channels, pixels.values));
}

[[noreturn]] void refuse_to_read(const fs::path& path, std::string_view reason) {
    throw UserError(fmt::format("cannot read '{}': {}; give an image that raya wrote", path.string(), reason));
}

bool read_pixels(OIIO::ImageInput& input, const OIIO::TypeDesc& type, void* pixels) {
    const int subimage = 0, level = 0, first_channel = 0, end_channel = -1;  // -1: all of them
    return input.read_image(subimage, level, first_channel, end_channel, type, pixels);
}

/// The floats of a file with that many channels, in `width` x `height` pixels, both set from the file.
std::vector<float> read_floats(const fs::path& path, int channels, int& width, int& height) {
    const auto input = OIIO::ImageInput::open(path.string());
    if (!input) refuse_to_read(path, OIIO::geterror());
    const OIIO::ImageSpec& spec = input->spec();
    if (spec.nchannels != channels)
        refuse_to_read(path, fmt::format("it has {} channels, not {}", spec.nchannels, channels));
    if (spec.image_pixels() > kMaxPixelsRead)
        refuse_to_read(path, fmt::format("{} x {} pixels are too many", spec.width, spec.height));
    width = spec.width;
    height = spec.height;
    std::vector<float> values(spec.image_pixels() * static_cast<std::size_t>(channels));
    if (spec.format != OIIO::TypeDesc::UINT8) {
        if (!read_pixels(*input, OIIO::TypeDesc::FLOAT, values.data())) refuse_to_read(path, input->geterror());
        return values;
    }
    std::vector<std::uint8_t> codes(values.size());
    if (!read_pixels(*input, OIIO::TypeDesc::UINT8, codes.data())) refuse_to_read(path, input->geterror());
    std::transform(codes.begin(), codes.end(), values.begin(), linear_from_srgb_code);
    return values;
}

}  // namespace

void check_writable_target(const fs::path& path, std::span<const std::string_view> extensions) {
    check_extension(path, extensions);
    check_writable(path);
}

void write_image(const fs::path& path, const Image& image, const ImageAttributes& attributes) {
    check_shape(image.width, image.height, 3, image.rgb.size());
    check_extension(path, kImageExtensions);
    write_pixels(path, {image.width, image.height, 3, image.rgb}, attributes);
}

void write_image(const fs::path& path, const GreyImage& image, const ImageAttributes& attributes) {
    check_shape(image.width, image.height, 1, image.values.size());
    check_extension(path, kGreyImageExtensions);
    write_pixels(path, {image.width, image.height, 1, image.values}, attributes);
}

Image read_image(const fs::path& path) {
    Image image;
    image.rgb = read_floats(path, 3, image.width, image.height);
    return image;
}

GreyImage read_grey_image(const fs::path& path) {
    GreyImage image;
    image.values = read_floats(path, 1, image.width, image.height);
    return image;
}

}  // namespace raya
