// Mappings of small images for tests, with every relation of P to W and H now and then.
#pragma once
#include <algorithm>
#include <cstdint>

#include "scene/split_mix.hpp"
#include "shared/mapping.h"

namespace raya {

/// In [0, end).
inline std::uint32_t random_below(SplitMix& random, std::uint64_t end) {
    return static_cast<std::uint32_t>(random.next() % end);
}

/// Sides are 1..`largest_side`, PEs 1..W H.
inline raya_mapping small_mapping(SplitMix& random, std::uint32_t largest_side) {
    const auto side = [&] { return random.next() % 8 == 0 ? 1 : 1 + random_below(random, largest_side); };
    const std::uint32_t width = side(), height = side(), pixels = width * height;
    const std::uint32_t choices[] = {1 + random_below(random, width),  width,
                                     1 + random_below(random, pixels), pixels,
                                     std::max(1u, pixels - 1),         std::min(pixels, width + 1)};
    const std::uint32_t fold = random.next() % 2 ? RAYA_FOLD_BLOCK : RAYA_FOLD_CYCLIC;
    return {width, height, choices[random_below(random, 6)], random_below(random, width), fold};
}

}  // namespace raya
