#include "host/image/image_io.hpp"

#include <fmt/core.h>
#include <fmt/ranges.h>
#include <zlib.h>

#include <algorithm>
#include <bit>
#include <cctype>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <limits>
#include <new>
#include <stdexcept>

#include "host/base/encoding.hpp"
#include "host/base/module.hpp"
#include "host/base/whole_file.hpp"
#include "host/error.hpp"

namespace raya {
std::string pixel_hash(const Image& image) {
    std::vector<std::uint32_t> words = {static_cast<std::uint32_t>(image.width),
                                        static_cast<std::uint32_t>(image.height)};
    words.reserve(words.size() + image.rgb.size());
    for (const float value : image.rgb) words.push_back(std::bit_cast<std::uint32_t>(value));
    return words_hash(words);
}

namespace {

double linear_from_srgb(double encoded) {
    return encoded <= 0.04045 ? encoded / 12.92 : std::pow((encoded + 0.055) / 1.055, 2.4);
}

}  // namespace

std::uint8_t srgb_code(double linear) {
    // borders[k]: the linear value at which the nearest code changes from k to k + 1
    static const std::array<double, 255> borders = [] {
        std::array<double, 255> all;
        for (std::size_t k = 0; k < all.size(); ++k) all[k] = linear_from_srgb((static_cast<double>(k) + 0.5) / 255);
        return all;
    }();
    return static_cast<std::uint8_t>(std::lower_bound(borders.begin(), borders.end(), linear) - borders.begin());
}

std::vector<std::uint8_t> srgb_codes(std::span<const float> values, double exposure) {
    constexpr double kMaxFloat = std::numeric_limits<float>::max();
    const double factor = std::exp2(exposure);
    std::vector<std::uint8_t> codes;
    codes.reserve(values.size());
    for (const float value : values)
        codes.push_back(std::isnan(value) ? 0 : srgb_code(factor * std::clamp<double>(value, -kMaxFloat, kMaxFloat)));
    return codes;
}

namespace {

constexpr std::size_t kChannels = 3;

void append_word(std::string& bytes, std::uint32_t word) {
    for (const int shift : {24, 16, 8, 0}) bytes += static_cast<char>(word >> shift & 0xff);
}

// Appends a chunk: length of the data, name, data, CRC of name and data.
void append_chunk(std::string& file, const char* name, std::string_view data) {
    append_word(file, static_cast<std::uint32_t>(data.size()));
    const std::string checked = std::string(name) + std::string(data);
    file += checked;
    const void* const bytes = checked.data();
    append_word(file, static_cast<std::uint32_t>(
                          crc32(0, static_cast<const Bytef*>(bytes), static_cast<uInt>(checked.size()))));
}

// Returns the filtered rows of an image: for each the filter type 2 (Up), and the differences between its bytes and
// those above.
std::string filtered_rows(const std::vector<std::uint8_t>& codes, std::size_t row_bytes) {
    constexpr char kUp = 2;
    std::string rows;
    for (std::size_t i = 0; i < codes.size(); ++i) {
        if (i % row_bytes == 0) rows += kUp;
        rows += static_cast<char>(codes[i] - (i < row_bytes ? 0 : codes[i - row_bytes]));
    }
    return rows;
}

std::string deflated(const std::string& text) {
    uLongf size = compressBound(static_cast<uLong>(text.size()));
    std::string bytes(size, '\0');
    void* const output = bytes.data();
    const void* const input = text.data();
    const int code = compress2(static_cast<Bytef*>(output), &size, static_cast<const Bytef*>(input),
                               static_cast<uLong>(text.size()), Z_DEFAULT_COMPRESSION);
    if (code != Z_OK) throw std::bad_alloc();  // the only possible error: the buffer is large enough
    bytes.resize(size);
    return bytes;
}

// Portable network graphics (PNG, ISO/IEC 15948), from three 8-bit codes per pixel.
std::string png_bytes(int width, int height, const std::vector<std::uint8_t>& codes) {
    std::string header;
    append_word(header, static_cast<std::uint32_t>(width));
    append_word(header, static_cast<std::uint32_t>(height));
    header += {8, 2, 0, 0, 0};  // bit depth 8, RGB, deflate, a filter type for each row, no interlacing
    std::string file = "\x89PNG\r\n\x1a\n";
    append_chunk(file, "IHDR", header);
    append_chunk(file, "sRGB", std::string(1, '\0'));  // rendering intent: perceptual
    append_chunk(file, "IDAT", deflated(filtered_rows(codes, kChannels * static_cast<std::size_t>(width))));
    append_chunk(file, "IEND", {});
    return file;
}

}  // namespace

std::string plain_png(const Image& image) {
    if (image.width < 1 || image.height < 1 ||
        image.rgb.size() != kChannels * static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height))
        throw std::logic_error("plain_png: the image must have pixels of three floats");
    return png_bytes(image.width, image.height, srgb_codes(image.rgb, 0));
}

namespace {

double clamped_light(float value) { return value > 0 ? std::min(1.0, static_cast<double>(value)) : 0; }

// Returns the first pixel of part number `part`, if a row or column of `pixels` pixels is divided into `parts` parts of
// about equal size.
std::size_t first_pixel(int part, int parts, int pixels) {
    return static_cast<std::size_t>(std::int64_t{part} * pixels / parts);
}

}  // namespace

Image as_displayed(const Image& image, double exposure) {
    Image displayed{image.width, image.height, {}};
    displayed.rgb.reserve(image.rgb.size());
    for (const std::uint8_t code : srgb_codes(image.rgb, exposure))
        displayed.rgb.push_back(static_cast<float>(linear_from_srgb(code / 255.0)));
    return displayed;
}

Image preview_of(const Image& image, int max_side) {
    if (image.width < 1 || image.height < 1 || max_side < 1) throw std::logic_error("preview_of: no pixels");
    const int longer_side = std::max(image.width, image.height);
    const auto reduced = [&](std::int64_t side) {  // both sides by the same factor, to at least 1 pixel
        if (longer_side <= max_side) return static_cast<int>(side);
        return std::max(1, static_cast<int>((side * max_side + longer_side / 2) / longer_side));
    };
    Image preview{reduced(image.width), reduced(image.height), {}};
    const auto width = static_cast<std::size_t>(image.width);
    for (int y = 0; y < preview.height; ++y)
        for (int x = 0; x < preview.width; ++x) {
            const std::size_t top = first_pixel(y, preview.height, image.height),
                              end_row = first_pixel(y + 1, preview.height, image.height),
                              left = first_pixel(x, preview.width, image.width),
                              end_column = first_pixel(x + 1, preview.width, image.width);
            double sums[3] = {};
            for (std::size_t row = top; row < end_row; ++row)
                for (std::size_t column = left; column < end_column; ++column)
                    for (std::size_t c = 0; c < 3; ++c)
                        sums[c] += clamped_light(image.rgb[3 * (row * width + column) + c]);
            const auto pixels = static_cast<double>((end_row - top) * (end_column - left));
            for (const double sum : sums) preview.rgb.push_back(static_cast<float>(sum / pixels));
        }
    return preview;
}

namespace fs = std::filesystem;
namespace {

/// A view of the floats of an Image or GreyImage.
struct Pixels {
    int width;
    int height;
    int channels;
    std::span<const float> values;
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
    if (extension == ".exr") return "exr";
    if (extension == ".tif" || extension == ".tiff") return "tiff";
    if (extension == ".jpg" || extension == ".jpeg") return "jpeg";
    return nullptr;
}

[[noreturn]] void refuse_to_encode(const fs::path& path, const std::string& reason, const std::string& remedy = "") {
    // A format of the same precision that needs no library.
    const char* plain_extension = stores_8bit_codes(path) ? ".png" : ".pfm";
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

std::string encode(const fs::path& path, const char* format, const Pixels& pixels, const void* values) {
    std::string result;
    if (!encoder(path)({format, pixels.width, pixels.height, pixels.channels, values}, result))
        refuse_to_encode(path, result);
    return result;
}

// Binary portable pixmap (PPM, J. Poskanzer): the lines `P6`, `width height` and `255`, then three 8-bit codes per
// pixel, the same as in a PNG, the top row first.
std::string ppm_bytes(const Pixels& pixels, const std::vector<std::uint8_t>& codes) {
    return fmt::format("P6\n{} {}\n255\n", pixels.width, pixels.height).append(codes.begin(), codes.end());
}

// Portable float map (PFM, P. Debevec): the lines `PF` (colour) or `Pf` (grey), `width height` and `-1.0`
// (little-endian, on any machine), then the floats, the bottom row first. OpenImageIO 2.4 reads PFM but does not write
// it.
std::string pfm_bytes(const Pixels& pixels) {
    std::string bytes =
        fmt::format("{}\n{} {}\n-1.0\n", pixels.channels == 3 ? "PF" : "Pf", pixels.width, pixels.height);
    const std::size_t row_floats = pixels.values.size() / static_cast<std::size_t>(pixels.height);
    for (std::size_t end = pixels.values.size(); end > 0; end -= row_floats)
        for (const float value : pixels.values.subspan(end - row_floats, row_floats))
            for (int shift = 0; shift < 32; shift += 8)
                bytes += static_cast<char>(std::bit_cast<std::uint32_t>(value) >> shift & 255);
    return bytes;
}

// Writes the pixels in the format of the extension. `exposure` applies only to formats with 8-bit codes.
void write_pixels(const fs::path& path, const Pixels& pixels, std::span<const std::string_view> extensions,
                  double exposure) {
    const bool positive = pixels.width > 0 && pixels.height > 0;
    if (!positive || pixels.values.size() != static_cast<std::size_t>(pixels.width) *
                                                 static_cast<std::size_t>(pixels.height * pixels.channels))
        throw std::logic_error(fmt::format("{} floats are not a {} x {} image of {} channels", pixels.values.size(),
                                           pixels.width, pixels.height, pixels.channels));
    check_image_name(path, extensions);
    const std::string extension = lower_case_extension(path, extensions);
    const char* const format = encoded_format(extension);
    if (extension == ".pfm") return write_whole_file(path, pfm_bytes(pixels));
    if (extension == ".exr") return write_whole_file(path, encode(path, format, pixels, pixels.values.data()));
    const std::vector<std::uint8_t> codes = srgb_codes(pixels.values, exposure);
    write_whole_file(path, format != nullptr     ? encode(path, format, pixels, codes.data())
                           : extension == ".png" ? png_bytes(pixels.width, pixels.height, codes)
                                                 : ppm_bytes(pixels, codes));
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

void write_image(const fs::path& path, const Image& image, double exposure) {
    write_pixels(path, {image.width, image.height, 3, image.rgb}, kImageExtensions, exposure);
}

void write_image(const fs::path& path, const GreyImage& image) {
    write_pixels(path, {image.width, image.height, 1, image.values}, kGreyImageExtensions, 0);
}

}  // namespace raya
