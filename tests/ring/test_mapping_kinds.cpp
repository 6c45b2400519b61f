// Mappings without slots: every pixel has one owner, as defined in mapping.h, and the PEs' pixel counts are as even as
// the kind of mapping guarantees. Also tests the permutation of the random mapping.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cstdint>
#include <numeric>
#include <vector>

#include "host/ring/mapping.hpp"
#include "tests/ring/mapping_checks.hpp"
#include "tests/ring/small_mapping.hpp"

using namespace raya;

namespace {

using Owners = std::vector<std::uint32_t>;  // [row][column]

constexpr std::uint32_t kKinds[] = {RAYA_ROWS, RAYA_BLOCKS, RAYA_GRID, RAYA_TILES, RAYA_RANDOM};

/// A set of pixels: every `step_across`-th pixel of every `step_down`-th row, in the rows [top, bottom) and the columns
/// [left, right). set_owner() assigns these pixels to `pe`.
struct PixelLattice {
    std::uint32_t top, step_down, bottom, left, step_across, right;
};
void set_owner(Owners& owners, const raya_mapping& m, const PixelLattice& pixels, std::uint32_t pe) {
    for (std::uint32_t j = pixels.top; j < pixels.bottom; j += pixels.step_down)
        for (std::uint32_t x = pixels.left; x < pixels.right; x += pixels.step_across) owners[j * m.width + x] = pe;
}

Owners owners_of_blocks(const raya_mapping& m) {
    Owners owners(m.width * m.height);
    for (std::uint32_t j = 0, pe = 0; j < m.height; ++j) {
        while ((pe + 1) * m.height <= j * m.pes) ++pe;  // the last PE whose first row is j or less
        set_owner(owners, m, {j, 1, j + 1, 0, 1, m.width}, pe);
    }
    return owners;
}

Owners owners_of_tiles(const raya_mapping& m) {
    const std::uint32_t w = raya_first_of(m.parameter), h = raya_second_of(m.parameter);
    Owners owners(m.width * m.height);
    std::uint32_t pe = 0;
    for (std::uint32_t top = 0; top < m.height; top += h)
        for (std::uint32_t left = 0; left < m.width; left += w) {
            set_owner(owners, m, {top, 1, top + h, left, 1, left + w}, pe);
            pe = pe + 1 < m.pes ? pe + 1 : 0;
        }
    return owners;
}

/// Assigns the permuted pixels to the PEs in turn. The permutation has separate tests.
Owners owners_of_random(const raya_mapping& m) {
    Owners owners(m.width * m.height);
    for (std::uint32_t n = 0; n < owners.size(); ++n)
        owners[raya_unscramble(n, m.width * m.height, m.parameter)] = n % m.pes;
    return owners;
}

/// Returns the owners according to the definition in mapping.h, computed PE by PE without the formulas of mapping.h.
Owners defined_owners(const raya_mapping& m) {
    if (m.kind == RAYA_BLOCKS) return owners_of_blocks(m);
    if (m.kind == RAYA_TILES) return owners_of_tiles(m);
    if (m.kind == RAYA_RANDOM) return owners_of_random(m);
    const std::uint32_t down = m.kind == RAYA_GRID ? raya_first_of(m.parameter) : m.pes;
    const std::uint32_t across = m.kind == RAYA_GRID ? raya_second_of(m.parameter) : 1;
    Owners owners(m.width * m.height);
    for (std::uint32_t a = 0; a < down; ++a)
        for (std::uint32_t b = 0; b < across; ++b)
            set_owner(owners, m, {a, down, m.height, b, across, m.width}, a * across + b);
    return owners;
}

/// Returns the owner, computed in 64-bit arithmetic, for images that are too large for defined_owners().
std::uint64_t wide_owner(const raya_mapping& m, std::uint64_t row, std::uint64_t column) {
    const std::uint64_t first = raya_first_of(m.parameter), second = raya_second_of(m.parameter), width = m.width;
    if (m.kind == RAYA_ROWS) return row % m.pes;
    if (m.kind == RAYA_BLOCKS) return row * m.pes / m.height;
    if (m.kind == RAYA_GRID) return row % first * second + column % second;
    if (m.kind == RAYA_TILES) return (row / second * (width / first) + column / first) % m.pes;
    return raya_scramble(static_cast<std::uint32_t>(row * width + column), m.width * m.height, m.parameter) % m.pes;
}

/// Returns the maximum difference between the pixel counts of two PEs, in pixels: one row, tile or pixel.
std::uint32_t max_size_difference(const raya_mapping& m) {
    if (m.kind == RAYA_RANDOM) return 1;
    if (m.kind == RAYA_TILES) return raya_first_of(m.parameter) * raya_second_of(m.parameter);
    return m.width;
}

}  // namespace

TEST_CASE("rows, blocks, grid, tiles, random: every pixel has one owner, and shares are even", "[mapping]") {
    constexpr std::uint64_t kSeed = 21;
    SplitMix random(kSeed);
    std::uint32_t idle_cases = 0;
    for (int i = 0; i < 300; ++i)
        for (const std::uint32_t kind : kKinds) {
            const raya_mapping m = mapping_of_kind(random, small_mapping(random, 30), kind);
            CAPTURE(kSeed, i, m.width, m.height, m.pes, mapping_text(m));
            const Owners owners = defined_owners(m);
            const auto defined = [&](std::uint32_t row, std::uint32_t column) {
                return owners[row * m.width + column];
            };
            std::vector<std::uint32_t> sizes;
            CHECK(count_wrong_owners(m, defined, sizes) == 0);
            const auto [smallest, largest] = std::minmax_element(sizes.begin(), sizes.end());
            CHECK(largest_share(m) == *largest);
            if (kind != RAYA_GRID) CHECK(*largest - *smallest <= max_size_difference(m));
            idle_cases += *smallest == 0;
        }
    CHECK(idle_cases > 100);  // number of mappings in which PEs have no pixels
}

TEST_CASE("a grid's PEs own one pixel of every A x B rectangle", "[mapping]") {
    for (const auto& [down, across] : {std::pair{16u, 16u}, {8u, 8u}, {3u, 5u}}) {
        const raya_mapping m = make_mapping(grid_mapping(down, across), {256, 256}, down * across);
        for (const auto& [top, left] : {std::pair{0u, 0u}, {7u, 100u}, {239u, 240u}}) {
            std::vector<int> pixels(m.pes, 0);
            for (std::uint32_t j = 0; j < down; ++j)
                for (std::uint32_t x = 0; x < across; ++x) ++pixels[raya_owner(m, top + j, left + x)];
            CAPTURE(down, across, top, left);
            CHECK(pixels == std::vector<int>(m.pes, 1));
        }
    }
}

TEST_CASE("mappings of every kind agree with the definition on the largest images and arrays", "[mapping]") {
    constexpr std::uint64_t kSeed = 22;
    constexpr std::uint32_t kSide = kMaxSide, kPixels = kSide * kSide;
    SplitMix random(kSeed);
    std::vector<raya_mapping> cases;
    for (const std::uint32_t pes : {1u, 12'345u, kSide, kSide + 1, 1'000'003u, kPixels - 1, kPixels}) {
        cases.push_back({kSide, kSide, pes, 0, RAYA_ROWS});
        cases.push_back({kSide, kSide, pes, 0, RAYA_BLOCKS});
        for (const std::uint32_t seed : {0u, 1u, 0xffffffffu}) cases.push_back({kSide, kSide, pes, seed, RAYA_RANDOM});
        for (const auto& [w, h] : {std::pair{1u, 1u}, {kSide, 1u}, {16u, 64u}, {kSide, kSide}})
            cases.push_back({kSide, kSide, pes, raya_pair(w, h), RAYA_TILES});
    }
    for (const auto& [a, b] : {std::pair{1u, 1u}, {kSide, kSide}, {1u, kSide}, {kSide, 1u}, {127u, 11'003u}})
        cases.push_back({kSide, kSide, a * b, raya_pair(a, b), RAYA_GRID});
    for (const raya_mapping& m : cases) {
        CAPTURE(kSeed, m.pes, mapping_text(m));
        std::uint32_t wrong = 0;
        for (int i = 0; i < 200; ++i) {
            const std::uint32_t edge =
                i < 4 ? kSide - 1 : random_below(random, kSide);  // cases 0 to 3: the last row or column
            const raya_pixel pixel{i % 2 ? edge : random_below(random, kSide),
                                   i % 2 ? random_below(random, kSide) : edge};
            const std::uint32_t owner = raya_owner(m, pixel.row, pixel.column);
            wrong += owner >= m.pes || owner != wide_owner(m, pixel.row, pixel.column) || !round_trip_holds(m, pixel);
        }
        CHECK(wrong == 0);
        if (m.pes > 2'000'000) continue;
        std::uint64_t sum = 0;
        for (std::uint32_t pe = 0; pe < m.pes; ++pe) sum += raya_share_size(raya_share_of(m, pe));
        CHECK(sum == kPixels);
    }
}

TEST_CASE("random mapping: the scramble is a bijection for every count, and unscramble inverts it", "[mapping]") {
    for (std::uint32_t count = 1; count <= 600; ++count)
        for (const std::uint32_t seed : {0u, 1u, 2u, 0x80000000u, 0xffffffffu}) {
            std::vector<bool> seen(count);
            std::uint32_t wrong = 0;
            for (std::uint32_t n = 0; n < count; ++n) {
                const std::uint32_t scrambled = raya_scramble(n, count, seed);
                wrong += scrambled >= count || seen[scrambled] || raya_unscramble(scrambled, count, seed) != n;
                if (scrambled < count) seen[scrambled] = true;
            }
            CAPTURE(count, seed);
            CHECK(wrong == 0);
        }
}

TEST_CASE("random mapping: the seed determines the mapping, and different seeds give independent mappings",
          "[mapping]") {
    const auto owners = [](std::uint32_t seed) { return defined_owners({64, 64, 16, seed, RAYA_RANDOM}); };
    constexpr std::uint32_t kSeeds = 50;
    std::vector<Owners> seed_owners;
    for (std::uint32_t seed = 0; seed < kSeeds; ++seed) seed_owners.push_back(owners(seed));
    std::uint32_t pairs = 0, uncorrelated = 0;
    for (std::uint32_t a = 0; a < kSeeds; ++a)
        for (std::uint32_t b = a + 1; b < kSeeds; ++b, ++pairs) {
            const std::uint32_t equal_owners =
                std::inner_product(seed_owners[a].begin(), seed_owners[a].end(), seed_owners[b].begin(), 0u,
                                   std::plus<>(), std::equal_to<>());
            uncorrelated += equal_owners > 176 && equal_owners < 336;  // 4096 / 16 +- 5 standard deviations of 15.5
        }
    CHECK(uncorrelated == pairs);
    // The recorded start of the mapping random:1, which must never change, because reports name mappings by their seed.
    const Owners first(seed_owners[1].begin(), seed_owners[1].begin() + 12);
    CHECK(first == Owners{12, 9, 15, 13, 2, 10, 13, 10, 14, 10, 14, 5});
}

TEST_CASE("random mapping: the owners of neighbouring pixels are independent", "[mapping]") {
    constexpr std::uint32_t kPes = 16;
    for (const std::uint32_t seed : {1u, 2u, 3u, 1000u})
        for (const std::uint32_t side : {64u, 100u, 256u}) {
            const raya_mapping m{side, side, kPes, seed, RAYA_RANDOM};
            for (const auto& [down, across] : {std::pair{0u, 1u}, {1u, 0u}, {1u, 1u}}) {
                std::vector<double> differences(kPes);
                for (std::uint32_t j = 0; j + down < side; ++j)
                    for (std::uint32_t x = 0; x + across < side; ++x)
                        ++differences[(raya_owner(m, j + down, x + across) + kPes - raya_owner(m, j, x)) % kPes];
                const double expected = std::accumulate(differences.begin(), differences.end(), 0.0) / kPes;
                double chi_square = 0;
                for (const double d : differences) chi_square += (d - expected) * (d - expected) / expected;
                CAPTURE(seed, side, down, across);
                CHECK(chi_square < 45);  // 15 degrees of freedom: p = 0.0001
            }
        }
}
