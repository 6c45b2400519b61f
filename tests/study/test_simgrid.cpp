// What simgrid_replay tells, and where SimGrid is installed, random histories by it and by raya.
#include <catch2/catch.hpp>
#include <cmath>
#include <filesystem>

#include "host/base/whole_file.hpp"
#include "host/study/peer.hpp"
#include "host/study/simgrid_peer.hpp"
#include "host/study/studies.hpp"
#include "host/study/torus_runs.hpp"
#include "host/torus/simgrid_files.hpp"
#include "tests/base/scratch_folder.hpp"
#include "tests/paths.h"
#include "tests/study/study_cases.hpp"
#include "tests/torus/random_history.hpp"

namespace raya {
namespace {

std::filesystem::path replay_program() { return std::filesystem::path(RAYA_PROGRAM).parent_path() / "simgrid_replay"; }

TEST_CASE("a time and a number of messages are read, anything else is refused", "[study]") {
    const SimgridAnswer answer = simgrid_answer("finish_ms 12.5\ndelivered 7\n");
    CHECK(answer.finish_ms == 12.5);
    CHECK(answer.delivered == 7);
    for (const char* printed : {"", "finish_ms\n", "finish_ms soon\ndelivered 7\n", "delivered 7\nfinish_ms 12.5\n"})
        CHECK_THROWS_AS(simgrid_answer(printed), PeerFailure);
    CHECK_THROWS_AS(ask_simgrid("/nowhere/simgrid_replay", make_torus({2, 1, 1}, Links::kTorus3d), {}, {}),
                    PeerFailure);
}

TEST_CASE("without simgrid_replay beside the program the study says what to install", "[study]") {
    const std::string lack = lack_of_simgrid();  // the test programs lie in a folder of their own
    CHECK_THAT(lack, Catch::Contains("tools/setup --studies") && Catch::Contains("libsimgrid-dev"));
}

TEST_CASE("simgrid_replay refuses what is no replay", "[study]") {
    if (!std::filesystem::exists(replay_program())) {
        WARN("SimGrid is not installed: tools/setup --studies");
        return;
    }
    const ScratchFolder folder;
    const std::string platform = folder / "platform.xml", replay = folder / "replay";
    write_whole_file(platform, simgrid_platform(make_torus({2, 1, 1}, Links::kTorus3d), {}));
    const std::string begin = "machine 2 4 2 19 2\nt 0 5 -\n";
    const auto peer = [&](const std::string& text) {
        write_whole_file(replay, text);
        return peer_output({replay_program().string(), platform, replay, "--log=root.thres:error"});
    };
    CHECK(simgrid_answer(peer(begin + "m 16 1 0 1\nt 1 5 0\n")).delivered == 1);
    for (const std::string& text :
         {std::string("machine 2 four\n"), std::string("m 16 1 0 1\n"), begin + "m 16 3\n", begin + "m 16 1 0 7\n",
          begin + "m 16 1 0\n", begin + "m 16 1 x\n", begin + "t 2 5 -\n", begin + "t 0 5 9\n", begin + "x\n"}) {
        CAPTURE(text);
        CHECK_THROWS_WITH(peer(text), Catch::StartsWith("simgrid_replay: "));
    }
}

// Times agree where no two messages ask for one place at the same instant; where they do, who comes first is each
// simulator's own choice, and the times of small histories are far from one another at times.
TEST_CASE("SimGrid delivers the same messages in about the same time", "[study]") {
    const std::filesystem::path program = replay_program();
    if (!std::filesystem::exists(program)) {
        WARN("SimGrid is not installed: tools/setup --studies");
        return;
    }
    constexpr std::uint64_t kSeed = 332;
    double ours = 0, theirs = 0;
    for (std::uint64_t i = 0; i < 12; ++i) {
        SplitMix random(kSeed + i);
        const raya_torus torus = random_torus(random, 4);
        const History history = random_history(random, torus, 400);
        CAPTURE(kSeed, i, torus_text(torus), history.messages.size());
        const SimgridAnswer answer = ask_simgrid(program, torus, history, {});
        CHECK(answer.delivered == history.messages.size());
        ours += simulate(torus, history).finish_ms;
        theirs += answer.finish_ms;
        CHECK(answer.finish_ms >= torus_time(torus, traffic_of(torus, history)).overlapped_ms * (1 - 1e-6));
    }
    CHECK(ours == Approx(theirs).epsilon(0.05));
}

TEST_CASE("the study's page has each machine with each effect, and its bounds", "[study]") {
    if (!std::filesystem::exists(replay_program())) {
        WARN("SimGrid is not installed: tools/setup --studies");
        return;
    }
    Session session(choose_device(""));
    const StudyPage page = simgrid_page(session, even_scene(8), 16, replay_program());
    check_page(page);
    const StudyTable& table = page.table("simgrid");
    REQUIRE(table.rows.size() == 2 * 2 * 5);
    const auto at = [&](std::size_t row, const char* label) { return table.at(row, label).number(); };
    for (std::size_t row = 0; row < table.rows.size(); ++row) {
        CAPTURE(row);
        CHECK(std::abs(at(row, "difference")) < 10);  // %: the goal
        CHECK(at(row, "messages") == at(row / 5 * 5, "messages"));
        const double before = row % 5 == 0 ? 0 : at(row - 1, "raya");
        CHECK(at(row, "raya, the effect") == Approx(at(row, "raya") - before).margin(1e-9));
    }
    CHECK(page.comparisons.size() == 4);
    CHECK(page.findings.size() == 2 + 4);
    REQUIRE(page.plots.size() == 1);
    CHECK(page.plots[0].series.size() == 2 * 4);
}

}  // namespace
}  // namespace raya
