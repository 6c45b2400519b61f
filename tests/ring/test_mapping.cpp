// Slot mappings: every pixel has one owner, the formulas for owners and for PEs' pixels agree, and neighbouring pixels
// belong to the PEs that the paper states.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cstdint>
#include <vector>

#include "host/ring/mapping.hpp"
#include "tests/ring/mapping_checks.hpp"
#include "tests/ring/small_mapping.hpp"

using namespace raya;

namespace {

/// Returns the owner according to the definition in mapping.h, computed with signed numbers and without the shortcuts
/// of the kernels' formulas.
std::int64_t defined_owner(const raya_mapping& m, std::int64_t row, std::int64_t column) {
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

std::uint32_t ceil_ratio(std::uint32_t a, std::uint32_t b) { return (a + b - 1) / b; }

}  // namespace

TEST_CASE("slot mappings: every pixel has one owner, and shares are as even as the fold allows", "[mapping]") {
    constexpr std::uint64_t kSeed = 1;
    SplitMix random(kSeed);
    for (int i = 0; i < 600; ++i) {
        const raya_mapping m = small_mapping(random, 40);
        CAPTURE(kSeed, i, m.width, m.height, m.pes, m.parameter, m.kind);
        std::vector<std::uint32_t> sizes;
        const auto defined = [&](std::uint32_t row, std::uint32_t column) { return defined_owner(m, row, column); };
        CHECK(count_wrong_owners(m, defined, sizes) == 0);
        const auto [smallest, largest] = std::minmax_element(sizes.begin(), sizes.end());
        CHECK(largest_share(m) == *largest);
        if (m.pes <= m.width) {  // a PE owns W / P slots, rounded down or up
            CHECK(*smallest == m.width / m.pes * m.height);
            CHECK(*largest == ceil_ratio(m.width, m.pes) * m.height);
        } else {  // P / W PEs, rounded down or up, divide the H pixels of a slot
            CHECK(*smallest >= m.height / ceil_ratio(m.pes, m.width));
            CHECK(*largest == ceil_ratio(m.height, m.pes / m.width));
        }
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

TEST_CASE("block fold: if P < W, a PE owns a run of slots; if P > W, it owns a run of rows of one slot", "[mapping]") {
    const raya_mapping few_pes{10, 3, 4, 0, RAYA_FOLD_BLOCK};  // the owner of column c is floor(4 c / 10)
    std::vector<std::uint32_t> owners;
    for (std::uint32_t x = 0; x < 10; ++x) owners.push_back(raya_owner(few_pes, 2, x));
    CHECK(owners == std::vector<std::uint32_t>{0, 0, 0, 1, 1, 2, 2, 2, 3, 3});
    const raya_mapping many_pes{2, 5, 5, 0, RAYA_FOLD_BLOCK};  // PEs 0 and 1 own slot 0; PEs 2, 3 and 4 own slot 1
    owners.clear();
    for (std::uint32_t x = 0; x < 2; ++x)
        for (std::uint32_t j = 0; j < 5; ++j) owners.push_back(raya_owner(many_pes, j, x));
    CHECK(owners == std::vector<std::uint32_t>{0, 0, 0, 1, 1, 2, 2, 3, 3, 4});
}

TEST_CASE("slot mappings of the largest images and arrays agree with the definition", "[mapping]") {
    constexpr std::uint64_t kSeed = 3;
    constexpr std::uint32_t kSide = kMaxSide, kPixels = kSide * kSide;
    SplitMix random(kSeed);
    for (const std::uint32_t pes : {1u, 12'345u, kSide, kSide + 1, 1'000'003u, kPixels / 2 + 1, kPixels - 1, kPixels})
        for (const std::uint32_t offset : {0u, 1u, 128u, kSide - 1})
            for (const std::uint32_t fold : {RAYA_FOLD_CYCLIC, RAYA_FOLD_BLOCK}) {
                const raya_mapping m{kSide, kSide, pes, offset, fold};
                CAPTURE(kSeed, pes, offset, fold);
                std::uint32_t wrong = 0;
                for (int i = 0; i < 100; ++i) {
                    const std::uint32_t edge =
                        i < 4 ? kSide - 1 : random_below(random, kSide);  // cases 0 to 3: the last row or column
                    const raya_pixel pixel{i % 2 ? edge : random_below(random, kSide),
                                           i % 2 ? random_below(random, kSide) : edge};
                    const std::uint32_t owner = raya_owner(m, pixel.row, pixel.column);
                    wrong += defined_owner(m, pixel.row, pixel.column) != owner || !round_trip_holds(m, pixel);
                }
                CHECK(wrong == 0);
                if (pes > 2'000'000 || offset > 1) continue;
                std::uint64_t sum = 0;
                for (std::uint32_t pe = 0; pe < pes; ++pe) sum += raya_share_size(raya_share_of(m, pe));
                CHECK(sum == kPixels);
            }
}
