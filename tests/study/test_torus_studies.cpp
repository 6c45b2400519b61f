// The studies of the torus machine on small machines: shapes of their pages, and what must hold between their figures.
#include "host/cl/device.hpp"
#include "host/scene/generate.hpp"
#include "host/study/objects_runs.hpp"
#include "host/study/rows.hpp"
#include "host/study/studies.hpp"
#include "host/study/torus_runs.hpp"
#include "tests/study/study_cases.hpp"

namespace raya {
namespace {

constexpr std::uint32_t kSize = 17;

void check_bounds(const StudyTable& table, std::size_t row) {
    const double overlapped = table.at(row, "overlapped").number();
    CHECK(overlapped > 0);
    CHECK(overlapped <= table.at(row, "stepwise").number() * (1 + 1e-12));
}

std::vector<LabelledScene> two_scenes() { return {{"random-20", generate_random(20, 1)}, even_scene(64)}; }

TEST_CASE("nodes: one node is the measure, and the same voxels make the same work", "[study]") {
    Session session(choose_device(""));
    const StudyPage page = nodes_page(session, {two_scenes().front()}, {.size = kSize, .most = 8, .sides = 2});
    check_page(page);
    const StudyTable& table = page.table("nodes");
    REQUIRE(table.rows.size() == 3 * 4);
    const auto at = [&](std::size_t row, const char* label) { return table.at(row, label).number(); };
    for (std::size_t i = 0; i < table.rows.size(); ++i) {
        CAPTURE(i);
        const double nodes = at(i, "nodes"), speedup = at(i, "speed-up, overlapped");
        const std::size_t first = i / 4 * 4;
        check_bounds(table, i);
        CHECK(nodes == 1 << i % 4);
        CHECK(at(i, "efficiency, overlapped") == Approx(speedup / nodes).epsilon(1e-12));
        CHECK(speedup == at(first, "overlapped") / at(i, "overlapped"));
        CHECK((at(i, "rays thrown away") == 0) == (nodes == 1));
        if (nodes == 1) {
            for (const char* one : {"speed-up, overlapped", "speed-up, stepwise"}) CHECK(at(i, one) == 1);
            for (const char* zero : {"hops a packet", "u", "busiest link"}) CHECK(at(i, zero) == 0);
            CHECK(table.at(i, "waits for").text() == "its one node");
        }
        if (table.at(i, "voxels").text() != "2x2x2") continue;
        CHECK(at(i, "tests a ray") == at(first, "tests a ray"));
        CHECK(at(i, "steps a ray") == at(first, "steps a ray"));
        CHECK(speedup <= nodes * (1 + 1e-12));
    }
    for (std::size_t column = 3; column < table.columns.size(); ++column)  // 2 x 2 x 2 nodes, rendered once
        CHECK((column == 6 || column == 7 || column == 8 || table.rows[3][column] == table.rows[11][column]));
}

TEST_CASE("nodes: a series ends before it has too many launches", "[study]") {
    Session session(choose_device(""));
    const StudyPage page =
        nodes_page(session, {even_scene(8)}, {.size = kSize, .most = 8, .sides = 2, .most_launches = 1});
    check_page(page);
    CHECK(page.table("nodes").rows.size() == 3);
}

TEST_CASE("inject: both ways make the same packets, and the root has its share", "[study]") {
    Session session(choose_device(""));
    const StudyPage page = inject_page(session, two_scenes().front(), kSize, 8);
    check_page(page);
    const StudyTable& table = page.table("inject");
    REQUIRE(table.rows.size() == 2 * 4);
    const auto at = [&](std::size_t row, const char* label) { return table.at(row, label).number(); };
    for (std::size_t i = 0; i < table.rows.size(); ++i) {
        CAPTURE(i);
        check_bounds(table, i);
        CHECK(table.at(i, "inject").text() == (i % 2 ? "all" : "root"));
        CHECK(at(i, "packets") == at(0, "packets"));
        CHECK((at(i, "rays thrown away") == 0) == (i % 2 == 0 || at(i, "nodes") == 1));
        const double share = at(i, "root / overlapped");
        CHECK((share > 0 && share <= 100));
        const double root = std::max(at(i, "the root's processor"), at(i, "the root's busiest link"));
        CHECK(share == Approx(100 * root / at(i, "overlapped")).epsilon(1e-12));
        if (at(i, "nodes") == 1) CHECK(share == 100);
    }
    // The root sends what it does not keep, the way home is the same.
    for (const char* more : {"hops a packet", "the root's processor"}) CHECK(at(6, more) > at(7, more));
}

TEST_CASE("hybrid: as many groups as nodes send nothing and hold everything", "[study]") {
    Session session(choose_device(""));
    const StudyPage page = hybrid_page(session, two_scenes(), kSize, 4);
    check_page(page);
    const StudyTable& memory = page.table("hybrid-memory");
    REQUIRE(page.table("hybrid").rows.size() == 2 * 2 * 3);
    REQUIRE(memory.rows.size() == 2 * 2 * 3);
    const auto at = [&](std::size_t row, const char* label) { return page.value("hybrid", row, label); };
    const auto bytes = [&](std::size_t row, const char* label) { return memory.at(row, label).number(); };
    for (std::size_t i = 0; i < memory.rows.size(); ++i) {
        CAPTURE(i);
        check_bounds(page.table("hybrid"), i);
        CHECK(at(i, "groups") * at(i, "nodes a group") == 4);
        CHECK(at(i, "speed-up, overlapped") <= 4 * (1 + 1e-12));
        CHECK(at(i, "tests a ray") == at(i / 3 * 3, "tests a ray"));
        const double shortest = bytes(i, "with the shortest buffers");
        CHECK(bytes(i, "its part of the scene") < shortest);
        CHECK(shortest <= bytes(i, "with the study's"));
        CHECK((memory.at(i, "fits 32 KB").text() == "yes") == (shortest <= 32768));
        if (i % 3 > 0) continue;
        // One node a group: nothing is sent, balance alone is lost, and the whole scene lies in every node.
        CHECK(at(i + 2, "hops a packet") == 0);
        CHECK(at(i + 2, "rays thrown away") == 0);
        CHECK(at(i, "rays thrown away") > 0);
        CHECK(at(i + 2, "most messages") == 0);
        CHECK(at(i + 2, "speed-up, overlapped") == Approx(4 / (1 + at(i + 2, "u over all nodes"))).epsilon(1e-12));
        CHECK(bytes(i + 2, "its part of the scene") > bytes(i, "its part of the scene"));
    }
}

TEST_CASE("objects: copies, tests, returns and the rays that end in the first voxel", "[study]") {
    Session session(choose_device(""));
    const StudyPage page = objects_page(run_objects(session, {64, 192}, kSize, 2), kSize);
    check_page(page);
    const StudyTable& table = page.table("objects");
    const auto at = [&](std::size_t row, const char* label) { return table.at(row, label).number(); };
    const auto primary = [&](std::size_t row, const char* label) { return page.value("objects-primary", row, label); };
    REQUIRE(table.rows.size() == 2 * 2 * 3);
    REQUIRE(page.table("objects-primary").rows.size() == 2 * 2);
    for (std::size_t i = 0; i < table.rows.size(); ++i) {
        CAPTURE(i);
        const bool paper = table.at(i, "protocol").text() == kPaperProtocol;
        check_bounds(table, i);
        CHECK(paper == (i / 3 % 2 == 0));
        CHECK(at(i, "busiest node computes") <= at(i, "overlapped"));
        CHECK(at(i, "scenes") == (i % 3 ? 2 : 1));
        CHECK((table.at(i, "overlapped +-") == Cell("-")) == (i % 3 == 0));
        // A return for each ray, and none of them made twice; or one for each term.
        CHECK((at(i, "returns") == kSize * kSize) == paper);
        CHECK((at(i, "rays thrown away") == 0) == paper);
    }
    CHECK(at(10, "copies") > at(11, "copies"));
    for (std::size_t i = 0; i < 4; ++i) {
        for (const char* share : {"hit", "end in the first voxel"}) {
            CHECK(primary(i, share) > 0);
            CHECK(primary(i, share) < 100);
        }
        CHECK(primary(i, "voxels a ray in the box") > 1);
        // A ray that does not end in its first voxel enters a second one.
        CHECK(primary(i, "voxels a ray in the box") >= 2 - primary(i, "end in the first voxel") / 100 - 1e-12);
    }
    const StudyTable& growth = page.table("objects-growth");
    REQUIRE(growth.rows.size() == 2 * 2);
    const auto grown = [&](std::size_t row, const char* label) { return growth.at(row, label).number(); };
    for (const std::size_t even : {0, 2})  // of one scene each: the factors are the whole
        CHECK(grown(even, "objects / time") ==
              Approx(grown(even, "fewer voxels a ray") * grown(even, "tests a voxel grow less") *
                     grown(even, "fixed costs") * grown(even, "one node's bound"))
                  .epsilon(1e-12));
    for (std::size_t i = 0; i < 4; ++i) CHECK(grown(i, "objects") == 3);
}

// A render of so many ms, overlapped, in which as many tests were made in as many voxels; all of it work.
TorusRun made_up_run(double ms, double stepwise_ms, double asynchronous_ms, std::uint64_t tests, std::uint64_t steps) {
    TorusRun run;
    run.time.overlapped_ms = ms;
    run.time.stepwise_ms = stepwise_ms;
    run.time.asynchronous = AsynchronousTime{.finish_ms = asynchronous_ms};
    run.result.load = load_of({static_cast<std::uint64_t>(ms * 25'000)});
    run.result.events[RAYA_PRIMARY] = 100;
    run.result.events[RAYA_SPHERE_TESTS] = tests;
    run.result.events[RAYA_STEPS] = steps;
    return run;
}

struct MadeUp {
    double slower = 1.2, slower_stepwise = 1.2, slower_asynchronous = 1.2;  // random over even
    double time = 10;                                                       // of ten times as many objects
    std::uint64_t steps = 1000;                                             // then; 1000 before
    double scatter = 0.001;                                                 // of random scenes
    std::optional<double> few_asynchronous{};                               // of the fewest objects, where it differs
};

StudyPage made_up_objects(const MadeUp& m) {
    ObjectsRuns all;
    for (const int objects : {64, 640})
        for (const std::string protocol : {kPaperProtocol, kOwnProtocol})
            for (const std::string kind : {kEven, kRandom, kWithin}) {
                const double ms = objects == 64 ? 10 : 10 * m.time;
                const auto times = [&](double slower) { return kind == kEven ? ms : ms * slower; };
                const std::uint64_t steps = objects == 64 ? 1000 : m.steps;
                const double slower_asynchronous =
                    objects == 64 ? m.few_asynchronous.value_or(m.slower_asynchronous) : m.slower_asynchronous;
                const auto run = [&](double lot) {
                    return made_up_run(times(m.slower) * lot, 2 * times(m.slower_stepwise) * lot,
                                       1.5 * times(slower_asynchronous) * lot, steps * std::uint64_t(objects) / 64,
                                       steps);
                };
                all.rows.push_back({objects, kind, protocol, {run(1)}});
                const double scatter = objects == 64 ? m.scatter : -m.scatter;  // growth scatters too
                if (kind != kEven) all.rows.back().runs = {run(1 - scatter), run(1), run(1 + scatter)};
            }
    for (const int objects : {64, 640})
        for (const std::string kind : {kEven, kRandom}) all.primary.push_back({objects, kind, {0.5}, {0.5}, {1.5}});
    all.words = {{64, 48, 20, 40}};
    return objects_page(all, kSize);
}

TEST_CASE("objects: verdicts follow from the figures", "[study]") {
    using enum ClaimVerdict;
    const auto verdicts = [](const MadeUp& m) {
        const StudyPage page = made_up_objects(m);
        check_page(page);
        return each(page.claims, &Claim::verdict);
    };
    // Random: slower without supersteps, whatever the bounds say; not; neither, by its interval.
    CHECK(verdicts({})[0] == kReproduced);
    CHECK(verdicts({.slower = 1, .slower_stepwise = 1})[0] == kReproduced);
    CHECK(verdicts({.slower_asynchronous = 1})[0] == kNotReproduced);
    CHECK(verdicts({.slower_asynchronous = 1.05, .scatter = 0.1})[0] == kCannotTell);
    CHECK(verdicts({.slower_asynchronous = 1, .few_asynchronous = 1.2})[0] == kCannotTell);  // some are, some are not
    // Growth: as the objects; less, since rays go through fewer voxels; less for another reason.
    CHECK(verdicts({})[1] == kNotReproduced);
    CHECK(verdicts({.time = 9, .scatter = 0.1})[1] == kCannotTell);
    const auto deep = verdicts({.time = 2, .steps = 200}), other = verdicts({.time = 2, .steps = 1000});
    CHECK(deep[1] == kReproduced);
    CHECK(deep[2] == kReproduced);
    CHECK(other[1] == kReproduced);
    CHECK(other[2] == kNotReproduced);
}

TEST_CASE("the torus's studies are on the list", "[study]") {
    for (const char* name : {"objects", "nodes", "inject", "hybrid"})
        CHECK(std::ranges::count(studies(), name, &Study::name) == 1);
}

}  // namespace
}  // namespace raya
