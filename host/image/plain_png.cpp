#include "host/image/plain_png.hpp"

#include <zlib.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <new>
#include <stdexcept>
#include <string_view>

#include "host/image/image.hpp"

namespace raya {
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

}  // namespace raya
