// Cost images and settings for the explorer's tests, at random but the same for a seed.
#pragma once
#include <cstdint>
#include <random>

#include "host/model/mapping_rule.hpp"
#include "host/ring/mapping.hpp"
#include "host/ring/schedule.hpp"

namespace raya {

class RandomSettings {
  public:
    explicit RandomSettings(std::uint64_t seed) : generator_(seed) {}

    std::uint32_t below(std::uint64_t end) { return static_cast<std::uint32_t>(generator_() % end); }
    std::uint32_t from(std::uint32_t least, std::uint32_t most) { return least + below(most - least + 1ull); }

    /// Most pixels cheap, some dear by any factor up to 2^`bits`; with `spot`, the dear ones together.
    CostImage costs(std::uint32_t width, std::uint32_t height, int bits, bool spot = true) {
        CostImage image{width, height, {}};
        for (std::uint32_t row = 0; row < height; ++row)
            for (std::uint32_t column = 0; column < width; ++column) {
                const bool dear = spot ? row > height / 3 && column > width / 2 : below(8) == 0;
                const std::uint64_t most = std::uint64_t{1} << (dear ? bits : bits / 2);
                image.cycles.push_back(generator_() % most);
            }
        return image;
    }

    /// Any static mapping of an image: small and large numbers of PEs, those that divide the width, seeds at the ends.
    raya_mapping mapping(std::uint32_t width, std::uint32_t height) {
        const std::uint32_t kind = below(7), pixels = width * height;
        const auto make = [&](const MappingRule& rule, std::uint32_t pes) {
            return make_mapping(rule, {width, height}, pes);
        };
        if (kind == 4) {
            const std::uint32_t a = from(1, height), b = from(1, std::min(width, pixels / a));
            return make(grid_mapping(a, b), a * b);
        }
        const std::uint32_t pes = some_pes(width, pixels);
        if (kind <= 2) return make(cyclic_mapping(below(width), below(2) ? Fold::kCyclic : Fold::kBlock), pes);
        if (kind == 3) return make(below(2) ? rows_mapping() : blocks_mapping(), pes);
        if (kind == 5) return make(tiles_mapping(divisor_of(width), divisor_of(height)), pes);
        const std::uint32_t seeds[] = {0, 1, 0xffffffffu, static_cast<std::uint32_t>(generator_())};
        return make(random_mapping(seeds[below(4)]), pes);
    }

  private:
    std::uint32_t divisor_of(std::uint32_t side) {
        std::uint32_t divisor = from(1, side);
        while (side % divisor != 0) --divisor;
        return divisor;
    }

    std::uint32_t some_pes(std::uint32_t width, std::uint32_t pixels) {
        switch (below(4)) {
            case 0:
                return divisor_of(width);
            case 1:
                return from(1, width);
            case 2:
                return from(1, std::min(pixels, 4 * width));
            default:
                return from(1, pixels);
        }
    }

    std::mt19937_64 generator_;
};

}  // namespace raya
