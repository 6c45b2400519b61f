// The studies of the torus machine on small machines: shapes of their pages, and what must hold between their figures.
#include <fmt/format.h>

#include <chrono>

#include "host/cl/device.hpp"
#include "host/scene/generate.hpp"
#include "host/study/hybrid.hpp"
#include "host/study/inject.hpp"
#include "host/study/nodes.hpp"
#include "host/study/objects.hpp"
#include "host/study/studies.hpp"
#include "host/study/torus_runs.hpp"
#include "tests/study/page_shape.hpp"

namespace raya {
namespace {

constexpr std::uint32_t kSize = 17;

// A cell of a row by its column's name.
const Cell& cell(const StudyTable& table, const std::vector<Cell>& row, const std::string& column) {
    const auto found = std::find(table.columns.begin(), table.columns.end(), column);
    CAPTURE(column);
    REQUIRE(found != table.columns.end());
    return row[static_cast<std::size_t>(found - table.columns.begin())];
}

double figure(const StudyTable& table, const std::vector<Cell>& row, const std::string& column) {
    return cell_number(cell(table, row, column));
}

std::string word(const StudyTable& table, const std::vector<Cell>& row, const std::string& column) {
    return std::get<std::string>(cell(table, row, column));
}

void check_findings(const StudyPage& page) {
    for (const std::string& finding : page.findings) {
        CAPTURE(finding);
        CHECK(finding.find("nan") == std::string::npos);
        CHECK(finding.find("inf") == std::string::npos);
        CHECK(finding.back() == '.');
    }
}

void check_bounds(const StudyTable& table, const std::vector<Cell>& row) {
    CHECK(figure(table, row, "overlapped (ms)") > 0);
    CHECK(figure(table, row, "overlapped (ms)") <= figure(table, row, "stepwise (ms)") * (1 + 1e-12));
}

std::vector<LabelledScene> two_scenes() { return {{"random-20", generate_random(20, 1)}, even_scene(64)}; }

TEST_CASE("nodes: one node is the measure, and the same voxels make the same work", "[study]") {
    Session session(choose_device(""));
    const StudyPage page = nodes_page(session, {two_scenes().front()}, {.size = kSize, .most = 8, .sides = 2});
    check_shape(page);
    check_findings(page);
    const StudyTable& table = table_of(page, "nodes");
    REQUIRE(table.rows.size() == 3 * 4);
    for (std::size_t i = 0; i < table.rows.size(); ++i) {
        CAPTURE(i);
        const auto& row = table.rows[i];
        const double nodes = figure(table, row, "nodes");
        const auto& first = table.rows[i / 4 * 4];
        check_bounds(table, row);
        CHECK(nodes == 1 << i % 4);
        CHECK(figure(table, row, "efficiency, overlapped") ==
              Approx(figure(table, row, "speed-up, overlapped") / nodes).epsilon(1e-12));
        CHECK(figure(table, row, "speed-up, overlapped") ==
              figure(table, first, "overlapped (ms)") / figure(table, row, "overlapped (ms)"));
        if (nodes == 1) {
            CHECK(figure(table, row, "speed-up, overlapped") == 1);
            CHECK(figure(table, row, "speed-up, stepwise") == 1);
            CHECK(figure(table, row, "hops a packet") == 0);
            CHECK(figure(table, row, "u") == 0);
            CHECK(figure(table, row, "busiest link (bytes)") == 0);
            CHECK(word(table, row, "waits for") == "its one node");
        }
        if (word(table, row, "voxels") != "2x2x2") continue;
        CHECK(figure(table, row, "tests a ray") == figure(table, first, "tests a ray"));
        CHECK(figure(table, row, "steps a ray") == figure(table, first, "steps a ray"));
        CHECK(figure(table, row, "speed-up, overlapped") <= nodes * (1 + 1e-12));
    }
    for (std::size_t column = 3; column < table.columns.size(); ++column)  // 2 x 2 x 2 nodes, rendered once
        CHECK((column == 6 || column == 7 || column == 8 || table.rows[3][column] == table.rows[11][column]));
}

TEST_CASE("nodes: a series ends before it has too many launches", "[study]") {
    Session session(choose_device(""));
    const StudyPage page =
        nodes_page(session, {even_scene(8)}, {.size = kSize, .most = 8, .sides = 2, .most_launches = 1});
    check_shape(page);
    check_findings(page);
    CHECK(table_of(page, "nodes").rows.size() == 3);
}

TEST_CASE("inject: both ways make the same packets, and the root has its share", "[study]") {
    Session session(choose_device(""));
    const StudyPage page = inject_page(session, two_scenes().front(), kSize, 8);
    check_shape(page);
    check_findings(page);
    const StudyTable& table = table_of(page, "inject");
    REQUIRE(table.rows.size() == 2 * 4);
    for (std::size_t i = 0; i < table.rows.size(); ++i) {
        const auto& row = table.rows[i];
        CAPTURE(i);
        check_bounds(table, row);
        CHECK(word(table, row, "inject") == (i % 2 ? "all" : "root"));
        CHECK(figure(table, row, "packets") == figure(table, table.rows[0], "packets"));
        const double share = figure(table, row, "root / overlapped (%)");
        CHECK((share > 0 && share <= 100));
        CHECK(share == Approx(100 *
                              std::max(figure(table, row, "the root's processor (ms)"),
                                       figure(table, row, "the root's busiest link (ms)")) /
                              figure(table, row, "overlapped (ms)"))
                           .epsilon(1e-12));
        if (figure(table, row, "nodes") == 1) CHECK(share == 100);
    }
    // The root sends what it does not keep, the way home is the same.
    CHECK(figure(table, table.rows[6], "hops a packet") > figure(table, table.rows[7], "hops a packet"));
    CHECK(figure(table, table.rows[6], "the root's processor (ms)") >
          figure(table, table.rows[7], "the root's processor (ms)"));
}

TEST_CASE("hybrid: as many groups as nodes send nothing and hold everything", "[study]") {
    Session session(choose_device(""));
    const StudyPage page = hybrid_page(session, two_scenes(), kSize, 4);
    check_shape(page);
    check_findings(page);
    const StudyTable &times = table_of(page, "hybrid"), &memory = table_of(page, "hybrid-memory");
    REQUIRE(times.rows.size() == 2 * 2 * 3);
    REQUIRE(memory.rows.size() == times.rows.size());
    for (std::size_t i = 0; i < times.rows.size(); ++i) {
        CAPTURE(i);
        const auto &row = times.rows[i], &bytes = memory.rows[i];
        check_bounds(times, row);
        CHECK(figure(times, row, "groups") * figure(times, row, "nodes a group") == 4);
        CHECK(figure(times, row, "speed-up, overlapped") <= 4 * (1 + 1e-12));
        CHECK(figure(times, row, "tests a ray") == figure(times, times.rows[i / 3 * 3], "tests a ray"));
        CHECK(figure(memory, bytes, "its part of the scene (bytes)") <
              figure(memory, bytes, "with the shortest buffers (bytes)"));
        CHECK(figure(memory, bytes, "with the shortest buffers (bytes)") <=
              figure(memory, bytes, "with the study's (bytes)"));
        CHECK((word(memory, bytes, "fits 32 KB") == "yes") ==
              (figure(memory, bytes, "with the shortest buffers (bytes)") <= 32768));
        if (i % 3 > 0) continue;
        // One node a group: nothing is sent, balance alone is lost, and the whole scene lies in every node.
        const auto& last = times.rows[i + 2];
        CHECK(figure(times, last, "hops a packet") == 0);
        CHECK(figure(times, last, "most messages (ms)") == 0);
        CHECK(figure(times, last, "speed-up, overlapped") ==
              Approx(4 / (1 + figure(times, last, "u over all nodes"))).epsilon(1e-12));
        CHECK(figure(memory, memory.rows[i + 2], "its part of the scene (bytes)") >
              figure(memory, bytes, "its part of the scene (bytes)"));
    }
}

TEST_CASE("objects: copies, tests and the rays that end in the first voxel", "[study]") {
    Session session(choose_device(""));
    const StudyPage page = objects_page(session, {192}, kSize, 1);
    check_shape(page);
    check_findings(page);
    const StudyTable &table = table_of(page, "objects"), &primary = table_of(page, "objects-primary");
    REQUIRE(table.rows.size() == 3);
    REQUIRE(primary.rows.size() == 2);
    for (std::size_t i = 0; i < table.rows.size(); ++i) {
        const auto& row = table.rows[i];
        CAPTURE(i);
        check_bounds(table, row);
        CHECK(figure(table, row, "objects a voxel") == figure(table, row, "objects") / 64);
        CHECK(figure(table, row, "busiest node computes (ms)") <= figure(table, row, "overlapped (ms)"));
    }
    CHECK(figure(table, table.rows[1], "copies") > figure(table, table.rows[2], "copies"));
    for (const auto& row : primary.rows) {
        for (const char* share : {"hit (% of primary rays)", "end in the first voxel (% of those in the box)"}) {
            CHECK(figure(primary, row, share) > 0);
            CHECK(figure(primary, row, share) < 100);
        }
        CHECK(figure(primary, row, "voxels a ray in the box") > 1);
        // A ray that does not end in its first voxel enters a second one.
        CHECK(figure(primary, row, "voxels a ray in the box") >=
              2 - figure(primary, row, "end in the first voxel (% of those in the box)") / 100 - 1e-12);
    }
}

TEST_CASE("the torus's studies are on the list", "[study]") {
    for (const char* name : {"objects", "nodes", "inject", "hybrid"})
        CHECK(std::count_if(studies().begin(), studies().end(),
                            [&](const Study& study) { return study.name == name; }) == 1);
}

}  // namespace
}  // namespace raya
