// The studies of Tables 2, 3 and 4, against the cost image and the machine's rates by hand.
#include <catch2/catch.hpp>

#include "host/model/budget.hpp"
#include "host/ring/schedule.hpp"
#include "host/study/arrays.hpp"
#include "host/study/laboratory.hpp"
#include "host/study/paper.hpp"
#include "host/study/spa_times.hpp"
#include "host/study/studies.hpp"
#include "tests/reference/reference.hpp"
#include "tests/study/study_cases.hpp"

namespace raya {
namespace {

constexpr std::uint32_t kSize = 32;

double busiest_ms(const CostImage& image, std::uint32_t offset) {
    const raya_mapping m = cyclic(image.width, offset);
    return spa_ms(static_cast<double>(static_load(image, m).max));
}

double rotation_ms(std::uint32_t share) { return 10. / 32 - 0.128 + 1e3 * 3 * share / 6e6; }

constexpr double kSetupMs = 2 - 2 * 10. / 32;  // Table 4 at p = 0

// 7 ms over the filter's budget of 256 pixels, 42 cycles of 100 ns each.
const double kFactor = 7 / (256 * 42 * 100e-6);

TEST_CASE("the clock's factor is the filter's, with what its rounding allows", "[study]") {
    CHECK(machine_factor().value == Approx(kFactor).epsilon(1e-12));
    CHECK(machine_factor().value == Approx(6.5104).margin(1e-4));
    CHECK(machine_factor().least == Approx(kFactor * 6 / 7));
    CHECK(machine_factor().most == Approx(kFactor * 8 / 7));
    CHECK(clock_text().find("6.51 (5.58 .. 7.44 by rounding)") != std::string::npos);
}

TEST_CASE("the host model holds every printed time that rounding allows", "[study]") {
    const HostModel model = host_model();
    std::mt19937 random(7);
    std::uniform_real_distribution<double> off(-0.5, 0.5);
    const auto holds = [](const Interval& range, double value) {
        CHECK(value >= range.least - 1e-12);
        CHECK(value <= range.most + 1e-12);
    };
    for (int i = 0; i < 500; ++i) {  // true times that would have been printed as 2, 12 and 140
        const double few = 2 + off(random), many = 12 + off(random), image = 140 + off(random);
        const double rotation = (many - few) / 32, setup = few - 2 * rotation;
        holds(model.rotation_ms, rotation);
        holds(model.setup_ms, setup);
        holds(model.words_per_s, 196'608e3 / (image - setup));
        const double words = 100 + 10 * i;
        holds(model.call_ms(words), setup + words * (image - setup) / 196'608);
    }
    CHECK(model.setup_ms.middle() == Approx(kSetupMs));
    CHECK(model.rotation_ms.middle() == Approx(10. / 32));
}

TEST_CASE("the bus's study has the moves and times of its formulas, and one image for all ways", "[study]") {
    Session session(choose_device(""));
    Laboratory lab(session, kSize);
    const StudyPage page = study_bus(lab, {});
    check_page(page);
    const StudyTable& table = page.table("bus");
    REQUIRE(table.rows.size() == 2 * 7);  // 4, 8 .. 256 PEs; a column for each PE up to 32 of them
    for (std::size_t row = 0; row < table.rows.size(); ++row) {
        const auto figure = [&](const char* label) { return table.at(row, label).number(); };
        const double pes = figure("P"), p = figure("p"), share = kSize * kSize / pes;
        const bool filter = table.at(row, "anti-aliasing").text() == "filter";
        CAPTURE(pes, p, filter);
        CHECK(p == std::round(std::sqrt(pes)));
        if (pes > kSize) continue;
        const auto ms = [&](double moves) { return moves * rotation_ms(static_cast<std::uint32_t>(share)); };
        const double broadcasts = (filter ? 4 : 1) * pes, turns = 2 * (std::min(p, pes - p) + 1);
        CHECK(figure("rotations") == turns);
        CHECK(figure("transfers") == 4 * pes);
        CHECK(figure("broadcasts") == broadcasts);
        CHECK(figure("ring") == Approx(ms(turns)));
        CHECK(figure("bus") == Approx(ms(4 * pes)));
        CHECK(figure("broadcasts, time") == Approx(ms(broadcasts)));
        CHECK(figure("bus, words alone") == Approx(4 * 3 * kSize * kSize / 6e3));
        CHECK(figure("broadcasts, words alone") == Approx((filter ? 4 : 1) * 3 * kSize * kSize / 6e3));
        CHECK(figure("broadcasts / ring") == Approx(broadcasts / turns));
    }
    CHECK(says(page, "In 14 of 14 cases"));
}

TEST_CASE("Table 2's modelled figures follow from the cost image and the rates", "[study]") {
    Session session(choose_device(""));
    Laboratory lab(session, kSize);
    const LabelledScene scene = embedded_scene("spheres");
    const StudyPage page = study_table2(lab, {scene});
    check_page(page);
    const Costs& costs = lab.costs(scene, kSize);
    const double one = kFactor * spa_ms(static_cast<double>(total_cycles(costs.trace)));
    const double array = kFactor * busiest_ms(costs.trace, 16);
    const double image = 140. * kSize * kSize / 65'536;
    const double objects = static_cast<double>(costs.job_words) * 140 / 196'608;
    const auto ours = [&](const std::string& what) { return page.comparison(what).ours; };
    CHECK(ours("32 PEs: objects") == Approx(objects).epsilon(1e-12));
    CHECK(ours("32 PEs: compute") == Approx(array).epsilon(1e-12));
    CHECK(ours("32 PEs: image transfer") == Approx(image).epsilon(1e-12));
    CHECK(ours("32 PEs: total") == Approx(objects + array + image + 1130).epsilon(1e-12));
    CHECK(ours("1 PE: compute") == Approx(one).epsilon(1e-12));
    CHECK(ours("1 PE: total") == Approx(objects + one + image + 1130).epsilon(1e-12));
    CHECK(ours("cycles a pixel") ==
          Approx(static_cast<double>(total_cycles(costs.trace)) / (kSize * kSize)).epsilon(1e-12));
    CHECK(ours("speed-up of computing") == Approx(one / array).epsilon(1e-12));
    CHECK(ours("speed-up of the whole job") ==
          Approx((64'800 + 1272.) / (64'800 * array / one + 1272)).epsilon(1e-12));  // 2 + 140 + 1,130 ms
    CHECK(ours("one processor, 64 bits") > 0);
    for (const Comparison& comparison : page.comparisons) CHECK_FALSE(comparison.paper);  // not the paper's size
    CHECK(page.claims.empty());
    REQUIRE(page.pictures.size() == 1);
    CHECK(page.pictures[0].png.starts_with("\x89PNG"));
    CHECK(page.clock == clock_text());
    const StudyTable& table = page.table("table2");
    for (std::size_t row = 0; row < table.rows.size(); ++row) {
        double sum = 0;
        for (const char* part : {"objects", "compute", "image transfer", "display"})
            if (const Cell& cell = table.at(row, part); cell != Cell("-")) sum += cell.number();
        CHECK(table.at(row, "total").number() == Approx(sum).epsilon(1e-12));
    }
    for (std::size_t row = 0; row < 8; ++row) {
        const double factor = static_cast<double>(row + 1);
        CHECK(page.value("table2-factors", row, "1 PE: compute") == Approx(factor * one / kFactor).epsilon(1e-12));
        CHECK(page.value("table2-factors", row, "speed-up of the whole job") ==
              Approx((factor * one / kFactor + 1272) / (factor * array / kFactor + 1272)).epsilon(1e-12));
    }
}

TEST_CASE("Table 3's times are tracing, filter and counted rotations", "[study]") {
    Session session(choose_device(""));
    Laboratory lab(session, kSize);
    const LabelledScene scene = embedded_scene("centre");
    const StudyPage page = study_table3(lab, {});
    check_page(page);
    const CostImage& image = lab.costs(scene, kSize).trace;
    const double filter = spa_ms(static_cast<double>(filter_cycles(kSize)));
    REQUIRE(page.table("table3").rows.size() == 3);
    REQUIRE(page.table("table3-offsets").rows.size() == kSize);
    const auto ring = [](std::uint32_t p) { return kSetupMs + 2 * (p + 1) * rotation_ms(kSize); };
    for (std::size_t i = 0; i < 3; ++i) {
        const auto p = static_cast<std::uint32_t>(8 * i);
        const double tracing = kFactor * busiest_ms(image, p), total = tracing + kFactor * filter + ring(p);
        const std::pair<const char*, double> expected[] = {{"p", p},
                                                           {"rotations", 2. * (p + 1)},
                                                           {"communication", ring(p)},
                                                           {"filter", kFactor * filter},
                                                           {"ray tracing", tracing},
                                                           {"total", total}};
        for (const auto& [label, value] : expected)
            CHECK(page.value("table3", i, label) == Approx(value).epsilon(1e-12));
        CHECK(page.comparison(offset_name(p) + ": filtering").ours ==
              Approx(kFactor * filter + ring(p)).epsilon(1e-12));
        // The routes foretell what the renders counted.
        CHECK(page.value("table3-offsets", p, "total") == Approx(page.value("table3", i, "total")).epsilon(1e-12));
    }
    const StudyTable& factors = page.table("table3-factors");
    REQUIRE(factors.rows.size() == 9);  // 1 to 8, and the clock's
    for (std::size_t row = 0; row < 9; ++row) {
        const double factor = factors.at(row, "factor").number();
        const auto total = [&](std::uint32_t p) { return factor * (busiest_ms(image, p) + filter) + ring(p); };
        CHECK(factors.at(row, "p = 0 over p = 16").number() == Approx(total(0) / total(16)).epsilon(1e-12));
        const double saved = factor * (busiest_ms(image, 0) - busiest_ms(image, 16)), lost = ring(16) - ring(0);
        CHECK(factors.at(row, "pays") == Cell(saved > lost ? "yes" : "no"));
        std::uint32_t best = 0;
        for (std::uint32_t p = 1; p <= 16; ++p)
            if (total(p) < total(best)) best = p;
        CHECK(factors.at(row, "best of 0..16") == Cell(best));
    }
    for (const Claim& claim : page.claims) CHECK(claim.paper == paper::kSpa);
    CHECK(page.claims.at(1).verdict == ClaimVerdict::kReproduced);  // 2 (p + 1) rotations
}

TEST_CASE("Table 4 has both readings, and the comparisons' cycles in each", "[study]") {
    Session session(choose_device(""));
    Laboratory lab(session, kSize);
    const LabelledScene scene = embedded_scene("centre");
    const StudyPage page = study_table4(lab, {});
    check_page(page);
    const Costs& costs = lab.costs(scene, kSize, AntialiasMethod::kSupersample);
    const double compare = spa_ms(static_cast<double>(compare_cycles(kSize)));
    for (const std::uint32_t p : {0u, 16u}) {
        const double alone = kFactor * (compare + busiest_ms(costs.supersample, p)),
                     both = alone + kFactor * busiest_ms(costs.trace, p);
        const double ring = kSetupMs + 2 * (std::min(p, kSize - p) + 1) * rotation_ms(kSize);
        const auto ours = [&](const std::string& what) { return page.comparison(offset_name(p) + what).ours; };
        CHECK(ours(": communication") == Approx(ring).epsilon(1e-12));
        CHECK(ours(": phase alone") == Approx(alone).epsilon(1e-12));
        CHECK(ours(": with first pass") == Approx(both).epsilon(1e-12));
    }
    CHECK(page.comparison("pixels recomputed").ours ==
          Approx(100. * static_cast<double>(costs.recomputed) / (kSize * kSize)).epsilon(1e-12));
    CHECK(page.claims.at(0).verdict == ClaimVerdict::kReproduced);  // as many rotations as the filter's
}

TEST_CASE("at the paper's size its figures stand beside ours", "[study]") {
    Session session(choose_device(""));
    Laboratory lab(session, 0);
    const StudyPage page = study_table4(lab, {});
    CHECK(page.comparison("p = 0: communication").paper == 2);
    CHECK(page.comparison("p = 16: communication").paper == 12);
    CHECK(page.comparison("p = 8: communication").source == Source::kDerived);
    CHECK(page.comparison("p = 0: phase alone").paper == 739);
    CHECK(page.comparison("p = 0: communication").ours == Approx(2).epsilon(1e-12));
    CHECK(page.comparison("p = 16: communication").ours == Approx(12).epsilon(1e-12));
    // The finding agrees with the figures that it stands on.
    const auto off = [&](const std::string& reading) {
        const Comparison &first = page.comparison("p = 0: " + reading), &last = page.comparison("p = 16: " + reading);
        return std::abs(std::log(first.ours / *first.paper)) + std::abs(std::log(last.ours / *last.paper));
    };
    const bool alone = off("phase alone") < off("with first pass");
    CHECK((page.findings.front().find("the first is nearer") != std::string::npos) == alone);
    CHECK((page.findings.front().find("the second is nearer") != std::string::npos) != alone);
}

TEST_CASE("a scene too large for the SPA's PEs is rendered on grande, in fp32", "[study]") {
    Scene scene = embedded_scene("spheres").scene;
    const Sphere sphere = scene.spheres.front();
    CHECK(format_name(format_for(scene)) == "e6m15");
    scene.spheres.resize(3000, sphere);
    CHECK(format_for(scene).is_fp32());
    Session session(choose_device(""));
    CHECK(run_on_spa(session, {"many", scene}, 8, 8, 1).machine == "grande");
}

TEST_CASE("the reference is the same on any number of threads", "[study]") {
    const Scene scene = embedded_scene("glass").scene;
    const auto render = [&](int threads) {
        return reference::render(scene, {.width = 13, .height = 7, .threads = threads});
    };
    const reference::Image two = render(2);
    for (const int threads : {1, 3, 8}) {
        const reference::Image other = render(threads);
        CHECK(other.pixels == two.pixels);
        CHECK(other.counts == two.counts);
    }
}

}  // namespace
}  // namespace raya
