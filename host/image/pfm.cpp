#include "host/image/pfm.hpp"

#include <fmt/core.h>

#include <bit>
#include <cstdint>
#include <utility>

namespace raya {
namespace {

void append_little_endian(std::string& bytes, float value) {
    const auto word = std::bit_cast<std::uint32_t>(value);
    for (int shift = 0; shift < 32; shift += 8) bytes += static_cast<char>(word >> shift & 255);
}

}  // namespace

PfmPieces::PfmPieces(int width, int height, int channels, std::span<const float> values)
    : left_(values),
      row_(values.size() / static_cast<std::size_t>(height)),
      piece_(fmt::format("{}\n{} {}\n-1.0\n", channels == 3 ? "PF" : "Pf", width, height)) {}

std::string_view PfmPieces::next() {
    if (!std::exchange(begun_, true)) return piece_;
    piece_.clear();
    if (left_.empty()) return piece_;
    for (const float value : left_.last(row_)) append_little_endian(piece_, value);
    left_ = left_.first(left_.size() - row_);
    return piece_;
}

}  // namespace raya
