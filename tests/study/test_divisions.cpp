// The study of divisions: its shapes, what it concludes from made-up counts, and counts that hold of any grid.
#include <fmt/core.h>

#include <random>

#include "host/model/t805.hpp"
#include "host/scene/generate.hpp"
#include "host/study/paper.hpp"
#include "host/study/studies.hpp"
#include "host/study/torus_runs.hpp"
#include "tests/study/study_cases.hpp"

namespace raya {
namespace {

// As many sphere tests, steps and ms as told; a ray each.
GridRun made_up(std::uint32_t power, std::uint64_t objects, std::uint64_t tests, std::uint64_t steps, double ms) {
    GridRun run{.label = fmt::format("{} objects", objects), .objects = objects, .divisions = near_cube(1u << power)};
    run.events[RAYA_PRIMARY] = 1;
    run.events[RAYA_SPHERE_TESTS] = tests;
    run.events[RAYA_WALKS] = 1;
    run.events[RAYA_STEPS] = steps;
    run.measured_ms = ms;
    return run;
}

double modelled_s(const GridRun& run) {
    double cycles = 0;
    for (std::size_t event = 0; event < RAYA_EVENTS; ++event)
        cycles += static_cast<double>(t805_cycles()[event]) * static_cast<double>(run.events[event]);
    return cycles * 40e-9;
}

// 64, 256, 512 and 1024 objects whose tests are fewest at `best` of the powers.
std::vector<std::vector<GridRun>> made_up_paper(const std::array<std::uint32_t, 4>& best) {
    std::vector<std::vector<GridRun>> all;
    const std::uint64_t objects[] = {64, 256, 512, 1024};
    for (std::size_t i = 0; i < 4; ++i) {
        all.emplace_back();
        for (std::uint32_t k = 0; k <= 13; ++k) {
            const std::uint64_t far = k < best[i] ? best[i] - k : k - best[i];
            all.back().push_back(made_up(k, objects[i], 1000 + 100 * far, 1, 5.0 + double(far)));
        }
    }
    return all;
}

TEST_CASE("divisions tells where the least lies beside the paper's objects", "[study]") {
    const StudyPage page = divisions_page(96, made_up_paper({6, 8, 10, 13}), true);
    check_page(page);
    const Comparison& tests = page.comparison("fewest tests, 512 objects");
    CHECK(tests.paper == 512.0);
    CHECK(tests.ours == 1024);
    CHECK(tests.remark == "16x8x8");
    CHECK(page.comparison("least modelled time, 64 objects").ours == 64);
    CHECK_FALSE(page.comparison("least measured time, 64 objects").paper);
    CHECK(says(page,
               "Fewest tests: at divisions 64 for 64 objects, 256 for 256 objects, 1024 for 512 objects, 8192 for 1024 "
               "objects; divisions = objects is it for 2 of 4; 1 at the last division tried, so it may lie beyond."));
    CHECK(says(page, "and 1.00, 1.00, 1.10, 1.30 times the fewest tests; an object then lies in 1.00, 1.00,"));
    CHECK(page.claims[0].verdict == ClaimVerdict::kNotReproduced);
    CHECK(page.claims[4].verdict == ClaimVerdict::kNotReproduced);
    for (const StudyPlot& plot : page.plots)  // a paper's times of its own machine have no place beside a model's
        CHECK(std::ranges::count(plot.series, PlotStyle::kPaper, &PlotSeries::style) == 0);
    const StudyPage all_equal = divisions_page(96, made_up_paper({6, 8, 9, 10}), true);
    CHECK(says(all_equal, "divisions = objects is it for 4 of 4."));
    CHECK(all_equal.claims[0].verdict == ClaimVerdict::kReproduced);
    CHECK(all_equal.claims[4].verdict == ClaimVerdict::kReproduced);
    CHECK(says(all_equal, "Divisions = objects takes 1.00 (64 objects), 1.00 (256"));
}

TEST_CASE("divisions' falls are figures at 32 over those at 1024", "[study]") {
    std::mt19937 random(51);
    for (int i = 0; i < 100; ++i) {
        std::vector<std::vector<GridRun>> all(1);
        for (std::uint32_t k = 0; k <= 13; ++k)
            all[0].push_back(made_up(k, 1024, 1 + random() % 100000, 1 + random() % 1000, 1 + double(random() % 100)));
        CAPTURE(i);
        const StudyPage page = divisions_page(96, all, true);
        check_page(page);
        const std::string what = "32 over 1024 divisions, 1024 objects: ";
        const GridRun &few = all[0][5], &many = all[0][10];
        const auto check = [&](const char* figure, double ours, double paper) {
            CHECK(page.comparison(what + figure).ours == Approx(ours).epsilon(1e-12));
            CHECK(page.comparison(what + figure).paper == paper);
        };
        check("modelled time", modelled_s(few) / modelled_s(many), 313.0 / 60);
        check("measured time", few.measured_ms / many.measured_ms, 313.0 / 60);
        const double tests = double(few.events[RAYA_SPHERE_TESTS]) / double(many.events[RAYA_SPHERE_TESTS]);
        check("tests", tests, 5);
        CHECK(page.comparison(what + "modelled time").source == Source::kDerived);
        CHECK(page.comparison(what + "tests").source == Source::kPrinted);
        const auto near = [](double fall) { return fall >= 313 / 60.0 / 1.25 && fall <= 313 / 60.0 * 1.25; };
        const bool modelled = near(modelled_s(few) / modelled_s(many)),
                   measured = near(few.measured_ms / many.measured_ms);
        CHECK((page.claims[2].verdict == ClaimVerdict::kReproduced) == (modelled && measured));
        CHECK((page.claims[2].verdict == ClaimVerdict::kCannotTell) == (modelled != measured));
        CHECK((page.claims[3].verdict == ClaimVerdict::kReproduced) == (tests >= 4 && tests <= 6));
        CHECK(page.value("divisions", 5, "tests") == double(few.events[RAYA_SPHERE_TESTS]));
        CHECK(page.value("divisions", 5, "modelled") == Approx(modelled_s(few)).epsilon(1e-12));
    }
}

TEST_CASE("one voxel tests every object for every ray, and finer ones fewer", "[study][slow]") {
    Session session(choose_device(""));
    Laboratory lab(session, 17);
    const StudyPage page = study_divisions(lab, {{"even", generate_uniform(64, {4, 4, 4})}});
    check_page(page);
    for (const Comparison& comparison : page.comparisons) CHECK_FALSE(comparison.paper);
    CHECK(page.claims.empty());
    REQUIRE(page.table("divisions").rows.size() == 14);
    const auto at = [&](std::size_t row, const char* label) { return page.value("divisions", row, label); };
    const double rays = at(0, "rays");
    CHECK(rays > 17 * 17);
    CHECK(at(0, "copies") == 0);
    CHECK(at(0, "tests") <= 64 * rays);
    CHECK(at(0, "steps") <= rays);
    CHECK(at(0, "tests") <= 64 * at(0, "steps"));
    CHECK(at(0, "tests") > 48 * at(0, "steps"));  // a shadow ray may end before the last object
    for (std::size_t row = 0; row < 14; ++row) {
        CHECK(at(row, "rays") == rays);  // the image does not depend on the grid
        CHECK(at(row, "tests a ray") == Approx(at(row, "tests") / rays));
    }
    CHECK(at(6, "tests") < at(0, "tests") / 8);
    CHECK(at(13, "steps") > at(6, "steps"));
    CHECK(at(13, "copies") > at(6, "copies"));
}

}  // namespace
}  // namespace raya
