#include "host/image/image_io.hpp"

#include <fmt/core.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <cstdint>
#include <stdexcept>

#include "host/error.hpp"
#include "host/files/module.hpp"
#include "host/files/whole_file.hpp"
#include "host/image/pfm.hpp"
#include "host/image/ppm.hpp"
#include "host/image/srgb.hpp"

namespace raya {
namespace fs = std::filesystem;
namespace {

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

[[noreturn]] void refuse_to_encode(const fs::path& path, const std::string& reason, const std::string& remedy = "") {
    const char* plain = lower_case_extension(path) == ".exr" ? ".pfm" : ".ppm";  // as many bits, without a library
    throw UserError(
        fmt::format("cannot write '{}': {}; {}name a {} file instead", path.string(), reason, remedy, plain));
}

/// Loads the module at the first call.
EncodePicture* encoder(const fs::path& path) {
    try {
        static auto* const function =
            reinterpret_cast<EncodePicture*>(module_function(kEncoderModule, kEncoderFunction));
        return function;
    } catch (const ModuleNeeds& error) {
        refuse_to_encode(path, error.what(), "remedy: install " RAYA_PICTURES_NEED ", or ");
    } catch (const ModuleError& error) {
        refuse_to_encode(path, error.what());
    }
}

std::string encode(const fs::path& path, const char* format, const Pixels& pixels, const void* values,
                   const ImageAttributes& attributes) {
    std::string told;
    if (!encoder(path)({format, pixels.width, pixels.height, pixels.channels, values, attributes}, told))
        refuse_to_encode(path, told);
    return told;
}

std::string encode_png(const fs::path& path, const Pixels& pixels, const ImageAttributes& attributes) {
    std::vector<std::uint8_t> codes(pixels.values.size());
    std::transform(pixels.values.begin(), pixels.values.end(), codes.begin(), srgb_code);
    return encode(path, "png", pixels, codes.data(), attributes);
}

/// True of the formats that this program writes without a library.
bool is_plain(const std::string& extension) { return extension == ".pfm" || extension == ".ppm"; }

template <class Pieces>
void write_pieces(const fs::path& path, Pieces pieces) {
    write_whole_file(path, [&] { return pieces.next(); });
}

void write_pixels(const fs::path& path, const Pixels& pixels, const ImageAttributes& attributes) {
    const std::string extension = lower_case_extension(path);
    if (extension == ".png") return write_whole_file(path, encode_png(path, pixels, attributes));
    if (extension == ".exr")
        return write_whole_file(path, encode(path, "exr", pixels, pixels.values.data(), attributes));
    if (extension == ".ppm") return write_pieces(path, PpmPieces(pixels.width, pixels.height, pixels.values));
    write_pieces(path, PfmPieces(pixels.width, pixels.height, pixels.channels, pixels.values));
}

}  // namespace

void check_writable_target(const fs::path& path, std::span<const std::string_view> extensions) {
    check_extension(path, extensions);
    check_writable(path);
    if (!is_plain(lower_case_extension(path))) encoder(path);
}

void write_image(const fs::path& path, const Image& image, const ImageAttributes& attributes) {
    check_shape(image.width, image.height, 3, image.rgb.size());
    check_extension(path, kImageExtensions);
    write_pixels(path, {image.width, image.height, 3, image.rgb}, attributes);
}

std::string png_of(const Image& image, const ImageAttributes& attributes) {
    check_shape(image.width, image.height, 3, image.rgb.size());
    return encode_png("picture.png", {image.width, image.height, 3, image.rgb}, attributes);
}

void write_image(const fs::path& path, const GreyImage& image, const ImageAttributes& attributes) {
    check_shape(image.width, image.height, 1, image.values.size());
    check_extension(path, kGreyImageExtensions);
    write_pixels(path, {image.width, image.height, 1, image.values}, attributes);
}

}  // namespace raya
