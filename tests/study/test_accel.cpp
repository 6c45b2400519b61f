// The study of accelerators: what it concludes from made-up figures, and counts that hold of any scene.
#include <fmt/core.h>
#include <sys/stat.h>

#include "host/base/whole_file.hpp"
#include "host/scene/generate.hpp"
#include "host/study/statistics.hpp"
#include "host/study/studies.hpp"
#include "kernels/shared/bvh.h"
#include "tests/base/scratch_folder.hpp"
#include "tests/study/study_cases.hpp"

namespace raya {
namespace {

constexpr std::uint64_t kRays = 1'000'000;

// A million rays, so that milliseconds are nanoseconds a ray.
AccelRun made_up(const std::string& series, std::uint64_t objects, std::uint64_t seed, const std::string& way,
                 double ms, std::uint64_t tests_a_ray = 1) {
    AccelRun run;
    run.series = series;
    run.group = fmt::format("{} {}", series, objects);
    run.seed = seed;
    run.way = way;
    run.objects = objects;
    run.rays = kRays;
    run.scene_words = 10 * objects;
    if (way == kNoAccel || way == kGridWay || way == kBvhWay) {
        run.events[RAYA_PRIMARY] = kRays;
        run.events[RAYA_SPHERE_TESTS] = tests_a_ray * kRays;
    }
    if (way == kGridWay || way == kBvhWay) {
        run.accel_words = 5 * objects;
        run.build_ms = 2 * ms;
        run.events[RAYA_STEPS] = 3 * kRays;
    }
    run.time = {ms, 1.5 * ms, 3};
    return run;
}

// Balls of 1, 10, 100, 1000, 10,000 objects: `none` takes as long as they are many, a grid the square root, a tree 8.
AccelRuns made_up_balls() {
    AccelRuns all;
    for (const std::uint64_t n : {1, 10, 100, 1'000, 10'000}) {
        const auto objects = static_cast<double>(n);
        all.runs.push_back(made_up("balls", n, 0, kNoAccel, objects, n));
        all.runs.push_back(made_up("balls", n, 0, kGridWay, 2 * std::sqrt(objects), 2));
        all.runs.push_back(made_up("balls", n, 0, kBvhWay, 8, 4));
    }
    return all;
}

const AccelSettings kSmall{.side = 17, .rounds = 1};

TEST_CASE("accel tells from how many objects on a way pays, and how time grows", "[study]") {
    const StudyPage page = accel_page({}, made_up_balls());
    check_page(page);
    CHECK(
        says(page,
             "balls: against testing all objects, bvh pays from 10 objects on, grid pays from 10 objects on; at 10000 "
             "objects none takes 1250 times as long as bvh, 50.00 times as long as grid."));
    CHECK(
        says(page,
             "bvh is faster than grid in 3 of 5, slower in 2; time of grid over bvh: 0.25 (balls 1), 0.79 (balls 10), "
             "2.50 (balls 100), 7.91 (balls 1000), 25.00 (balls 10000)."));
    CHECK(
        says(page, "to the power of 1.00 (none, 100 to 10000 objects), 0.50 (grid, 100 to 10000 objects), 0.00 (bvh"));
    CHECK(says(page, "ten times the objects take 10.00 (none), 3.16 (grid), 1.00 (bvh) times as long."));
    CHECK(says(page,
               "balls 10000: grid takes 20.0 bytes an object and is made in 400 ms, the time of 2 renders, bvh takes "
               "20.0 bytes an object and is made in 16 ms, the time of 2 renders; the scene itself takes 40.0 bytes an "
               "object."));
    CHECK(says(page, "no program embree_peer lies beside raya"));
    CHECK_FALSE(says(page, "Not rendered"));
    REQUIRE(page.table("accel").rows.size() == 15);
    CHECK(page.value("accel", 14, "a ray") == 8);
    CHECK(page.value("accel", 14, "median") == 12);
    CHECK(page.value("accel", 14, "memory") == 4 * 15 * 10'000 / 1024.0);
    CHECK(page.table("accel").at(14, "best +-").text() == "-");  // of one scene
    CHECK(page.table("accel").at(12, "build").text() == "-");    // of no accelerator
    CHECK(page.value("accel-growth", 0, "tests") == Approx(1));
    CHECK(page.value("accel-growth", 1, "tests") == Approx(0).margin(1e-12));
    REQUIRE(page.plots.size() == 3);
    CHECK(page.plots[0].series.size() == 3);
    CHECK(page.plots[0].series[0].y == std::vector<double>{1, 10, 100, 1'000, 10'000});
}

TEST_CASE("accel's ensembles have means and intervals, and a way is called faster where the whole interval says so",
          "[study]") {
    AccelRuns all;
    const double none[] = {9, 12, 15}, bvh[] = {10, 10, 10};
    for (const std::uint64_t objects : {1'000u, 10'000u})
        for (std::uint64_t seed = 1; seed <= 3; ++seed) {
            const double factor = objects == 1'000 ? 1 : 10;
            all.runs.push_back(made_up("random", objects, seed, kNoAccel, factor * none[seed - 1]));
            all.runs.push_back(made_up("random", objects, seed, kGridWay, 20));
            all.runs.push_back(made_up("random", objects, seed, kBvhWay, bvh[seed - 1]));
        }
    const StudyPage page = accel_page({}, all);
    check_page(page);
    const double half = estimate_of({9, 12, 15}).half_width;
    CHECK(half == Approx(7.4524).epsilon(1e-4));
    REQUIRE(page.table("accel").rows.size() == 6);
    CHECK(page.value("accel", 0, "scenes") == 3);
    CHECK(page.value("accel", 0, "best") == 12);
    CHECK(page.value("accel", 0, "best +-") == Approx(half));
    CHECK(page.value("accel", 2, "best +-") == 0);
    CHECK(page.value("accel", 0, "tests +-") == 0);
    // Of 1000 objects, 1.2 +- 0.75 times as long does not say who is faster.
    CHECK(says(page,
               "random: against testing all objects, bvh pays from 10000 objects on, grid pays from 10000 objects "
               "on; at 10000 objects none takes 12.00 +- 7.45 times as long as bvh, 6.00 +- 3.73 times"));
    CHECK(says(page, "to the power of 1.00 +- 0.00 (none, 1000 to 10000 objects)"));
    CHECK(page.table("accel-scenes").rows.size() == 18);
}

TEST_CASE("of a single scene the turns tell whether a way is faster", "[study]") {
    AccelRuns all;
    for (const char* way : {kNoAccel, kGridWay, kBvhWay}) all.runs.push_back(made_up("balls", 100, 0, way, 10));
    all.runs[0].turns_ms = {30, 33, 36, 100};  // a disturbance in a turn that the others do not have
    all.runs[1].turns_ms = {10, 12, 9};
    all.runs[2].turns_ms = {10, 11, 12};
    const StudyPage page = accel_page({}, all);
    check_page(page);
    CHECK(says(page, "none takes 3.00 +- 0.00 times as long as bvh"));
    CHECK(says(page,
               "bvh is faster than grid in 0 of 1, slower in 0, not told apart in 1; time of grid over bvh: "
               "0.95 +- 0.44 (balls 100)."));
    all.runs[1].turns_ms = {9};
    CHECK(says(accel_page({}, all), "slower in 1; time of grid over bvh: 0.90 (balls 100)."));  // a turn alone
}

TEST_CASE("accel says what was left out, and pays nothing where nothing pays", "[study]") {
    AccelRuns all;
    for (const std::uint64_t objects : {100u, 1'000u}) {
        all.runs.push_back(made_up("balls", objects, 0, kNoAccel, 5));
        all.runs.push_back(made_up("balls", objects, 0, kGridWay, 6));
        all.runs.push_back(made_up("balls", objects, 0, kBvhWay, 4 + 2e-3 * double(objects)));
    }
    all.runs.push_back(made_up("balls", 10'000, 0, kGridWay, 7));
    all.runs.push_back(made_up("balls", 10'000, 0, kBvhWay, 7));
    all.left_out = {{"balls 10000", 10'000, 123.4}};
    const StudyPage page = accel_page({}, all);
    check_page(page);
    CHECK(says(page, "bvh is not shown to pay at 1000 objects, grid is not shown to pay at 1000 objects"));
    CHECK(says(page, "Not rendered without an accelerator: balls 10000 (10000 objects, about 123 s)."));
    CHECK(says(page, "bvh is faster than grid in 1 of 3, slower in 0, not told apart in 2"));
    REQUIRE(page.plots[0].series.size() == 3);
    CHECK(page.plots[0].series[0].x == std::vector<double>{100, 1'000});
    CHECK(page.plots[0].series[2].x == std::vector<double>{100, 1'000, 10'000});
    AccelRuns none_at_all;
    none_at_all.runs = {all.runs[6], all.runs[7]};
    const StudyPage bare = accel_page({}, none_at_all);
    check_page(bare);
    CHECK(says(bare, "balls: nothing was rendered without an accelerator."));
    CHECK_THROWS_AS(bare.table("accel-growth"), std::out_of_range);  // of one number of objects
}

TEST_CASE("accel's ratio to Embree is of the same rays alone", "[study]") {
    AccelRuns all = made_up_balls();
    all.has_peer = true;
    for (const std::uint64_t objects : {1, 10, 100}) all.runs.push_back(made_up("balls", objects, 0, kEmbreeWay, 12));
    all.runs[15].rays = kRays + 1'000;  // one in a thousand
    all.runs[16].rays = kRays - 1'100;
    all.peer_failures = {"balls 1000: out of ink"};
    const StudyPage page = accel_page({}, all);
    check_page(page);
    CHECK(says(page,
               "bvh is faster than Embree in 2 of 2, slower in 0; time of Embree over bvh: 1.50 (balls 1), 1.50 "
               "(balls 100)."));
    CHECK(says(page, "Embree traces more or fewer rays by over one in a thousand, and has no ratio, in balls 10."));
    CHECK(says(page, "Embree was not measured in balls 1000: out of ink."));
    CHECK_FALSE(says(page, "embree_peer lies beside"));
    CHECK(page.plots[0].series.size() == 4);
    CHECK(page.table("accel").at(15, "tests a ray").text() == "-");
    CHECK(page.table("accel").at(15, "memory").text() == "-");
}

TEST_CASE("each way counts the same rays and fewer tests than all objects", "[study][slow]") {
    Session session(choose_device(""));
    AccelBench bench(session, kSmall, {});
    bench.measure({"balls", "balls 1", 0, [] { return generate_balls(1); }});
    bench.measure({"balls", "balls 2", 0, [] { return generate_balls(2); }});
    for (const std::uint64_t seed : {1u, 2u})
        bench.measure({"random", "random 40", seed, [=] { return generate_random(40, seed); }});
    const AccelRuns& all = bench.runs();
    const StudyPage page = accel_page(kSmall, all);
    check_page(page);
    REQUIRE(all.runs.size() == 12);
    CHECK(all.left_out.empty());
    CHECK_FALSE(all.has_peer);
    for (std::size_t i = 0; i < all.runs.size(); i += 3) {
        const AccelRun &none = all.runs[i], &grid = all.runs[i + 1], &bvh = all.runs[i + 2];
        CAPTURE(none.group, none.seed);
        CHECK(none.way == kNoAccel);
        CHECK(grid.way == kGridWay);
        CHECK(bvh.way == kBvhWay);
        CHECK(none.rays >= 17 * 17);
        CHECK(none.tests_a_ray() <= double(none.objects));
        CHECK(none.tests_a_ray() > 0.5 * double(none.objects));  // a shadow ray may end before the last object
        CHECK(none.steps_a_ray() == 0);
        CHECK(none.accel_words == 0);
        CHECK(none.build_ms == 0);
        for (const AccelRun* way : {&grid, &bvh}) {
            CHECK(way->rays == none.rays);
            CHECK(way->objects == none.objects);
            if (way == &bvh && none.objects <= RAYA_BVH_WIDTH + 1) {  // one leaf, and the ground apart
                CHECK(way->tests_a_ray() <= none.tests_a_ray());
                CHECK(way->steps_a_ray() == 0);
            } else {
                CHECK(way->tests_a_ray() < none.tests_a_ray());
                CHECK(way->steps_a_ray() > 0);
            }
            CHECK(way->accel_words > 0);
            CHECK(way->scene_words >= none.scene_words);
            CHECK(way->scene_words <= none.scene_words + 3);  // a tree begins at a row of four words
            CHECK(way->build_ms > 0);
            CHECK(way->time.runs == 1);
            CHECK(way->time.min_ms > 0);
        }
    }
    REQUIRE(page.table("accel").rows.size() == 9);
    CHECK(page.value("accel", 8, "scenes") == 2);
}

TEST_CASE("what could not be borne is left out, and Embree is asked where it is", "[study]") {
    const ScratchFolder folder;
    const std::string peer = folder / "embree_peer";
    const auto answers = [&](const std::string& body) {
        write_whole_file(peer, "#!/bin/sh\n" + body + "\n");
        ::chmod(peer.c_str(), 0755);
    };
    Session session(choose_device(""));
    AccelSettings settings = kSmall;
    settings.bearable_s = 0;
    AccelBench bench(session, settings, peer);
    const AccelScene scene{"named", "small", 0, [] { return generate_balls(1); }};
    answers("echo 'single 500 0.5 0.25'; echo 'sixteen 501 0.125 0.5'; echo 'build 0.75'");
    bench.measure(scene);
    answers("echo 'no such shape' >&2; exit 2");
    bench.measure(scene);
    const AccelRuns& all = bench.runs();
    REQUIRE(all.runs.size() == 5);
    const AccelRun& embree = all.runs[2];
    CHECK(embree.way == kEmbreeWay);
    CHECK(embree.rays == 501);
    CHECK(embree.time.min_ms == 125);  // of the faster of its ways
    CHECK(embree.time.median_ms == 312.5);
    CHECK(embree.build_ms == 750);
    CHECK(all.peer_failures == std::vector<std::string>{"small: no such shape"});
    REQUIRE(all.left_out.size() == 2);
    CHECK(all.left_out[0].objects == 11);
    CHECK(all.left_out[0].predicted_s > 0);
    CHECK(all.runs[0].way == kGridWay);
}

TEST_CASE("accel takes the scenes that were named in place of its own", "[study]") {
    Session session(choose_device(""));
    Laboratory lab(session, 17);
    const StudyPage page = study_accel(lab, {{"a.nff", generate_balls(1)}, {"b.nff", generate_random(12, 3)}});
    check_page(page);
    CHECK(says(page, "Without an accelerator the scenes that were named take "));
    CHECK(page.plots[0].name == "accel-named");
    CHECK(page.plots[0].series[0].style == PlotStyle::kPoints);
    CHECK(page.table("accel").at(0, "scene").text() == "a.nff");
    CHECK(page.table("accel").at(3, "scene").text() == "b.nff");
    CHECK_THROWS_AS(page.table("accel-growth"), std::out_of_range);
}

TEST_CASE("tiles divide the image", "[study]") {
    CHECK(tile_side(256) == 16);
    CHECK(tile_side(40) == 8);
    CHECK(tile_side(17) == 1);
}

}  // namespace
}  // namespace raya
