#include "host/image/image_io.hpp"

#include <fmt/core.h>
#include <fmt/ranges.h>
#include <xxhash.h>
#include <zlib.h>

#include <algorithm>
#include <bit>
#include <cctype>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <limits>
#include <memory>
#include <new>
#include <stdexcept>

#include "host/base/encoding.hpp"
#include "host/base/module.hpp"
#include "host/base/whole_file.hpp"
#include "host/error.hpp"

namespace raya {
namespace {

/// Computes XXH3 incrementally, over 32-bit words in little-endian byte order.
class WordHash {
  public:
    WordHash() : state_(XXH3_createState(), &XXH3_freeState) {
        if (!state_) throw std::bad_alloc();
        XXH3_128bits_reset(state_.get());
    }

    void add(std::uint32_t word) {
        for (int shift = 0; shift < 32; shift += 8) bytes_.push_back(static_cast<unsigned char>(word >> shift));
        if (bytes_.size() == kBlockBytes) flush();
    }

    std::string hex() {
        flush();
        XXH128_canonical_t canonical;
        XXH128_canonicalFromHash(&canonical, XXH3_128bits_digest(state_.get()));
        return hex_digits(canonical.digest);
    }

  private:
    static constexpr std::size_t kBlockBytes = 1 << 16;  // a multiple of 4, so that add() fills a block exactly

    void flush() {
        XXH3_128bits_update(state_.get(), bytes_.data(), bytes_.size());
        bytes_.clear();
    }

    std::unique_ptr<XXH3_state_t, decltype(&XXH3_freeState)> state_;
    std::vector<unsigned char> bytes_;
};

}  // namespace

std::string pixel_hash(const Image& image) {
    WordHash hash;
    hash.add(static_cast<std::uint32_t>(image.width));
    hash.add(static_cast<std::uint32_t>(image.height));
    for (const float value : image.rgb) hash.add(std::bit_cast<std::uint32_t>(value));
    return hash.hex();
}

namespace {

double linear_from_srgb(double encoded) {
    return encoded <= 0.04045 ? encoded / 12.92 : std::pow((encoded + 0.055) / 1.055, 2.4);
}

/// Returns the code 0..255 that is nearest to 255 curve(linear), for the curve of `borders`; 0 for negative values and
/// NaN, 255 above 1.
std::uint8_t nearest_code(const CodeBorders& borders, double linear) {
    const auto border = std::lower_bound(borders.begin(), borders.end(), linear);
    return static_cast<std::uint8_t>(border - borders.begin());
}

/// Returns the borders of the sRGB curve.
const CodeBorders& srgb_borders() {
    static const CodeBorders borders = [] {
        CodeBorders all;
        for (std::size_t k = 0; k < all.size(); ++k) all[k] = linear_from_srgb((static_cast<double>(k) + 0.5) / 255);
        return all;
    }();
    return borders;
}

}  // namespace

float srgb_light(std::uint8_t code) { return static_cast<float>(linear_from_srgb(code / 255.0)); }

std::uint8_t srgb_code(float linear) { return nearest_code(srgb_borders(), static_cast<double>(linear)); }

ToneCodes::ToneCodes(double exposure) : factor_(std::exp2(exposure)) {
    for (std::size_t k = 0; k < codes_.size(); ++k)
        codes_[k] = nearest_code(srgb_borders(), static_cast<double>(k) / kCells);
}

std::array<std::uint8_t, 3> ToneCodes::operator()(const float* rgb) const {
    constexpr double kMaxFloat = std::numeric_limits<float>::max();
    const CodeBorders& borders = srgb_borders();
    std::array<std::uint8_t, 3> codes{};
    for (std::size_t i = 0; i < 3; ++i) {
        const double linear = std::isnan(rgb[i]) ? 0 : factor_ * std::clamp<double>(rgb[i], -kMaxFloat, kMaxFloat);
        std::size_t code = codes_[static_cast<std::size_t>(std::clamp(linear, 0.0, 1.0) * kCells)];
        while (code < borders.size() && borders[code] < linear) ++code;
        codes[i] = static_cast<std::uint8_t>(code);
    }
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

// Paeth's predictor (filter type 4): returns the neighbouring byte that is nearest to left + above - corner. `corner`:
// the byte above `left`.
std::uint8_t prediction(int left, int above, int corner) {
    const int p = left + above - corner;
    const int a = std::abs(p - left), b = std::abs(p - above), c = std::abs(p - corner);
    return static_cast<std::uint8_t>(a <= b && a <= c ? left : b <= c ? above : corner);
}

// Returns the filtered rows of the image. A filtered row is the filter type, followed by the differences between the
// row's bytes and their predictions.
std::string filtered_rows(const Image& image) {
    constexpr char kPaeth = 4;
    const std::size_t row_bytes = kChannels * static_cast<std::size_t>(image.width);
    std::string above(row_bytes, '\0'), row(row_bytes, '\0'), rows;
    const auto byte_at = [](const std::string& codes, std::size_t i) { return static_cast<std::uint8_t>(codes[i]); };
    for (std::size_t y = 0; y < static_cast<std::size_t>(image.height); ++y) {
        rows += kPaeth;
        for (std::size_t i = 0; i < row_bytes; ++i) {
            row[i] = static_cast<char>(srgb_code(image.rgb[y * row_bytes + i]));
            const int left = i < kChannels ? 0 : byte_at(row, i - kChannels);
            const int corner = i < kChannels ? 0 : byte_at(above, i - kChannels);
            rows += static_cast<char>(byte_at(row, i) - prediction(left, byte_at(above, i), corner));
        }
        std::swap(row, above);
    }
    return rows;
}

std::string deflated(const std::string& text) {
    uLongf size = compressBound(static_cast<uLong>(text.size()));
    std::string bytes(size, '\0');
    void* const output = bytes.data();
    const void* const input = text.data();
    const int code = compress2(static_cast<Bytef*>(output), &size, static_cast<const Bytef*>(input),
                               static_cast<uLong>(text.size()), Z_BEST_COMPRESSION);
    if (code != Z_OK) throw std::bad_alloc();  // the only possible error: the buffer is large enough
    bytes.resize(size);
    return bytes;
}

}  // namespace

std::string plain_png(const Image& image) {
    if (image.width < 1 || image.height < 1 ||
        image.rgb.size() != kChannels * static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height))
        throw std::logic_error("plain_png: the image must have pixels of three floats");
    std::string header;
    append_word(header, static_cast<std::uint32_t>(image.width));
    append_word(header, static_cast<std::uint32_t>(image.height));
    header += {8, 2, 0, 0, 0};  // bit depth 8, RGB, deflate, a filter type for each row, no interlacing
    std::string file = "\x89PNG\r\n\x1a\n";
    append_chunk(file, "IHDR", header);
    append_chunk(file, "sRGB", std::string(1, '\0'));  // rendering intent: perceptual
    append_chunk(file, "IDAT", deflated(filtered_rows(image)));
    append_chunk(file, "IEND", {});
    return file;
}

namespace {

double clamped_light(float value) { return value > 0 ? std::min(1.0, static_cast<double>(value)) : 0; }

// Returns the first pixel of part number `part`, if a row or column of `pixels` pixels is divided into `parts` parts of
// about equal size.
std::size_t first_pixel(int part, int parts, int pixels) {
    return static_cast<std::size_t>(std::int64_t{part} * pixels / parts);
}

}  // namespace

int preview_side(int image_side, int longer_side, int max_side) {
    if (longer_side <= max_side) return image_side;
    return std::max(1, static_cast<int>((std::int64_t{image_side} * max_side + longer_side / 2) / longer_side));
}

Image as_displayed(const Image& image, double exposure) {
    const ToneCodes codes(exposure);
    Image displayed{image.width, image.height, {}};
    displayed.rgb.reserve(image.rgb.size());
    for (std::size_t at = 0; at + 2 < image.rgb.size(); at += 3)
        for (const std::uint8_t code : codes(&image.rgb[at])) displayed.rgb.push_back(srgb_light(code));
    return displayed;
}

Image preview_of(const Image& image, int max_side) {
    if (image.width < 1 || image.height < 1 || max_side < 1) throw std::logic_error("preview_of: no pixels");
    const int longer_side = std::max(image.width, image.height);
    Image preview{
        preview_side(image.width, longer_side, max_side), preview_side(image.height, longer_side, max_side), {}};
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
