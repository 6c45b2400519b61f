#include "host/image/image_io.hpp"

#include <fmt/core.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <cstdint>
#include <stdexcept>

#include "host/base/module.hpp"
#include "host/base/standard_streams.hpp"
#include "host/base/whole_file.hpp"
#include "host/error.hpp"
#include "host/image/pfm.hpp"
#include "host/image/ppm.hpp"

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

// Of stdout: of formats that need no library.
std::string lower_case_extension(const fs::path& path, std::span<const std::string_view> extensions) {
    if (is_standard_stream(path))
        return std::find(extensions.begin(), extensions.end(), ".ppm") != extensions.end() ? ".ppm" : ".pfm";
    std::string extension = path.extension().string();
    for (char& c : extension) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    return extension;
}

// OpenImageIO's name of what it encodes for us; none of the formats that this program writes without a library.
const char* encoded_format(const std::string& extension) {
    if (extension == ".png") return "png";
    if (extension == ".exr") return "exr";
    if (extension == ".tif" || extension == ".tiff") return "tiff";
    if (extension == ".jpg" || extension == ".jpeg") return "jpeg";
    return nullptr;
}

void check_shape(int width, int height, std::size_t channels, std::size_t floats) {
    const bool positive = width > 0 && height > 0;
    if (!positive || floats != static_cast<std::size_t>(width) * static_cast<std::size_t>(height) * channels)
        throw std::logic_error(
            fmt::format("{} floats are no {} x {} image of {} channels", floats, width, height, channels));
}

[[noreturn]] void refuse_to_encode(const fs::path& path, const std::string& reason, const std::string& remedy = "") {
    const char* plain = holds_codes(path) ? ".ppm" : ".pfm";  // as many bits, without a library
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
                   const ImageAttributes& attributes, double gamma = 0) {
    std::string told;
    if (!encoder(path)({format, pixels.width, pixels.height, pixels.channels, values, gamma, attributes}, told))
        refuse_to_encode(path, told);
    return told;
}

std::string encode_codes(const fs::path& path, const char* format, const Pixels& pixels,
                         const ImageAttributes& attributes, const Tone& tone) {
    const ToneCodes codes_of(tone);
    std::vector<std::uint8_t> codes;
    codes.reserve(pixels.values.size());
    for (std::size_t at = 0; at < pixels.values.size(); at += 3)
        for (const std::uint8_t code : codes_of(&pixels.values[at])) codes.push_back(code);
    return encode(path, format, pixels, codes.data(), attributes, tone.gamma.value_or(0));
}

template <class Pieces>
void write_pieces(const fs::path& path, Pieces pieces) {
    write_whole_file(path, [&] { return pieces.next(); });
}

// `tone`: of codes.
void write_pixels(const fs::path& path, const Pixels& pixels, const ImageAttributes& attributes,
                  const std::string& extension, const Tone& tone) {
    const char* const format = encoded_format(extension);
    if (extension == ".exr")
        return write_whole_file(path, encode(path, format, pixels, pixels.values.data(), attributes));
    if (format != nullptr) return write_whole_file(path, encode_codes(path, format, pixels, attributes, tone));
    if (extension == ".ppm") return write_pieces(path, PpmPieces(pixels.width, pixels.height, pixels.values, tone));
    write_pieces(path, PfmPieces(pixels.width, pixels.height, pixels.channels, pixels.values));
}

}  // namespace

bool holds_codes(const fs::path& path) {
    const std::string extension = lower_case_extension(path, kImageExtensions);
    return extension != ".exr" && extension != ".pfm";
}

void check_image_name(const fs::path& path, std::span<const std::string_view> extensions) {
    const std::string extension = lower_case_extension(path, extensions);
    if (std::find(extensions.begin(), extensions.end(), extension) != extensions.end()) return;
    throw UserError(fmt::format("cannot write '{}': its extension names no image format; use one of {}", path.string(),
                                fmt::join(extensions, ", ")));
}

void load_encoder(const fs::path& path) {
    if (encoded_format(lower_case_extension(path, kImageExtensions)) != nullptr) encoder(path);
}

void write_image(const fs::path& path, const Image& image, const ImageAttributes& attributes, const Tone& tone) {
    check_shape(image.width, image.height, 3, image.rgb.size());
    check_image_name(path, kImageExtensions);
    write_pixels(path, {image.width, image.height, 3, image.rgb}, attributes,
                 lower_case_extension(path, kImageExtensions), tone);
}

void write_image(const fs::path& path, const GreyImage& image, const ImageAttributes& attributes) {
    check_shape(image.width, image.height, 1, image.values.size());
    check_image_name(path, kGreyImageExtensions);
    write_pixels(path, {image.width, image.height, 1, image.values}, attributes,
                 lower_case_extension(path, kGreyImageExtensions), {});
}

}  // namespace raya
