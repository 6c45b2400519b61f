// The study of a turn: its frames are those of raya render --frames, its choices are blind to what judges them.
#include <fmt/core.h>

#include <catch2/catch.hpp>

#include "host/ring/schedule.hpp"
#include "host/scene/turn.hpp"
#include "host/study/arrays.hpp"
#include "host/study/studies.hpp"
#include "tests/study/study_cases.hpp"

namespace raya {
namespace {

constexpr std::uint32_t kSize = 24;

std::vector<double> column(const StudyTable& table, const std::string& label) {
    std::vector<double> all;
    for (std::size_t row = 0; row < table.rows.size(); ++row) all.push_back(table.at(row, label).number());
    return all;
}

TEST_CASE("a turn's table has u of each frame, by loads that are summed by hand", "[study]") {
    Session session(choose_device(""));
    Laboratory lab(session, kSize);
    const LabelledScene scene = embedded_scene("mirrors");
    const StudyPage page = study_turn(lab, {scene});
    check_page(page);
    const StudyTable& table = page.table("turn");
    REQUIRE(table.rows.size() == 24);
    const std::uint32_t root = root_offset(kSize);
    std::vector<std::vector<double>> u(24, std::vector<double>(kSize));
    for (std::uint32_t frame = 0; frame < 24; ++frame) {
        CAPTURE(frame);
        LabelledScene seen = scene;
        seen.scene.view = turned(scene.scene.view, 15.0 * frame);
        const CostImage cost = lab.costs(seen, kSize).trace;
        for (std::uint32_t p = 0; p < kSize; ++p)
            u[frame][p] = plain_load(cost, kSize, [&](std::uint32_t row, std::uint32_t column) {
                              return sheared(row, column, p, kSize);
                          }).imbalance();
        const auto figure = [&](const std::string& label) { return table.at(frame, label).number(); };
        CHECK(figure("turned by") == 15.0 * frame);
        CHECK(figure("u, p = 0") == Approx(u[frame][0]).epsilon(1e-12));
        CHECK(figure(fmt::format("u, p = {}, root of P", root)) == Approx(u[frame][root]).epsilon(1e-12));
        CHECK(figure("its u") == Approx(*std::ranges::min_element(u[frame])).epsilon(1e-12));
        CHECK(u[frame][static_cast<std::size_t>(figure("best p of the frame"))] ==
              Approx(figure("its u")).epsilon(1e-12));
    }
    // The offset of the odd frames is the least of their means; that of frame 1 is the best there.
    std::size_t best = 0;
    std::vector<double> means(kSize);
    for (std::size_t p = 0; p < kSize; ++p) {
        for (std::size_t frame = 0; frame < 24; frame += 2) means[p] += u[frame][p];
        if (means[p] < means[best]) best = p;
    }
    CHECK(column(table, fmt::format("u, p = {}, best of odd frames", best)).front() == Approx(u[0][best]));
    const auto first = static_cast<std::size_t>(std::ranges::min_element(u[0]) - u[0].begin());
    CHECK(column(table, fmt::format("u, p = {}, best of frame 1", first)).back() == Approx(u[23][first]));
}

TEST_CASE("a turn's verdict is the count of frames; no frame beats its own best", "[study]") {
    Session session(choose_device(""));
    Laboratory lab(session, kSize);
    const StudyPage page = study_turn(lab, {});
    check_page(page);
    REQUIRE(page.claims.size() == 2);
    CHECK(page.plots.size() == 2);
    for (const char* name : {"turn-starts", "turn-2-starts"}) {
        const StudyTable& table = page.table(name);
        CHECK(table.rows.size() == 8);
        const std::vector<double> own = column(table, "u, each frame's best p"), half = column(table, "u of that"),
                                  first = column(table, "its u");
        for (std::size_t i = 0; i < own.size(); ++i) {
            CHECK(own[i] <= half[i]);
            CHECK(own[i] <= first[i]);
        }
    }
}

}  // namespace
}  // namespace raya
