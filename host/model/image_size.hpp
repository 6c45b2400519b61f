// The size of an image.
#pragma once
#include <cstdint>

namespace raya {

inline constexpr std::uint32_t kLargestSide = 16384;  // pixels

struct ImageSize {
    std::uint32_t width = 0, height = 0;  // pixels

    std::uint64_t pixels() const { return std::uint64_t{width} * height; }
    bool operator==(const ImageSize&) const = default;
};

}  // namespace raya
