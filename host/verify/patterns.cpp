#include "host/verify/patterns.hpp"

#include <algorithm>

#include "host/model/image_size.hpp"
#include "host/scene/split_mix.hpp"

namespace raya {
namespace {

std::uint32_t below(SplitMix& random, std::uint32_t end) { return static_cast<std::uint32_t>(random.next() % end); }

std::uint32_t divisor_of(SplitMix& random, std::uint32_t side) {
    std::uint32_t divisor = 1 + below(random, side);
    while (side % divisor) --divisor;
    return divisor;
}

// A side of an image: small, any, the largest.
std::uint32_t side(SplitMix& random) {
    const std::uint32_t kinds[] = {1 + below(random, 40), 1 + below(random, kLargestSide), kLargestSide};
    return kinds[below(random, 3)];
}

raya_mapping drawn_mapping(SplitMix& random, std::uint32_t kind) {
    raya_mapping m{side(random), side(random), 1, 0, kind};
    const std::uint32_t pixels = m.width * m.height;
    const std::uint32_t pes[] = {1 + below(random, m.width), 1 + below(random, pixels), m.width, pixels};
    m.pes = pes[below(random, 4)];
    if (raya_has_slots(m)) m.parameter = below(random, m.width);
    if (kind == RAYA_TILES) m.parameter = raya_pair(divisor_of(random, m.width), divisor_of(random, m.height));
    if (kind == RAYA_RANDOM) m.parameter = static_cast<std::uint32_t>(random.next());
    if (kind == RAYA_GRID) {
        const std::uint32_t down = 1 + below(random, m.height), across = 1 + below(random, m.width);
        m.parameter = raya_pair(down, across);
        m.pes = down * across;
    }
    return m;
}

}  // namespace

std::pair<std::vector<raya_mapping>, std::vector<raya_pixel>> mapping_cases(std::uint32_t kind, std::size_t count) {
    constexpr std::uint64_t kSeed = 1993;
    SplitMix random(kSeed + kind);
    std::vector<raya_mapping> mappings;
    std::vector<raya_pixel> pixels;
    for (std::size_t i = 0; i < count; ++i) {
        const raya_mapping m = drawn_mapping(random, kind);
        mappings.push_back(m);
        pixels.push_back(
            {i % 8 ? below(random, m.height) : m.height - 1, i % 4 ? below(random, m.width) : m.width - 1});
    }
    return {mappings, pixels};
}

std::pair<std::vector<raya_torus>, std::vector<std::uint32_t>> torus_cases(std::size_t count) {
    constexpr std::uint64_t kSeed = 805;
    SplitMix random(kSeed);
    std::vector<raya_torus> toruses;
    std::vector<std::uint32_t> nodes;
    for (std::size_t i = 0; i < count; ++i) {
        const auto any = [&] { return 1 + below(random, i % 5 ? 7 : 40); };
        const raya_torus torus = make_torus({any(), any(), any()}, i % 2 ? Links::kTorus2d : Links::kTorus3d);
        toruses.push_back(torus);
        for (int k = 0; k < 2; ++k) nodes.push_back(below(random, raya_nodes(torus)));
    }
    return {toruses, nodes};
}

}  // namespace raya
