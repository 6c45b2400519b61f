// The studies of Tables 2, 3 and 4, against the cost image and the machine's rates by hand.
#include <catch2/catch.hpp>

#include "host/machine/budget.hpp"
#include "host/ring/schedule.hpp"
#include "host/study/arrays.hpp"
#include "host/study/laboratory.hpp"
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

TEST_CASE("Table 2's modelled figures follow from the cost image and the rates", "[study]") {
    Session session(choose_device(""));
    Laboratory lab(session, kSize);
    const LabelledScene scene = embedded_scene("spheres");
    const StudyPage page = study_table2(lab, {scene});
    check_page(page);
    const Costs& costs = lab.costs(scene, kSize);
    const double one = spa_ms(static_cast<double>(total_cycles(costs.trace)));
    const double array = busiest_ms(costs.trace, 16), factor = fitted_factor(costs.trace);
    const double image = 140. * kSize * kSize / 65'536;
    const double objects = static_cast<double>(costs.job_words) * 140 / 196'608;
    const auto ours = [&](const std::string& what) { return page.comparison(what).ours; };
    CHECK(ours("32 PEs: objects") == Approx(objects).epsilon(1e-12));
    CHECK(ours("32 PEs: compute") == Approx(array).epsilon(1e-12));
    CHECK(ours("32 PEs: compute, fitted") == Approx(factor * array).epsilon(1e-12));
    CHECK(ours("32 PEs: image transfer") == Approx(image).epsilon(1e-12));
    CHECK(ours("32 PEs: total") == Approx(objects + array + image).epsilon(1e-12));
    CHECK(ours("1 PE: compute") == Approx(one).epsilon(1e-12));
    CHECK(ours("1 PE: compute, fitted") == Approx(64'800. * kSize * kSize / 65'536).epsilon(1e-12));
    CHECK(ours("1 PE: total, fitted") == Approx(objects + factor * one + image).epsilon(1e-12));
    CHECK(ours("factor") == Approx(factor).epsilon(1e-12));
    CHECK(ours("speed-up of computing") == Approx(one / array).epsilon(1e-12));
    CHECK(ours("one processor, 64 bits") > 0);
    for (const Comparison& comparison : page.comparisons) CHECK_FALSE(comparison.paper);  // not the paper's size
    const StudyTable& table = page.table("table2");
    for (std::size_t row = 0; row < table.rows.size(); ++row) {
        double sum = 0;
        for (const char* part : {"objects", "compute", "image transfer"})
            if (const Cell& cell = table.at(row, part); cell != Cell("-")) sum += cell.number();
        CHECK(table.at(row, "total").number() == Approx(sum).epsilon(1e-12));
    }
}

TEST_CASE("Table 3's times are tracing, filter and counted rotations", "[study]") {
    Session session(choose_device(""));
    Laboratory lab(session, kSize);
    const LabelledScene scene = embedded_scene("centre");
    const StudyPage page = study_table3(lab, {});
    check_page(page);
    const CostImage& image = lab.costs(scene, kSize).trace;
    const double factor = fitted_factor(image), filter = spa_ms(static_cast<double>(filter_cycles(kSize)));
    REQUIRE(page.table("table3").rows.size() == 3);
    REQUIRE(page.table("table3-offsets").rows.size() == kSize);
    for (std::size_t i = 0; i < 3; ++i) {
        const auto p = static_cast<std::uint32_t>(8 * i);
        const double ring = 2 * (p + 1) * rotation_ms(kSize), tracing = busiest_ms(image, p);
        const std::pair<const char*, double> expected[] = {{"p", p},
                                                           {"rotations", 2. * (p + 1)},
                                                           {"communication", ring},
                                                           {"filter", filter},
                                                           {"filter, fitted", factor * filter},
                                                           {"ray tracing", tracing},
                                                           {"ray tracing, fitted", factor * tracing},
                                                           {"total", tracing + filter + ring},
                                                           {"total, fitted", factor * (tracing + filter) + ring}};
        for (const auto& [label, value] : expected)
            CHECK(page.value("table3", i, label) == Approx(value).epsilon(1e-12));
        CHECK(page.comparison(offset_name(p) + ": filtering, fitted").ours ==
              Approx(factor * filter + ring).epsilon(1e-12));
        // The routes foretell what the renders counted.
        CHECK(page.value("table3-offsets", p, "total") == Approx(page.value("table3", i, "total")).epsilon(1e-12));
    }
}

TEST_CASE("Table 4 has both readings, and the comparisons' cycles in each", "[study]") {
    Session session(choose_device(""));
    Laboratory lab(session, kSize);
    const LabelledScene scene = embedded_scene("centre");
    const StudyPage page = study_table4(lab, {});
    check_page(page);
    const Costs& costs = lab.costs(scene, kSize, AntialiasMethod::kSupersample);
    const double factor = fitted_factor(costs.trace), compare = spa_ms(static_cast<double>(compare_cycles(kSize)));
    for (const std::uint32_t p : {0u, 16u}) {
        const double alone = compare + busiest_ms(costs.supersample, p), both = alone + busiest_ms(costs.trace, p);
        const double ring = 2 * (std::min(p, kSize - p) + 1) * rotation_ms(kSize);
        const auto ours = [&](const std::string& what) { return page.comparison(offset_name(p) + what).ours; };
        CHECK(ours(": communication") == Approx(ring).epsilon(1e-12));
        CHECK(ours(": phase alone") == Approx(alone).epsilon(1e-12));
        CHECK(ours(": phase alone, fitted") == Approx(factor * alone).epsilon(1e-12));
        CHECK(ours(": with first pass") == Approx(both).epsilon(1e-12));
        CHECK(ours(": total, with first pass, fitted") == Approx(factor * both + ring).epsilon(1e-12));
    }
    CHECK(page.comparison("pixels recomputed").ours ==
          Approx(100. * static_cast<double>(costs.recomputed) / (kSize * kSize)).epsilon(1e-12));
}

TEST_CASE("at the paper's size its figures stand beside ours", "[study]") {
    Session session(choose_device(""));
    Laboratory lab(session, 0);
    const StudyPage page = study_table4(lab, {});
    CHECK(page.comparison("p = 0: communication").paper == 2);
    CHECK(page.comparison("p = 16: communication").paper == 12);
    CHECK(page.comparison("p = 0: phase alone").paper == 739);
    CHECK(page.comparison("p = 16: total, phase alone, fitted").paper == 419);
    CHECK(page.comparison("p = 16: communication").ours == Approx(34 * 0.3125).epsilon(1e-12));
    // The finding agrees with the figures that it stands on.
    const auto off = [&](const std::string& reading) {
        const Comparison &first = page.comparison("p = 0: " + reading), &last = page.comparison("p = 16: " + reading);
        return std::abs(std::log(first.ours / *first.paper)) + std::abs(std::log(last.ours / *last.paper));
    };
    const std::string finding = page.findings.front(), fitted = finding.substr(0, finding.find("nothing fitted"));
    const bool alone = off("phase alone, fitted") < off("with first pass, fitted");
    CHECK((fitted.find("the first is nearer") != std::string::npos) == alone);
    CHECK((fitted.find("the second is nearer") != std::string::npos) != alone);
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
