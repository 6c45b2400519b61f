#include "host/image/image_io.hpp"

#include <fmt/core.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <bit>
#include <cctype>
#include <cstdint>
#include <stdexcept>

#include "host/base/module.hpp"
#include "host/base/standard_streams.hpp"
#include "host/base/whole_file.hpp"
#include "host/error.hpp"

namespace raya {
namespace fs = std::filesystem;
namespace {

/// A view of the floats of an Image or GreyImage.
struct Pixels {
    int width;
    int height;
    int channels;
    std::span<const float> values;

    std::span<const float> row(int number) const {
        const std::size_t length = static_cast<std::size_t>(width) * static_cast<std::size_t>(channels);
        return values.subspan(static_cast<std::size_t>(number) * length, length);
    }
};

// Returns the extension of `path` in lower case. For stdout, returns the extension of a format that needs no library:
// ".ppm" if it is one of `extensions`, else ".pfm".
std::string lower_case_extension(const fs::path& path, std::span<const std::string_view> extensions) {
    if (is_standard_stream(path))
        return std::find(extensions.begin(), extensions.end(), ".ppm") != extensions.end() ? ".ppm" : ".pfm";
    std::string extension = path.extension().string();
    for (char& c : extension) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    return extension;
}

// Returns OpenImageIO's name of the format, or null for a format that raya writes without OpenImageIO.
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
            fmt::format("{} floats are not a {} x {} image of {} channels", floats, width, height, channels));
}

[[noreturn]] void refuse_to_encode(const fs::path& path, const std::string& reason, const std::string& remedy = "") {
    // A format of the same precision that needs no library.
    const char* plain_extension = stores_8bit_codes(path) ? ".ppm" : ".pfm";
    throw UserError(
        fmt::format("cannot write '{}': {}; {}name a {} file instead", path.string(), reason, remedy, plain_extension));
}

/// Returns the module's encoding function. The first call loads the module. `path`: for error messages.
EncodePicture* encoder(const fs::path& path) {
    try {
        static auto* const function =
            reinterpret_cast<EncodePicture*>(module_function(kEncoderModule, kEncoderFunction));
        return function;
    } catch (const MissingLibrary& error) {
        refuse_to_encode(path, error.what(), "remedy: install " RAYA_PICTURES_NEED ", or ");
    } catch (const ModuleError& error) {
        refuse_to_encode(path, error.what());
    }
}

std::string encode(const fs::path& path, const char* format, const Pixels& pixels, const void* values,
                   const ImageAttributes& attributes) {
    std::string result;
    if (!encoder(path)({format, pixels.width, pixels.height, pixels.channels, values, attributes}, result))
        refuse_to_encode(path, result);
    return result;
}

std::string encode_codes(const fs::path& path, const char* format, const Pixels& pixels,
                         const ImageAttributes& attributes, double exposure) {
    const ToneCodes codes_of(exposure);
    std::vector<std::uint8_t> codes;
    codes.reserve(pixels.values.size());
    for (std::size_t at = 0; at < pixels.values.size(); at += 3)
        for (const std::uint8_t code : codes_of(&pixels.values[at])) codes.push_back(code);
    return encode(path, format, pixels, codes.data(), attributes);
}

// Writes a header, then one row at a time, so that memory never holds the whole file. append_row(bytes, row) appends
// the bytes of a row.
template <class AppendRow>
void write_rows(const fs::path& path, const Pixels& pixels, const std::string& header, const AppendRow& append_row) {
    std::string piece;
    int row = -1;  // row of the next piece; -1: the header
    write_whole_file(path, [&]() -> std::string_view {
        piece.clear();
        if (row < 0) piece = header;
        if (row >= 0 && row < pixels.height) append_row(piece, row);
        ++row;
        return piece;
    });
}

// Binary portable pixmap (PPM, J. Poskanzer): the lines `P6`, `width height` and `255`, then three 8-bit codes per
// pixel, the same as in a PNG, the top row first.
void write_ppm(const fs::path& path, const Pixels& pixels, double exposure) {
    const ToneCodes codes_of(exposure);
    const std::string header = fmt::format("P6\n{} {}\n255\n", pixels.width, pixels.height);
    write_rows(path, pixels, header, [&](std::string& bytes, int number) {
        const std::span<const float> row = pixels.row(number);
        for (std::size_t at = 0; at < row.size(); at += 3)
            for (const std::uint8_t code : codes_of(&row[at])) bytes += static_cast<char>(code);
    });
}

// Portable float map (PFM, P. Debevec): the lines `PF` (colour) or `Pf` (grey), `width height` and `-1.0`
// (little-endian, on any machine), then the floats, the bottom row first. OpenImageIO 2.4 reads PFM but does not write
// it.
void write_pfm(const fs::path& path, const Pixels& pixels) {
    const char* const magic = pixels.channels == 3 ? "PF" : "Pf";
    const std::string header = fmt::format("{}\n{} {}\n-1.0\n", magic, pixels.width, pixels.height);
    write_rows(path, pixels, header, [&](std::string& bytes, int number) {
        for (const float value : pixels.row(pixels.height - 1 - number))
            for (int shift = 0; shift < 32; shift += 8)
                bytes += static_cast<char>(std::bit_cast<std::uint32_t>(value) >> shift & 255);
    });
}

// Writes the pixels in the format of `extension`. `exposure` applies only to formats with 8-bit codes.
void write_pixels(const fs::path& path, const Pixels& pixels, const ImageAttributes& attributes,
                  const std::string& extension, double exposure) {
    const char* const format = encoded_format(extension);
    if (extension == ".exr")
        return write_whole_file(path, encode(path, format, pixels, pixels.values.data(), attributes));
    if (format != nullptr) return write_whole_file(path, encode_codes(path, format, pixels, attributes, exposure));
    if (extension == ".ppm") return write_ppm(path, pixels, exposure);
    write_pfm(path, pixels);
}

}  // namespace

bool stores_8bit_codes(const fs::path& path) {
    const std::string extension = lower_case_extension(path, kImageExtensions);
    return extension != ".exr" && extension != ".pfm";
}

void check_image_name(const fs::path& path, std::span<const std::string_view> extensions) {
    const std::string extension = lower_case_extension(path, extensions);
    if (std::find(extensions.begin(), extensions.end(), extension) != extensions.end()) return;
    throw UserError(fmt::format("cannot write '{}': its extension is not an image format; use one of {}", path.string(),
                                fmt::join(extensions, ", ")));
}

void load_encoder(const fs::path& path) {
    if (encoded_format(lower_case_extension(path, kImageExtensions)) != nullptr) encoder(path);
}

void write_image(const fs::path& path, const Image& image, const ImageAttributes& attributes, double exposure) {
    check_shape(image.width, image.height, 3, image.rgb.size());
    check_image_name(path, kImageExtensions);
    write_pixels(path, {image.width, image.height, 3, image.rgb}, attributes,
                 lower_case_extension(path, kImageExtensions), exposure);
}

void write_image(const fs::path& path, const GreyImage& image, const ImageAttributes& attributes) {
    check_shape(image.width, image.height, 1, image.values.size());
    check_image_name(path, kGreyImageExtensions);
    write_pixels(path, {image.width, image.height, 1, image.values}, attributes,
                 lower_case_extension(path, kGreyImageExtensions), {});
}

}  // namespace raya
