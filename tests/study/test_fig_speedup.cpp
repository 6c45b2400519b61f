// Fig. 9: every figure against plain sums, and what the page says of each kind of image.
#include <cmath>

#include "host/study/page_writer.hpp"
#include "host/study/studies.hpp"
#include "tests/document.hpp"
#include "tests/study/study_cases.hpp"

namespace raya {
namespace {

PlainLoad cyclic_load(const CostImage& image, std::uint32_t pes, std::uint32_t p, bool block) {
    return plain_load(image, pes, [&](std::uint32_t row, std::uint32_t column) {
        const std::uint32_t slot = sheared(row, column, p, image.width);
        return block ? slot * pes / image.width : slot % pes;
    });
}

PlainLoad square_load(const CostImage& image, std::uint32_t a) {
    return plain_load(image, a * a, [&](std::uint32_t row, std::uint32_t column) { return row % a * a + column % a; });
}

void check_row(const CostImage& image, const StudyPage& page, std::size_t row) {
    const auto pes = static_cast<std::uint32_t>(page.value("fig9", row, "P"));
    const auto root = static_cast<std::uint32_t>(std::floor(std::sqrt(pes) + 0.5));
    const std::pair<const char*, std::uint32_t> offsets[] = {
        {"p = 0", 0}, {"p = 16", 16 % image.width}, {"p = round(sqrt(P))", root}};
    for (const auto& [label, p] : offsets)
        for (const bool block : {false, true}) {
            CAPTURE(pes, p, block);
            CHECK(page.value("fig9", row, std::string(label) + (block ? ", block fold" : ", cyclic fold")) ==
                  cyclic_load(image, pes, p, block).speedup());
        }
}

TEST_CASE("fig9's speed-ups are sum / largest for every P, offset and fold", "[study]") {
    constexpr unsigned kSeed = 91;
    std::mt19937 random(kSeed);
    for (int i = 0; i < 100; ++i) {
        const auto side = static_cast<std::uint32_t>(16 + random() % 18);
        CAPTURE(kSeed, i, side);
        const CostImage image = random_costs(random, side);
        const StudyPage page = speedup_page("random", image);
        check_page(page);
        REQUIRE(page.table("fig9").rows.size() == side);
        for (std::size_t row = 0; row < side; ++row) check_row(image, page, row);
        const StudyTable& squares = page.table("fig9-squares");
        std::uint32_t seen = 1;
        for (std::size_t n = 0; n < squares.rows.size(); ++n) {
            const auto pes = static_cast<std::uint32_t>(squares.at(n, "P").number());
            if (pes != (seen + 1) * (seen + 1)) {
                CHECK((pes & (pes - 1)) == 0);  // a power of two
                CHECK(squares.at(n, "A x A, 2-D") == Cell("-"));
                continue;
            }
            ++seen;
            CHECK(squares.at(n, "A x A, 2-D") == Cell(square_load(image, seen).speedup()));
        }
        CHECK(seen == static_cast<std::uint32_t>(std::sqrt(side)));
        for (const Comparison& c : page.comparisons) CHECK_FALSE(c.paper);
    }
}

// An even image of the paper's size, but for one pixel.
CostImage one_dear(std::uint64_t cost) {
    CostImage image = even_costs(256);
    image.cycles[1000] = cost;
    return image;
}

TEST_CASE("fig9 says how ours lies to the paper's 229 times", "[study]") {
    const StudyPage even = speedup_page("centre", even_costs(256));
    CHECK(says(even, "more than the 229 of Kohata & Ito's abstract"));
    CHECK(says(speedup_page("centre", one_dear(31)), "within 2 % of the 229"));
    CHECK(says(speedup_page("centre", one_dear(100)), "less than the 229"));
    CHECK(even.comparisons[0].paper == 229.0);
    CHECK(even.comparison("speed-up on 256 PEs, p = 0").source == Source::kDerived);
    CHECK(even.comparison("CAP's mapping, 16 x 16 PEs over 8 x 8").ours == 4);
    CHECK(even.comparison("Pixel Machine's mapping, 8 x 8 PEs").ours == 64);
    CHECK(even.claims.empty());  // of one picture nothing can be told

    const CostImage same = even_costs(256), other = one_dear(100);
    const auto verdicts = [&](const std::vector<const CostImage*>& views) {
        std::vector<ClaimVerdict> all;
        for (const Claim& claim : speedup_page("centre", same, views).claims) all.push_back(claim.verdict);
        return all;
    };
    using enum ClaimVerdict;
    // 229, 99.2, p = 16 above p = 0 (they are equal), 3.86, 60 or more.
    CHECK(verdicts({&same, &other}) == std::vector{kReproduced, kCannotTell, kNotReproduced, kReproduced,
                                                   kCannotTell});  // 60 is within the interval
    CHECK(verdicts({&same, &same}) == std::vector{kCannotTell, kCannotTell, kNotReproduced, kCannotTell, kReproduced});
    CHECK(verdicts({kPredictable - 1, &other}) ==
          std::vector{kCannotTell, kCannotTell, kNotReproduced, kCannotTell, kNotReproduced});
    CHECK(verdicts({kPredictable, &other}) == std::vector(5, kNotReproduced));
    CostImage hump = same;  // eight columns that are dear
    for (std::size_t pixel = 0; pixel < hump.cycles.size(); ++pixel) hump.cycles[pixel] = pixel % 256 < 8 ? 10 : 1;
    CHECK(verdicts({&hump, &hump})[2] == kReproduced);
    CHECK(speedup_page("mine.nff", same, {&same, &other}).claims.empty());
}

TEST_CASE("beside a scene of one's own, or another size, stand no figures of the paper", "[study]") {
    for (const StudyPage& page :
         {speedup_page("folder/centre.nff", even_costs(256)), speedup_page("centre", even_costs(64))}) {
        for (const Comparison& comparison : page.comparisons) CHECK_FALSE(comparison.paper);
        for (const StudyPlot& plot : page.plots)
            for (const PlotSeries& series : plot.series) CHECK(series.style != PlotStyle::kPaper);
        CHECK_FALSE(says(page, "the 229 of"));
    }
}

TEST_CASE("fig9 sees the stairs of whole columns", "[study]") {
    CHECK(says(speedup_page("even", even_costs(16)),
               "with 9 to 15 PEs some PE still has two of the 16, and p = 16 gains nothing over 8 PEs; on 9 PEs it "
               "gives 8.0 times, 3 x 3 PEs in two dimensions 7.1 times."));  // 256 pixels / 36 of PE (0, 0)
    CostImage two = even_costs(16);  // columns 0 and 8 dear: 8 PEs give both to one, 9 do not
    for (std::uint32_t row = 0; row < 16; ++row) two.cycles[row * 16] = two.cycles[row * 16 + 8] = 1'000'000;
    CHECK(says(speedup_page("two", two), "p = 16 gains at most 100.0 % over 8 PEs"));
}

TEST_CASE("fig9 says where p = 16 is no shift, and which fold is better", "[study]") {
    std::mt19937 random(92);
    CHECK(says(speedup_page("random", random_costs(random, 32)),
               "p = 16 gives the same as the column split for P = 2, 4, 8, 16."));
    CostImage middle = even_costs(16);  // block gives all that is dear to few PEs
    for (std::uint32_t row = 0; row < 16; ++row)
        for (std::uint32_t column = 6; column < 10; ++column) middle.cycles[row * 16 + column] = 1000;
    CHECK(says(speedup_page("middle", middle), "the better fold is the cyclic fold for the column split"));
    CostImage ends = even_costs(16);  // every second column: the cyclic fold gives all of it to one of two PEs
    for (std::uint32_t i = 0; i < 256; i += 2) ends.cycles[i] = 1000;
    CHECK(says(speedup_page("ends", ends), "the better fold is the block fold for the column split"));
    CHECK(says(speedup_page("even", even_costs(16)), "the better fold is none for the column split"));
}

TEST_CASE("fig9's means are those of the views, its sizes plain sums", "[study]") {
    std::mt19937 random(93);
    for (int i = 0; i < 50; ++i) {
        const CostImage own = random_costs(random, 20), a = random_costs(random, 20), b = random_costs(random, 20),
                        large = random_costs(random, 40);
        const StudyPage page = speedup_page("random", own, {&a, &b}, {&own, &large});
        check_page(page);
        for (std::size_t row = 0; row < 20; ++row) {
            const auto pes = static_cast<std::uint32_t>(row + 1);
            const double of_a = cyclic_load(a, pes, 16, false).speedup(),
                         of_b = cyclic_load(b, pes, 16, false).speedup();
            CHECK(page.value("fig9-views", row, "p = 16") == Approx((of_a + of_b) / 2).epsilon(1e-12));
            CHECK(page.value("fig9-views", row, "p = 16, +-") ==  // t = 12.706 of one degree of freedom
                  Approx(12.7062 * std::abs(of_a - of_b) / 2).epsilon(1e-4).margin(1e-9));
        }
        const StudyTable& sizes = page.table("fig9-sizes");
        REQUIRE(sizes.rows.size() == 5 + 6);  // 1, 2, 4, 8, 16 and also 32
        for (std::size_t row = 0; row < sizes.rows.size(); ++row) {
            const auto pes = static_cast<std::uint32_t>(sizes.at(row, "P").number());
            CHECK(sizes.at(row, "p = 0").number() == cyclic_load(row < 5 ? own : large, pes, 0, false).speedup());
        }
    }
}

TEST_CASE("study fig9 takes the costs of the scene that is named", "[study][slow]") {
    Session session(choose_device(""));
    Laboratory lab(session, 32);
    const std::vector<LabelledScene> glass = {embedded_scene("glass")};
    const Ensemble ensemble = ensemble_of(lab, glass[0], 32);
    std::vector<const CostImage*> views;
    for (const Costs* costs : ensemble.views) views.push_back(&costs->trace);
    const CostImage& own = lab.costs(glass[0], 32).trace;
    CHECK(page_json(study_fig9(lab, glass)).dump() == page_json(speedup_page("glass", own, views, {&own})).dump());
    CHECK(read_back(study_fig9(lab, {}).settings)["scene"] == "centre");
}

}  // namespace
}  // namespace raya
