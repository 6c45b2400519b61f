#include "host/image/plain_png.hpp"

#include <zlib.h>

#include <array>
#include <cstdint>
#include <cstdlib>
#include <new>
#include <stdexcept>
#include <string_view>

#include "host/image/tone.hpp"

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

}  // namespace raya
