// Random mappings of small images for tests. The number of PEs may be less than, equal to or more than the width.
#pragma once
#include <algorithm>
#include <cstdint>

#include "host/scene/split_mix.hpp"
#include "kernels/shared/mapping.h"
#include "tests/scene/random_below.hpp"

namespace raya {

/// Returns a random slot mapping of an image with sides of 1..`largest_side` pixels and 1 to width * height PEs.
inline raya_mapping small_mapping(SplitMix& random, std::uint32_t largest_side) {
    const auto side = [&] { return random.next() % 8 == 0 ? 1 : 1 + random_below(random, largest_side); };
    const std::uint32_t width = side(), height = side(), pixels = width * height;
    const std::uint32_t pe_counts[] = {1 + random_below(random, width),  width,
                                       1 + random_below(random, pixels), pixels,
                                       std::max(1u, pixels - 1),         std::min(pixels, width + 1)};
    const std::uint32_t fold = random.next() % 2 ? RAYA_FOLD_BLOCK : RAYA_FOLD_CYCLIC;
    return {width, height, pe_counts[random_below(random, 6)], random_below(random, width), fold};
}

/// Returns a random divisor of `side`; all divisors are equally likely.
inline std::uint32_t random_divisor(SplitMix& random, std::uint32_t side) {
    std::uint32_t divisor = 1 + random_below(random, side);
    while (side % divisor) divisor = 1 + random_below(random, side);
    return divisor;
}

/// Returns the mapping changed to `kind`, with a random parameter. A grid may have more rows or columns of PEs than the
/// image has rows or columns of pixels, but not more PEs than pixels.
inline raya_mapping mapping_of_kind(SplitMix& random, raya_mapping m, std::uint32_t kind) {
    const std::uint32_t pixels = m.width * m.height;
    m.kind = kind;
    if (kind > RAYA_FOLD_BLOCK) m.parameter = 0;
    if (kind == RAYA_TILES) m.parameter = raya_pair(random_divisor(random, m.width), random_divisor(random, m.height));
    if (kind == RAYA_RANDOM) m.parameter = static_cast<std::uint32_t>(random.next());
    if (kind == RAYA_GRID) {
        const std::uint32_t down = 1 + random_below(random, random.next() % 4 == 0 ? pixels : m.height);
        const std::uint32_t across = 1 + random_below(random, pixels / down);
        m.parameter = raya_pair(down, across);
        m.pes = down * across;
    }
    return m;
}

/// Returns a random mapping of a random kind.
inline raya_mapping any_mapping(SplitMix& random, std::uint32_t largest_side) {
    const raya_mapping m = small_mapping(random, largest_side);
    return mapping_of_kind(random, m, random_below(random, RAYA_RANDOM + 1));
}

}  // namespace raya
