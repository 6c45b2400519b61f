// Mappings on 16 PEs to one for each pixel: against plain sums and bounds, and what the page concludes.
#include <fmt/core.h>

#include <cmath>

#include "host/study/laboratory.hpp"
#include "host/study/page_writer.hpp"
#include "host/study/studies.hpp"
#include "tests/document.hpp"
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

const char* const kWays[] = {"p = 16", "p = sqrt(P)", "p = sqrt(P) or W / sqrt(P)", "column split"};

void check_bounded(const StudyTable& table, std::size_t row) {
    const double bound = table.at(row, "upper bound").number();
    for (std::size_t n = 2; n < table.columns.size(); ++n) CHECK(table.rows[row][n].number() <= bound);
}

void check_row(const CostImage& image, const StudyTable& table, std::size_t row) {
    const auto at = [&](const std::string& label) { return table.at(row, label).number(); };
    const auto pes = static_cast<std::uint32_t>(at("P"));
    const std::uint32_t w = image.width;
    const double root = std::sqrt(pes);
    const std::uint32_t offsets[] = {16 % w, rounded(root, w), rounded(pes > w ? w / root : root, w), 0};
    CAPTURE(pes);
    CHECK(at("upper bound") == bound_of(image, pes));
    for (std::size_t n = 0; n < 4; ++n) {
        CAPTURE(n);
        CHECK(at(kWays[n]) == cyclic_efficiency(image, pes, offsets[n], false));
        CHECK(at(std::string(kWays[n]) + ", block fold") == cyclic_efficiency(image, pes, offsets[n], true));
    }
    CHECK(at("2-D, A x B PEs") == grid_efficiency(image, pes));
    check_bounded(table, row);
}

// For how many P between the side and the pixels a column of the table has 90 % or more of 2-D's.
std::string kept_text(const StudyTable& table, const std::string& label, std::uint32_t side) {
    int kept = 0;
    for (std::size_t row = 0; row < table.rows.size(); ++row) {
        const double pes = table.at(row, "P").number();
        kept += pes > side && pes < side * side &&
                table.at(row, label).number() >= 0.9 * table.at(row, "2-D, A x B PEs").number();
    }
    return fmt::format("{}: {}", label, kept);
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
        const StudyTable& table = page.table("scale");
        REQUIRE(table.rows.size() == (side == 16 ? 5 : 7));  // 2^4 .. 2^8 or 2^10
        for (std::size_t row = 0; row < table.rows.size(); ++row) check_row(image, table, row);
        std::string kept;
        for (const char* label : {kWays[0], kWays[1], kWays[2], kWays[3], "random"})
            kept += (kept.empty() ? "(" : "; ") + kept_text(table, label, side);
        CHECK(says(page, kept + ")"));
        for (std::size_t n = 2; n < 12; ++n) CHECK(table.rows.back()[n] == table.rows.back()[1]);
    }
}

TEST_CASE("scale takes sides that are no powers of two", "[study]") {
    std::mt19937 random(42);
    for (const std::uint32_t side : {17u, 20u, 31u, 48u}) {
        CAPTURE(side);
        const CostImage image = random_costs(random, side);
        const StudyPage page = scale_page("random", image);
        check_page(page);
        const StudyTable& table = page.table("scale");
        CHECK(table.at(table.rows.size() - 1, "P").number() * 2 > side * side);
        for (std::size_t row = 0; row < table.rows.size(); ++row) check_bounded(table, row);
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
    CHECK(even.value("scale-half", 1, "50 % or more up to P") == 256);
    CHECK(even.value("scale-half", 1, "speed-up there") == 256);
    CHECK(page.value("scale-half", 1, "speed-up there") == 0);
}

TEST_CASE("scale concludes on 2-D from what keeps up with it", "[study]") {
    CHECK(need_of_2d("p", {32, 64}, 2) ==
          "So it does not take 2-D, but it takes \"the like\": p, its rows shared, is enough.");
    CHECK(need_of_2d("p", {64}, 2) == "So it does not always take 2-D: p does for P = 64.");
    CHECK(need_of_2d("p", {}, 2) == "So it does take 2-D, as Kohata & Ito say.");
    CHECK(says(scale_page("even", even_costs(16)), "of 3 such arrays 2-D is kept up with on (p = 16: 3; "));
}

TEST_CASE("where an offset cancels out the loads are the column split's", "[study]") {
    std::mt19937 random(43);
    for (int i = 0; i < 50; ++i) {
        const StudyPage page = scale_page("random", random_costs(random, 64));
        // p = 16: 16 P / 64 is a multiple of 64 from P = 256 on. sqrt(P): 256 / 64 * 16, 1024 / 64 * 32, 2048 / 64 * 45
        // is none. W / sqrt(P) = 2 for P = 1024 and 1.4 for 2048: 32 * 1 is none.
        CHECK(says(page, "So it is with p = 16 for P = 256, 512, 1024, 2048; p = sqrt(P) for P = 256, 1024."));
        const StudyTable& table = page.table("scale");
        for (std::size_t row = 0; row < table.rows.size(); ++row) {
            const double pes = table.at(row, "P").number();
            if (pes >= 256) CHECK(table.at(row, "p = 16") == table.at(row, "column split"));
            if (pes == 256 || pes == 1024) CHECK(table.at(row, "p = sqrt(P)") == table.at(row, "column split"));
        }
    }
    CHECK(says(scale_page("even", even_costs(17)), "No offset here falls back"));
}

TEST_CASE("whether 2-D is needed is judged over many pictures", "[study]") {
    const CostImage even = even_costs(16);
    CHECK(scale_page("even", even).claims.empty());
    const StudyPage page = scale_page("even", even, {&even, &even, &even});
    check_page(page);
    CHECK(page.claims.at(0).verdict == ClaimVerdict::kNotReproduced);  // every mapping is as good
    CostImage columns = even;  // a dear column: its PEs have all of it, whatever the turns, while a grid spreads it
    for (std::uint32_t row = 0; row < 16; ++row)
        for (const std::uint32_t column : {0u, 1u, 2u, 3u}) columns.cycles[row * 16 + column] = 1000;
    const StudyPage other = scale_page("columns", columns, {&columns, &columns, &columns});
    CHECK(other.table("scale-views").rows.size() == 5);
    for (std::size_t row = 0; row < 5; ++row)
        CHECK(other.value("scale-views", row, "p = 16") == Approx(other.value("scale", row, "p = 16")));
}

TEST_CASE("study scale takes the costs of the scene that is named", "[study]") {
    Session session(choose_device(""));
    Laboratory lab(session, 32);
    const LabelledScene glass = embedded_scene("glass");
    const Ensemble ensemble = ensemble_of(lab, glass, 32, AntialiasMethod::kNone, 8);
    std::vector<const CostImage*> views;
    for (const Costs* costs : ensemble.views) views.push_back(&costs->trace);
    CHECK(views.size() == 8);
    CHECK(page_json(study_scale(lab, {glass})).dump() ==
          page_json(scale_page("glass", lab.costs(glass, 32).trace, views)).dump());
    CHECK(read_back(study_scale(lab, {}).settings)["scene"] == "centre");
}

}  // namespace
}  // namespace raya
