#include "host/image/pfm.hpp"

#include <fmt/core.h>

#include <bit>
#include <cstdint>

namespace raya {
namespace {

void append_little_endian(std::string& bytes, float value) {
    const auto word = std::bit_cast<std::uint32_t>(value);
    for (int shift = 0; shift < 32; shift += 8) bytes += static_cast<char>(word >> shift & 255);
}

}  // namespace

std::string encode_pfm(int width, int height, int channels, std::span<const float> values) {
    std::string bytes = fmt::format("{}\n{} {}\n-1.0\n", channels == 3 ? "PF" : "Pf", width, height);
    bytes.reserve(bytes.size() + values.size_bytes());
    const std::size_t row = values.size() / static_cast<std::size_t>(height);
    for (std::size_t end = values.size(); end > 0; end -= row)
        for (const float value : values.subspan(end - row, row)) append_little_endian(bytes, value);
    return bytes;
}

}  // namespace raya
