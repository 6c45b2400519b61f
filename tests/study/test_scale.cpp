// Mappings on 16 PEs to one for each pixel: against plain sums and bounds, and what the page concludes.
#include <fmt/format.h>

#include <cmath>

#include "host/study/laboratory.hpp"
#include "host/study/page_writer.hpp"
#include "host/study/scale.hpp"
#include "host/study/studies.hpp"
#include "tests/study/study_cases.hpp"

namespace raya {
namespace {

std::uint32_t rounded(double value, std::uint32_t side) { return static_cast<std::uint32_t>(value + 0.5) % side; }

// Sides and P are powers of two here, which makes the folds plain.
double cyclic_efficiency(const CostImage& image, std::uint32_t pes, std::uint32_t p, bool block) {
    const std::uint32_t w = image.width;
    return plain_load(image, pes,
                      [&](std::uint32_t row, std::uint32_t column) {
                          const std::uint32_t slot = sheared(row, column, p, w);
                          if (pes <= w) return block ? slot / (w / pes) : slot % pes;
                          const std::uint32_t sharers = pes / w;
                          return block ? slot * sharers + row / (image.height / sharers) : slot + w * (row % sharers);
                      })
        .efficiency();
}

double grid_efficiency(const CostImage& image, std::uint32_t pes) {
    const auto a = static_cast<std::uint32_t>(std::sqrt(pes)),
               rows = a * a == pes ? a : pes / rounded(std::sqrt(2 * pes), ~0u);
    const std::uint32_t across = pes / rows;
    REQUIRE((across == rows || across == 2 * rows));
    return plain_load(image, pes,
                      [&](std::uint32_t row, std::uint32_t column) { return row % rows * across + column % across; })
        .efficiency();
}

double bound_of(const CostImage& image, std::uint32_t pes) {
    std::uint64_t sum = 0, largest = 0;
    for (const std::uint64_t cost : image.cycles) {
        sum += cost;
        largest = std::max(largest, cost);
    }
    return static_cast<double>(sum) / static_cast<double>(std::max(largest, (sum + pes - 1) / pes)) / pes;
}

// Columns of the table: P, bound, the ways without the block fold, then with it.
void check_row(const CostImage& image, const std::vector<Cell>& row) {
    const auto pes = static_cast<std::uint32_t>(number(row[0]));
    const std::uint32_t w = image.width;
    const double root = std::sqrt(pes);
    const std::uint32_t offsets[] = {16 % w, rounded(root, w), rounded(pes > w ? w / root : root, w), 0};
    CAPTURE(pes);
    const double bound = number(row[1]);
    CHECK(bound == bound_of(image, pes));
    for (std::size_t n = 0; n < 4; ++n) {
        CAPTURE(n);
        CHECK(number(row[2 + n]) == cyclic_efficiency(image, pes, offsets[n], false));
        CHECK(number(row[8 + n]) == cyclic_efficiency(image, pes, offsets[n], true));
    }
    CHECK(number(row[6]) == grid_efficiency(image, pes));
    for (std::size_t n = 2; n < row.size(); ++n) CHECK(number(row[n]) <= bound);
}

// For how many P between the side and the pixels a column of the table has 90 % or more of 2-D's.
std::string kept_text(const StudyTable& table, std::size_t column, std::uint32_t side) {
    int kept = 0;
    for (const auto& row : table.rows)
        kept += number(row[0]) > side && number(row[0]) < side * side && number(row[column]) >= 0.9 * number(row[6]);
    return fmt::format("{}: {}", table.columns[column], kept);
}

TEST_CASE("scale's efficiencies are those of plain sums and below the bound", "[study]") {
    constexpr unsigned kSeed = 41;
    std::mt19937 random(kSeed);
    for (int i = 0; i < 100; ++i) {
        const std::uint32_t side = i % 4 ? 16 : 32;
        CAPTURE(kSeed, i, side);
        const CostImage image = random_costs(random, side);
        const StudyPage page = scale_page("random", image);
        check_page(page);
        const StudyTable& table = table_named(page, "scale");
        REQUIRE(table.rows.size() == (side == 16 ? 5 : 7));  // 2^4 .. 2^8 or 2^10
        for (const auto& row : table.rows) check_row(image, row);
        CHECK(says(page, fmt::format("({}; {}; {}; {}; {})", kept_text(table, 2, side), kept_text(table, 3, side),
                                     kept_text(table, 4, side), kept_text(table, 5, side), kept_text(table, 7, side))));
        for (std::size_t n = 2; n < 12; ++n) CHECK(number(table.rows.back()[n]) == number(table.rows.back()[1]));
        CHECK(table.columns[7] == "random");
    }
}

TEST_CASE("scale takes sides that are no powers of two", "[study]") {
    std::mt19937 random(42);
    for (const std::uint32_t side : {17u, 20u, 31u, 48u}) {
        CAPTURE(side);
        const CostImage image = random_costs(random, side);
        const StudyPage page = scale_page("random", image);
        check_page(page);
        const StudyTable& table = table_named(page, "scale");
        CHECK(number(table.rows.back()[0]) * 2 > side * side);
        for (const auto& row : table.rows)
            for (std::size_t n = 2; n < row.size(); ++n) CHECK(number(row[n]) <= number(row[1]));
    }
}

TEST_CASE("scale tells where half is lost and what one dear pixel allows", "[study]") {
    CostImage image = even_costs(16);
    image.cycles[37] = 257;  // sum 512: a speed-up of 512 / 257 at most
    const StudyPage page = scale_page("dear", image);
    CHECK(says(page, "p = 16: none; "));
    CHECK(says(page, "however given out: 0."));
    CHECK(page.comparisons.back().ours == 512.0 / 257);
    const StudyPage even = scale_page("even", even_costs(16));
    CHECK(says(even, "p = 16: 256; "));
    CHECK(says(even, "no distribution of whole pixels gains more than 256 times"));
    CHECK(number(table_named(even, "scale-half").rows[1][1]) == 256);
    CHECK(number(table_named(even, "scale-half").rows[1][2]) == 256);
    CHECK(number(table_named(page, "scale-half").rows[1][2]) == 0);
}

TEST_CASE("scale concludes on 2-D from what keeps up with it", "[study]") {
    CHECK(need_of_2d("p", {32, 64}, 2) ==
          "So it does not take 2-D, but it takes \"the like\": p, its rows shared, is enough.");
    CHECK(need_of_2d("p", {64}, 2) == "So it does not always take 2-D: p does for P = 64.");
    CHECK(need_of_2d("p", {}, 2) == "So it does take 2-D, as the paper says.");
    CHECK(says(scale_page("even", even_costs(16)), "of 3 such arrays 2-D is kept up with on (p = 16: 3; "));
}

TEST_CASE("where an offset cancels out the loads are the column split's", "[study]") {
    std::mt19937 random(43);
    for (int i = 0; i < 50; ++i) {
        const StudyPage page = scale_page("random", random_costs(random, 64));
        // p = 16: 16 P / 64 is a multiple of 64 from P = 256 on. sqrt(P): 256 / 64 * 16, 1024 / 64 * 32, 2048 / 64 * 45
        // is none. W / sqrt(P) = 2 for P = 1024 and 1.4 for 2048: 32 * 1 is none.
        CHECK(says(page, "So it is with p = 16 for P = 256, 512, 1024, 2048; p = sqrt(P) for P = 256, 1024."));
        const StudyTable& table = table_named(page, "scale");
        for (const auto& row : table.rows) {
            const double pes = number(row[0]);
            if (pes >= 256) CHECK(number(row[2]) == number(row[5]));
            if (pes == 256 || pes == 1024) CHECK(number(row[3]) == number(row[5]));
        }
    }
    CHECK(says(scale_page("even", even_costs(17)), "No offset here falls back"));
}

TEST_CASE("study scale takes the costs of the scene that is named", "[study]") {
    Session session(choose_device(""));
    Laboratory lab(session, 32);
    const LabelledScene glass = embedded_scene("glass");
    CHECK(page_json(study_scale(lab, {glass})) == page_json(scale_page("glass", lab.costs(glass, 32).trace)));
    CHECK(study_scale(lab, {}).settings["scene"] == "centre");
}

}  // namespace
}  // namespace raya
