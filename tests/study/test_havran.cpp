// The study of uniform grids beside Havran & Sixta's: means of made-up counts, what stands beside what, SPD's scenes.
#include <fmt/core.h>

#include <random>

#include "host/scene/generate.hpp"
#include "host/study/studies.hpp"
#include "tests/study/study_cases.hpp"

namespace raya {
namespace {

GridRun random_run(std::mt19937& random, const std::string& label, const Divisions& divisions) {
    GridRun run{.label = label, .objects = 10, .divisions = divisions};
    for (auto& count : run.events) count = 1 + random() % 10000;
    return run;
}

double rays_by_hand(const EventCounts& e) {
    return double(e[RAYA_PRIMARY] + e[RAYA_REFLECTED] + e[RAYA_REFRACTED] + e[RAYA_SHADOW]);
}

double tests_by_hand(const EventCounts& e) {
    return double(e[RAYA_SPHERE_TESTS] + e[RAYA_PLANE_TESTS] + e[RAYA_POLYGON_TESTS] + e[RAYA_CONE_TESTS]);
}

TEST_CASE("havran's figures are means over all rays beside the published ones", "[study]") {
    std::mt19937 random(52);
    for (int i = 0; i < 100; ++i) {
        CAPTURE(i);
        const std::vector<GridRun> runs = {
            random_run(random, "balls", {46, 46, 3}),    random_run(random, "balls", {103, 103, 7}),
            random_run(random, "lattice", {20, 20, 20}), random_run(random, "lattice", {44, 44, 44}),
            random_run(random, "balls", {46, 3, 46}),    random_run(random, "mine.nff", {20, 20, 20})};
        const StudyPage page = havran_page(129, runs);
        check_page(page);
        const double tests[] = {358.66, 72.54, 20.67, 9.26}, steps[] = {5.69, 12.40, 5.09, 10.56};
        REQUIRE(page.comparisons.size() == 12);
        for (std::size_t n = 0; n < 6; ++n) {
            const EventCounts& e = runs[n].events;
            CHECK(page.comparisons[2 * n].ours == Approx(tests_by_hand(e) / rays_by_hand(e)).epsilon(1e-12));
            CHECK(page.comparisons[2 * n + 1].ours == Approx(double(e[RAYA_STEPS]) / rays_by_hand(e)).epsilon(1e-12));
            CHECK(page.comparisons[2 * n].paper.has_value() == (n < 4));
            CHECK(page.comparisons[2 * n + 1].paper.has_value() == (n < 4));
            if (n >= 4) continue;
            CHECK(page.comparisons[2 * n].paper == tests[n]);
            CHECK(page.comparisons[2 * n + 1].paper == steps[n]);
        }
        CHECK(says(page, fmt::format("Tests a ray are {:.2f} (balls 46x46x3), ",
                                     tests_by_hand(runs[0].events) / rays_by_hand(runs[0].events) / 358.66)));
        CHECK(says(page, "; theirs to 0.20 and 2.18."));  // balls
        CHECK(says(page, "; theirs to 0.45 and 2.07."));  // lattice
    }
}

TEST_CASE("havran says so where nothing was published", "[study]") {
    std::mt19937 random(53);
    const StudyPage page = havran_page(129, {random_run(random, "mine.nff", {20, 20, 20})});
    check_page(page);
    CHECK(says(page, "Tests a ray: none were published for these grids."));
}

// The published grids cut balls along z into the fewest: its box is thin there.
TEST_CASE("balls is thin along z, lattice a cube", "[study]") {
    const Scene balls = generate_balls(4), lattice = generate_lattice(12);
    double high = 0, lattice_low = 1, lattice_high = 0;
    for (const Sphere& s : balls.spheres) high = std::max(high, s.centre.z + s.radius);
    CHECK(high + 0.5 < 24.0 / 10);
    for (const Sphere& s : lattice.spheres) {
        lattice_low = std::min({lattice_low, s.centre.x - s.radius, s.centre.z - s.radius});
        lattice_high = std::max({lattice_high, s.centre.x + s.radius, s.centre.z + s.radius});
    }
    CHECK(lattice_high - lattice_low == Approx(1 + 1.0 / 24));
}

TEST_CASE("havran's rays are SPD's in kind, and the same in both grids of a scene", "[study][slow]") {
    Session session(choose_device(""));
    Laboratory lab(session, 25);
    const StudyPage page = study_havran(lab, {});
    check_page(page);
    REQUIRE(page.table("havran").rows.size() == 4);
    const auto at = [&](std::size_t row, const char* label) { return page.value("havran", row, label); };
    for (std::size_t n = 0; n < 4; ++n) {
        CAPTURE(n);
        CHECK(at(n, "eye rays") == 25 * 25);
        CHECK(at(n, "refracted") == 0);  // nothing is transparent
        for (const char* same : {"eye rays", "reflected", "shadow rays"}) CHECK(at(n, same) == at(n ^ 1, same));
        CHECK(at(n, "walks") <= at(n, "eye rays") + at(n, "reflected") + at(n, "shadow rays"));
        CHECK(at(n, "steps") >= at(n, "walks"));
    }
    for (const std::size_t coarse : {0u, 2u}) {
        CHECK(at(coarse, "tests") > at(coarse + 1, "tests"));
        CHECK(at(coarse, "steps") < at(coarse + 1, "steps"));
    }
    // Balls as SPD publishes it, at 513 x 513.
    CHECK(at(0, "reflected") / (25 * 25) == Approx(175095.0 / 263169).epsilon(0.1));
    CHECK(at(0, "shadow rays") / (25 * 25) == Approx(954368.0 / 263169).epsilon(0.1));
}

}  // namespace
}  // namespace raya
