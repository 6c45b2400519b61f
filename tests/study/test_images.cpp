// Efficiency over many images: against plain sums, and the verdict on the paper's words both ways.
#include <cmath>
#include <list>

#include "host/study/page_writer.hpp"
#include "host/study/studies.hpp"
#include "tests/study/study_cases.hpp"

namespace raya {
namespace {

Costs costs_of(const std::string& label, CostImage image) {
    Costs costs;
    costs.label = label;
    costs.objects = 7;
    costs.trace = std::move(image);
    return costs;
}

PlainLoad load_of_offset(const CostImage& image, std::uint32_t pes, std::uint32_t p) {
    return plain_load(image, pes, [&](std::uint32_t row, std::uint32_t column) {
        return sheared(row, column, p, image.width) % pes;
    });
}

TEST_CASE("the images' efficiencies are mean / largest load", "[study]") {
    constexpr unsigned kSeed = 17;
    std::mt19937 random(kSeed);
    for (int i = 0; i < 200; ++i) {
        const auto pes = static_cast<std::uint32_t>(16 + random() % 10),
                   p = static_cast<std::uint32_t>(std::sqrt(pes) + 0.5);
        std::list<Costs> all;
        std::vector<const Costs*> images;
        for (const std::uint32_t side : {pes, 2 * pes})
            for (const char* label : {"a", "b", "c"})
                images.push_back(&all.emplace_back(costs_of(label, random_costs(random, side))));
        CAPTURE(kSeed, i, pes, p);
        const StudyPage page = images_page(pes, images);
        check_page(page);
        REQUIRE(page.table("images").rows.size() == images.size());
        const std::string shifted = ", p = " + std::to_string(p);
        double least = 1, most = 0;
        for (std::size_t n = 0; n < images.size(); ++n) {
            const PlainLoad columns = load_of_offset(images[n]->trace, pes, 0);
            const PlainLoad cyclic = load_of_offset(images[n]->trace, pes, p);
            CHECK(page.value("images", n, "side") == images[n]->trace.width);
            CHECK(page.value("images", n, "u, p = 0") == columns.imbalance());
            CHECK(page.value("images", n, "efficiency, p = 0") == columns.efficiency());
            CHECK(page.value("images", n, "u" + shifted) == cyclic.imbalance());
            CHECK(page.value("images", n, "efficiency" + shifted) == cyclic.efficiency());
            least = std::min(least, columns.efficiency());
            most = std::max(most, columns.efficiency());
        }
        CHECK(page.comparison("lowest of all, p = 0").ours == least);
        CHECK(page.comparison("highest of all, p = 0").ours == most);
        REQUIRE(page.plots[0].series.size() == 4);
        CHECK(page.plots[0].x_label == "scene: 1 a, 2 b, 3 c");
        for (const PlotSeries& series : page.plots[0].series) CHECK(series.x == std::vector<double>{1, 2, 3});
    }
}

// A block of 4 x 4: for p = 4 a dear pixel for each of 16 PEs.
CostImage dear_block(std::uint32_t side) {
    CostImage image = even_costs(side);
    for (std::uint32_t i = 0; i < 16; ++i) image.cycles[(5 + i / 4) * side + 6 + i % 4] = 1000;
    return image;
}

// All that is dear lies on the pixels that PE 0 has for p = 4.
CostImage dear_lattice(std::uint32_t side) {
    CostImage image = even_costs(side);
    for (std::uint32_t row = 0; row < side; ++row) image.cycles[row * side + row * 4 % side] = 1000;
    return image;
}

TEST_CASE("the images' verdicts on the paper's words go both ways", "[study]") {
    const Costs even = costs_of("even", even_costs(16)), block = costs_of("block", dear_block(16)),
                lattice = costs_of("lattice", dear_lattice(16));
    const auto verdicts = [](const StudyPage& page) {
        std::vector<ClaimVerdict> all;
        for (const Claim& claim : page.claims) all.push_back(claim.verdict);
        return all;
    };
    using enum ClaimVerdict;
    const StudyPage as_paper = images_page(16, {&even, &even, &even, &block, &block, &block});
    CHECK(verdicts(as_paper) == std::vector{kReproduced, kReproduced});
    CHECK(says(as_paper, "It is never below the column split on 6 images."));
    const StudyPage against = images_page(16, {&even, &even, &even, &lattice, &lattice, &lattice});
    CHECK(verdicts(against) == std::vector{kNotReproduced, kNotReproduced});
    CHECK(says(against, "The cyclic mapping's lowest is lattice at 16 x 16"));
    CHECK(says(against, "The column split is the better one for 3 of 6 images."));
    CHECK(images_page(16, {&even}).claims.empty());
    // Many pictures of a kind count as well.
    const StudyPage more = images_page(16, {&even}, {{"blocks", "Ours.", {&block, &lattice}}});
    CHECK(more.claims.at(1).verdict == kNotReproduced);
    CHECK(more.table("images-groups").at(1, "number") == Cell(2));
    CHECK(more.value("images-groups", 1, "cyclic") ==
          Approx((load_of_offset(block.trace, 16, 4).efficiency() + load_of_offset(lattice.trace, 16, 4).efficiency()) /
                 2));
}

TEST_CASE("the images' first is set beside the paper only where it is the paper's case", "[study]") {
    const Costs centre = costs_of("centre", even_costs(256)), other = costs_of("other", even_costs(256)),
                small = costs_of("centre", even_costs(32));
    CHECK(images_page(256, {&centre}).comparisons[0].paper);
    CHECK_FALSE(images_page(256, {&other}).comparisons[0].paper);
    CHECK_FALSE(images_page(32, {&small}).comparisons[0].paper);
}

TEST_CASE("study images takes ten scenes at two sizes", "[study][slow]") {
    Session session(choose_device(""));
    Laboratory lab(session, 16);
    const StudyPage page = study_images(lab, {});
    check_page(page);
    const StudyTable& table = page.table("images");
    REQUIRE(table.rows.size() == 20);
    const std::vector<LabelledScene> scenes = paper_like_scenes();
    for (std::size_t n = 0; n < 20; ++n) {
        CHECK(table.at(n, "scene").text() == scenes[n % 10].label);
        CHECK(table.at(n, "objects").number() == static_cast<double>(scenes[n % 10].scene.object_count()));
        CHECK(table.at(n, "side").number() == (n < 10 ? 16 : 32));
    }
    const PlainLoad last = load_of_offset(lab.costs(scenes[9], 32).trace, 16, 4);
    CHECK(table.at(19, "efficiency, p = 4").number() == last.efficiency());
}

}  // namespace
}  // namespace raya
