#include "host/image/ppm.hpp"

#include <fmt/core.h>

#include <utility>

namespace raya {

PpmPieces::PpmPieces(int width, int height, std::span<const float> values, const Tone& tone)
    : codes_(tone),
      left_(values),
      row_(values.size() / static_cast<std::size_t>(height)),
      piece_(fmt::format("P6\n{} {}\n255\n", width, height)) {}

std::string_view PpmPieces::next() {
    if (!std::exchange(begun_, true)) return piece_;
    piece_.clear();
    if (left_.empty()) return piece_;
    for (std::size_t at = 0; at < row_; at += 3)
        for (const std::uint8_t code : codes_(&left_[at])) piece_ += static_cast<char>(code);
    left_ = left_.subspan(row_);
    return piece_;
}

}  // namespace raya
