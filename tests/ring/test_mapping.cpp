// Mappings: every pixel has one owner, that of the definition; the formulas for owners and for PEs' pixels agree; and
// neighbouring pixels belong to the PEs that the paper states.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cstdint>
#include <vector>

#include "host/ring/mapping.hpp"
#include "kernels/shared/share_pixels.h"
#include "tests/ring/small_mapping.hpp"

using namespace raya;

namespace {

/// Returns the owner of a pixel of a slot mapping according to the definition in mapping.h, without the shortcuts of
/// the kernels' formulas.
std::int64_t owner_of_slot(const raya_mapping& m, std::int64_t row, std::int64_t column) {
    const std::int64_t width = m.width, height = m.height, pes = m.pes;
    std::int64_t slot = (column - row * m.parameter) % width;
    if (slot < 0) slot += width;
    if (m.kind == RAYA_FOLD_CYCLIC) {
        if (pes <= width) return slot % pes;
        std::int64_t slot_pes = 0;  // number of PEs of the slot: slot, slot + W, slot + 2 W, ...
        while (slot + slot_pes * width < pes && slot_pes < height) ++slot_pes;
        return slot + row % slot_pes * width;
    }
    const std::int64_t first = slot * pes / width, end = (slot + 1) * pes / width;
    return pes <= width ? first : first + row * (end - first) / height;
}

/// Returns the owner of a pixel according to the definition in mapping.h, in 64-bit arithmetic. Tests of the random
/// mapping's permutation are separate.
std::int64_t defined_owner(const raya_mapping& m, std::int64_t row, std::int64_t column) {
    const std::int64_t first = raya_first_of(m.parameter), second = raya_second_of(m.parameter), width = m.width;
    if (m.kind == RAYA_ROWS) return row % m.pes;
    if (m.kind == RAYA_BLOCKS) return row * m.pes / m.height;
    if (m.kind == RAYA_GRID) return row % first * second + column % second;
    if (m.kind == RAYA_TILES) return (row / second * (width / first) + column / first) % m.pes;
    if (m.kind == RAYA_RANDOM)
        return raya_scramble(static_cast<std::uint32_t>(row * width + column), m.width * m.height, m.parameter) % m.pes;
    return owner_of_slot(m, row, column);
}

/// Returns the number of wrong pixels of a mapping. A pixel in a share's list is wrong if it lies outside the image or
/// was listed before, or if raya_owner, defined_owner(), raya_index_of or raya_pixel_run_at contradicts the list.
/// raya_pixel_run_at is not called for one of seven pixels, so it must skip pixels. A pixel of the image is wrong if no
/// share lists it. Appends the size of each share to `sizes`.
std::uint32_t count_wrong_owners(const raya_mapping& m, std::vector<std::uint32_t>& sizes) {
    std::vector<bool> seen(std::size_t{m.width} * m.height);
    std::uint32_t wrong = 0;
    for (std::uint32_t pe = 0; pe < m.pes; ++pe) {
        const raya_share share = raya_share_of(m, pe);
        sizes.push_back(raya_share_size(share));
        if (sizes.back() > seen.size()) return ~0u;  // the size overflowed
        raya_pixel_run run{};
        for (std::uint32_t k = 0; k < sizes.back(); ++k) {
            const raya_pixel pixel = raya_pixel_of(m, share, k);
            if (k % 7 != 3) run = k == 0 ? raya_pixel_run_of(m, share, k) : raya_pixel_run_at(run, m, share, k);
            const bool run_matches = k % 7 == 3 || (run.pixel.row == pixel.row && run.pixel.column == pixel.column);
            const bool inside = pixel.row < m.height && pixel.column < m.width;
            const std::size_t image_index = std::size_t{pixel.row} * m.width + pixel.column;
            const bool good = inside && run_matches && !seen[image_index] &&
                              raya_owner(m, pixel.row, pixel.column) == pe &&
                              defined_owner(m, pixel.row, pixel.column) == pe && raya_index_of(m, share, pixel) == k;
            if (inside) seen[image_index] = true;
            wrong += !good;
        }
    }
    return wrong + static_cast<std::uint32_t>(std::count(seen.begin(), seen.end(), false));
}

/// Returns true if the pixel's owner is that of the definition and lists the pixel at the index of raya_index_of.
bool owner_lists(const raya_mapping& m, const raya_pixel& pixel) {
    const std::uint32_t owner = raya_owner(m, pixel.row, pixel.column);
    const raya_share share = raya_share_of(m, owner);
    const std::uint32_t k = raya_index_of(m, share, pixel);
    if (owner != defined_owner(m, pixel.row, pixel.column) || k >= raya_share_size(share)) return false;
    const raya_pixel listed_pixel = raya_pixel_of(m, share, k);
    return listed_pixel.row == pixel.row && listed_pixel.column == pixel.column;
}

std::uint32_t ceil_ratio(std::uint32_t a, std::uint32_t b) { return (a + b - 1) / b; }

/// Checks that the shares are as even as the kind of mapping guarantees.
void check_sizes(const raya_mapping& m, std::uint32_t smallest, std::uint32_t largest) {
    if (m.kind == RAYA_RANDOM) CHECK(largest - smallest <= 1);
    if (m.kind == RAYA_TILES) CHECK(largest - smallest <= raya_first_of(m.parameter) * raya_second_of(m.parameter));
    if (m.kind == RAYA_ROWS || m.kind == RAYA_BLOCKS) CHECK(largest - smallest <= m.width);
    if (!raya_has_slots(m)) return;
    if (m.pes <= m.width) {  // a PE owns W / P slots, rounded down or up
        CHECK(smallest == m.width / m.pes * m.height);
        CHECK(largest == ceil_ratio(m.width, m.pes) * m.height);
    } else {  // P / W PEs, rounded down or up, divide the H pixels of a slot
        CHECK(smallest >= m.height / ceil_ratio(m.pes, m.width));
        CHECK(largest == ceil_ratio(m.height, m.pes / m.width));
    }
}

}  // namespace

TEST_CASE("every pixel has one owner, and shares are as even as the kind of mapping allows", "[mapping]") {
    constexpr std::uint64_t kSeed = 1;
    SplitMix random(kSeed);
    for (int i = 0; i < 1500; ++i) {
        const raya_mapping m = any_mapping(random, 40);
        CAPTURE(kSeed, i, m.width, m.height, m.pes, mapping_text(m), m.kind);
        std::vector<std::uint32_t> sizes;
        CHECK(count_wrong_owners(m, sizes) == 0);
        const auto [smallest, largest] = std::minmax_element(sizes.begin(), sizes.end());
        CHECK(largest_share(m) == *largest);
        check_sizes(m, *smallest, *largest);
    }
}

TEST_CASE("mappings of the largest images and arrays agree with the definition", "[mapping]") {
    constexpr std::uint64_t kSeed = 3;
    constexpr std::uint32_t kSide = kMaxSide, kPixels = kSide * kSide;
    SplitMix random(kSeed);
    std::vector<raya_mapping> cases;
    for (const std::uint32_t pes : {1u, 12'345u, kSide, kSide + 1, 1'000'003u, kPixels - 1, kPixels}) {
        for (const std::uint32_t offset : {0u, 1u, 128u, kSide - 1})
            for (const std::uint32_t fold : {RAYA_FOLD_CYCLIC, RAYA_FOLD_BLOCK})
                cases.push_back({kSide, kSide, pes, offset, fold});
        cases.push_back({kSide, kSide, pes, 0, RAYA_ROWS});
        cases.push_back({kSide, kSide, pes, 0, RAYA_BLOCKS});
        cases.push_back({kSide, kSide, pes, 0xffffffffu, RAYA_RANDOM});
        for (const auto& [w, h] : {std::pair{1u, 1u}, {kSide, 1u}, {16u, 64u}, {kSide, kSide}})
            cases.push_back({kSide, kSide, pes, raya_pair(w, h), RAYA_TILES});
    }
    for (const auto& [a, b] : {std::pair{1u, 1u}, {kSide, kSide}, {1u, kSide}, {kSide, 1u}, {127u, 11'003u}})
        cases.push_back({kSide, kSide, a * b, raya_pair(a, b), RAYA_GRID});
    for (const raya_mapping& m : cases) {
        CAPTURE(kSeed, m.pes, mapping_text(m), m.kind);
        std::uint32_t wrong = 0;
        for (int i = 0; i < 100; ++i) {
            const std::uint32_t edge =
                i < 4 ? kSide - 1 : random_below(random, kSide);  // cases 0 to 3: the last row or column
            const raya_pixel pixel{i % 2 ? edge : random_below(random, kSide),
                                   i % 2 ? random_below(random, kSide) : edge};
            wrong += !owner_lists(m, pixel);
        }
        CHECK(wrong == 0);
        if (m.pes > 100'000) continue;
        std::uint64_t sum = 0;
        for (std::uint32_t pe = 0; pe < m.pes; ++pe) sum += raya_share_size(raya_share_of(m, pe));
        CHECK(sum == kPixels);
    }
}

TEST_CASE("cyclic mapping with one PE per column: owners and neighbours are those in the paper", "[mapping]") {
    constexpr std::uint64_t kSeed = 2;
    SplitMix random(kSeed);
    for (int i = 0; i < 100; ++i) {
        raya_mapping m = small_mapping(random, 40);
        if (i == 0) m = {256, 256, 256, 16, RAYA_FOLD_CYCLIC};
        m.pes = m.width;
        const std::uint32_t w = m.width, p = m.parameter;
        CAPTURE(kSeed, i, w, m.height, p, m.kind);
        std::uint32_t wrong = 0;
        for (std::uint32_t j = 0; j < m.height; ++j)
            for (std::uint32_t pe = 0; pe < w; ++pe) {
                const std::uint32_t x = (j * p + pe) % w;  // PE i owns the pixels (j, (j p + i) mod W)
                wrong += raya_owner(m, j, x) != pe;
                wrong += x > 0 && raya_owner(m, j, x - 1) != (pe + w - 1) % w;
                wrong += x + 1 < w && raya_owner(m, j, x + 1) != (pe + 1) % w;
                wrong += j > 0 && raya_owner(m, j - 1, x) != (pe + p) % w;
                wrong += j + 1 < m.height && raya_owner(m, j + 1, x) != (pe + w - p) % w;
            }
        CHECK(wrong == 0);
    }
}

TEST_CASE("cyclic mapping with p = n and P = n x n: every n x n block has one pixel of each PE", "[mapping]") {
    const raya_mapping m{256, 256, 256, 16, RAYA_FOLD_CYCLIC};
    for (const std::uint32_t top : {0u, 7u, 240u})
        for (const std::uint32_t left : {0u, 100u, 240u}) {
            std::vector<int> pixels(m.pes, 0);
            for (std::uint32_t j = 0; j < 16; ++j)
                for (std::uint32_t x = 0; x < 16; ++x) ++pixels[raya_owner(m, top + j, left + x)];
            CAPTURE(top, left);
            CHECK(pixels == std::vector<int>(m.pes, 1));
        }
}

TEST_CASE("random mapping: the scramble is a bijection for every count, and unscramble inverts it", "[mapping]") {
    for (std::uint32_t count = 1; count <= 600; ++count)
        for (const std::uint32_t seed : {0u, 1u, 0xffffffffu}) {
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

// The recorded start of the mapping random:1 must never change, because reports name mappings by their seed.
TEST_CASE("random mapping: the start of random:1 is the recorded one", "[mapping]") {
    std::vector<std::uint32_t> owners;
    for (std::uint32_t x = 0; x < 12; ++x) owners.push_back(raya_owner({64, 64, 16, 1, RAYA_RANDOM}, 0, x));
    CHECK(owners == std::vector<std::uint32_t>{12, 9, 15, 13, 2, 10, 13, 10, 14, 10, 14, 5});
}
