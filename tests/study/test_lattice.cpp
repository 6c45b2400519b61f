// Offsets as lattices: shortest vectors against distances in the image, ranks, and the page's figures and words.
#include <cmath>
#include <list>

#include "host/study/lattice.hpp"
#include "host/study/page_writer.hpp"
#include "host/study/studies.hpp"
#include "tests/document.hpp"
#include "tests/study/study_cases.hpp"

namespace raya {
namespace {

using Offsets = std::vector<std::uint32_t>;

// Least squared distance of two pixels of one PE, all pairs in the image.
std::uint64_t nearest_pair(std::uint32_t p, std::uint32_t side) {
    std::uint64_t least = ~std::uint64_t{0};
    for (std::uint32_t a = 0; a < side * side; ++a)
        for (std::uint32_t b = a + 1; b < side * side; ++b) {
            const std::int64_t rows = std::int64_t{b / side} - a / side, columns = std::int64_t{b % side} - a % side;
            const auto square = static_cast<std::uint64_t>(rows * rows + columns * columns);
            if (square < least && sheared(a / side, a % side, p, side) == sheared(b / side, b % side, p, side))
                least = square;
        }
    return least;
}

TEST_CASE("the shortest vector is the least distance of two pixels of a PE", "[study]") {
    for (std::uint32_t side = 2; side <= 18; ++side)
        for (std::uint32_t p = 0; p < side; ++p) {
            CAPTURE(side, p);
            CHECK(shortest_square(p, side) == nearest_pair(p, side));
        }
    for (std::uint32_t p = 1; p < 256; ++p) CHECK(shortest_square(p, 256) == shortest_square(256 - p, 256));
}

TEST_CASE("twelve offsets beyond 16 spread better on 256 PEs, six as well", "[study]") {
    const SpreadOffsets offsets = well_spread_offsets(256, 16);
    CHECK(offsets.longer == Offsets{30, 60, 71, 92, 119, 120, 136, 137, 164, 185, 196, 226});
    CHECK(offsets.as_long == Offsets{48, 80, 112, 144, 176, 208});
    CHECK(shortest_square(16, 256) == 256);
}

TEST_CASE("ranks share what is equal, and correlate", "[study]") {
    CHECK(ranks_of({5, 1, 3}) == std::vector<double>{3, 1, 2});
    CHECK(ranks_of({2, 1, 2, 2}) == std::vector<double>{3, 1, 3, 3});
    CHECK(ranks_of({}).empty());
    CHECK(rank_correlation({1, 2, 3}, {10, 100, 1000}) == 1);
    CHECK(rank_correlation({1, 2, 3}, {3, 2, -7}) == -1);
    CHECK(rank_correlation({1, 2, 3}, {4, 4, 4}) == 0);
    CHECK(rank_correlation({1, 2, 3, 4}, {2, 1, 4, 3}) == 0.6);  // 1 - 6 * 4 / (4 * 15)
    constexpr unsigned kSeed = 5;
    std::mt19937 random(kSeed);
    for (int i = 0; i < 300; ++i) {
        CAPTURE(kSeed, i);
        std::vector<double> values(1 + random() % 30);
        for (double& value : values) value = static_cast<double>(random() % 8);
        const std::vector<double> ranks = ranks_of(values);
        for (std::size_t n = 0; n < values.size(); ++n) {
            const auto below = std::count_if(values.begin(), values.end(), [&](double v) { return v < values[n]; });
            const auto equal = std::count(values.begin(), values.end(), values[n]);
            CHECK(ranks[n] == static_cast<double>(below) + static_cast<double>(equal + 1) / 2);
        }
    }
}

struct Case {
    std::list<Costs> all;
    std::vector<Ensemble> scenes;
    void add(const std::string& label, CostImage image) {
        Costs& costs = all.emplace_back();
        costs.label = label;
        costs.trace = std::move(image);
        scenes.push_back({&costs});
    }
    double mean_u(std::uint32_t p) const {
        double sum = 0;
        for (const Ensemble& scene : scenes) {
            const std::uint32_t side = scene.picture->trace.width;
            sum += plain_load(scene.picture->trace, side,
                              [&](std::uint32_t row, std::uint32_t column) { return sheared(row, column, p, side); })
                       .imbalance() /
                   static_cast<double>(scenes.size());
        }
        return sum;
    }
};

// What the first finding has to say of one picture, from u alone: 0 better, 1 worse, 2 neither.
int verdict_of(const std::vector<double>& u, const Offsets& longer, const Offsets& as_long, double own) {
    double sum = 0, count = 0;
    for (const Offsets* group : {&longer, &as_long})
        for (const std::uint32_t p : *group) sum += u[p], ++count;
    return sum / count < own ? 0 : sum / count > own ? 1 : 2;
}

TEST_CASE("the lattice page has every offset's u, and draws the conclusion that follows", "[study]") {
    const char* const words[] = {"they are better on the whole", "they are worse on the whole",
                                 "no difference can be told"};
    constexpr unsigned kSeed = 23;
    constexpr std::uint32_t kSide = 32;
    const SpreadOffsets spread = well_spread_offsets(kSide, 6);
    REQUIRE(!spread.longer.empty());
    std::mt19937 random(kSeed);
    int seen[3] = {};
    for (int i = 0; i < 150; ++i) {
        Case c;
        for (int n = 0; n < 1 + i % 2; ++n)
            c.add(std::string(1, static_cast<char>('a' + n)), random_costs(random, kSide));
        CAPTURE(kSeed, i);
        const StudyPage page = lattice_page(c.scenes);
        check_page(page);
        REQUIRE(page.table("lattice").rows.size() == kSide);
        std::vector<double> u;
        for (std::uint32_t p = 0; p < kSide; ++p) {
            u.push_back(c.mean_u(p));
            CHECK(page.value("lattice", p, "mean u") == Approx(u[p]).epsilon(1e-13));
        }
        CHECK(page.comparison("lowest mean u of all offsets").ours ==
              Approx(*std::min_element(u.begin(), u.end())).epsilon(1e-13));
        if (c.scenes.size() > 1) continue;  // with intervals
        const int verdict = verdict_of(u, spread.longer, spread.as_long, u[6]);
        CAPTURE(verdict, page.findings[0]);
        CHECK(page.findings[0].find(words[verdict]) != std::string::npos);
        ++seen[verdict];
    }
    CHECK(seen[0] > 0);
    CHECK(seen[1] > 0);
    Case even;  // every offset has u = 0
    even.add("even", even_costs(kSide));
    CHECK(says(lattice_page(even.scenes), words[2]));
}

TEST_CASE("the lattice page says how far the shortest vector tells u", "[study]") {
    Case even;
    even.add("even", even_costs(32));
    CHECK(says(lattice_page(even.scenes), "in no picture does the shortest vector tell much about u"));
    CostImage blob = even_costs(32);  // one dear square: near pixels cost alike
    for (std::uint32_t row = 12; row < 18; ++row)
        for (std::uint32_t column = 12; column < 18; ++column) blob.cycles[row * 32 + column] = 1000;
    Case round;
    round.add("blob", blob);
    CHECK(says(lattice_page(round.scenes), "in every picture a longer shortest vector goes with a lower u"));
    round.add("even", even_costs(32));
    CHECK(says(lattice_page(round.scenes), "in some pictures and not in others"));
    CHECK(says(lattice_page({{round.scenes[0].picture, {round.scenes[0].picture, round.scenes[1].picture}}}),
               "in some pictures and not in others"));  // views stand for the scene
    Case least;                                         // 16 columns, where no offset spreads as well as 4
    least.add("even", even_costs(16));
    check_page(lattice_page(least.scenes));
}

TEST_CASE("whether an offset shares every block is found by looking at the blocks", "[study]") {
    const auto looked_at = [](std::uint32_t p, std::uint32_t side, std::uint32_t n) {
        for (std::uint32_t x = 0; x < side; ++x) {  // every column; rows only turn the PEs' numbers
            std::vector<bool> seen(side);
            for (std::uint32_t row = 0; row < n; ++row)
                for (std::uint32_t column = 0; column < n; ++column) {
                    const std::uint32_t pe = sheared(row, (x + column) % side, p, side);
                    if (seen[pe]) return false;
                    seen[pe] = true;
                }
        }
        return true;
    };
    for (std::uint32_t side = 4; side <= 40; ++side)
        for (std::uint32_t p = 0; p < side; ++p)
            for (std::uint32_t n = 2; n * n <= side; ++n) {
                CAPTURE(side, p, n);
                CHECK(shares_blocks(p, side, n) == looked_at(p, side, n));
            }
    CHECK(shares_blocks(16, 256, 16));
    CHECK_FALSE(shares_blocks(13, 256, 16));
}

TEST_CASE("whether 0..n is enough is judged with intervals", "[study]") {
    using enum ClaimVerdict;
    const auto verdict = [](const std::vector<CostImage>& images) {
        Case c;
        for (const CostImage& image : images) c.add("x", image);
        return lattice_page(c.scenes).claims.at(1).verdict;
    };
    CHECK(verdict({even_costs(16), even_costs(16), even_costs(16)}) == kReproduced);
    // All that is dear lies on one PE's pixels for each of 0..4, and is spread by others.
    CostImage image = even_costs(16);
    for (std::uint32_t p = 0; p <= 4; ++p)
        for (std::uint32_t row = 0; row < 16; ++row) image.cycles[row * 16 + row * p % 16] = 1000;
    CHECK(verdict(std::vector(6, image)) == kNotReproduced);
    CHECK(verdict({image, even_costs(16)}) == kCannotTell);
}

TEST_CASE("study lattice takes five scenes of the paper's kind", "[study][slow]") {
    Session session(choose_device(""));
    Laboratory lab(session, 32);
    const StudyPage page = study_lattice(lab, {});
    check_page(page);
    CHECK(read_back(page.settings)["scenes"] == Document{"centre", "mirrors", "glass", "random-12", "random-30"});
    for (const LabelledScene& scene : paper_like_scenes())
        if (read_back(page.settings)["scenes"].dump().find('"' + scene.label + '"') != std::string::npos)
            CHECK((scene.scene.object_count() >= 6 && scene.scene.object_count() <= 30));
    const LabelledScene glass = embedded_scene("glass");
    CHECK(page_json(study_lattice(lab, {glass})).dump() ==
          page_json(lattice_page({ensemble_of(lab, glass, 32)})).dump());
}

}  // namespace
}  // namespace raya
