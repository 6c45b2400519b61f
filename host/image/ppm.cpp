#include "host/image/ppm.hpp"

#include <fmt/core.h>

#include <utility>

#include "host/image/srgb.hpp"

namespace raya {

PpmPieces::PpmPieces(int width, int height, std::span<const float> values)
    : left_(values),
      row_(values.size() / static_cast<std::size_t>(height)),
      piece_(fmt::format("P6\n{} {}\n255\n", width, height)) {}

std::string_view PpmPieces::next() {
    if (!std::exchange(begun_, true)) return piece_;
    piece_.clear();
    if (left_.empty()) return piece_;
    for (const float value : left_.first(row_)) piece_ += static_cast<char>(srgb_code(value));
    left_ = left_.subspan(row_);
    return piece_;
}

}  // namespace raya
