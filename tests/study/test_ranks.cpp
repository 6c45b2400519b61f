// The model of renders on many ranks: cases worked out by hand, and a small study.
#include <catch2/catch.hpp>
#include <cmath>

#include "host/error.hpp"
#include "host/study/other_load.hpp"
#include "host/study/ranks_machines.hpp"
#include "host/study/studies.hpp"
#include "host/study/torus_runs.hpp"
#include "tests/paths.h"
#include "tests/study/study_cases.hpp"

namespace raya {
namespace {

TEST_CASE("so many rounds until all ranks have heard of each", "[study]") {
    CHECK(rounds_of(1) == 0);
    CHECK(rounds_of(2) == 1);
    CHECK(rounds_of(3) == 2);
    CHECK(rounds_of(4) == 2);
    CHECK(rounds_of(65'536) == 16);
}

TEST_CASE("the ring on four ranks, by hand", "[study]") {
    const MeasuredWork one{8, 1, 0.5};
    const Network network{0.001, 1e-6};
    const RingPart part{.ranks = 4,
                        .pes = 8,
                        .imbalance = 0.25,
                        .rotations = 10,
                        .block_bytes = 1000,
                        .image_bytes = 400'000,
                        .scene_bytes = 3000};
    const RankParts parts = predict_ring(one, part, network, 4);
    CHECK(parts.compute_s == Approx((8 * 1.25 + 1) / 4));
    CHECK(parts.host_s == 0.5);
    CHECK(parts.exchange_s == Approx(10 * 0.002));
    CHECK(parts.collect_s == Approx(6 * 0.001 + 0.3));
    CHECK(parts.broadcast_s == Approx(2 * 0.004));
    CHECK(parts.render_s() == Approx(2.75 + 0.5 + 0.02 + 0.306));
    CHECK(parts.total_s() == Approx(3.576 + 0.008));
    CHECK(parts.share() == Approx(0.334 / 3.584));
    CHECK(predict_ring(one, part, network, 2).compute_s == Approx(11.0 / 2));  // two ranks a core

    RingPart alone = part;
    alone.ranks = 1;
    alone.imbalance = 0;
    CHECK(predict_ring(one, alone, network, 1).total_s() == Approx(9.5));
    CHECK(predict_ring(one, alone, network, 1).communication_s() == 0);
}

TEST_CASE("the torus on two ranks, by hand", "[study]") {
    const MeasuredWork one{6, 2, 0.5};
    const Network network{0.001, 1e-6};
    const TorusPart part{.ranks = 2,
                         .nodes = 8,
                         .most_nodes = 4,
                         .supersteps = 10,
                         .cycles = 700,
                         .all_cycles = 1000,
                         .messages = 20,
                         .bytes = 5000,
                         .status_bytes = 1000,
                         .scene_bytes = 80'000};
    const RankParts parts = predict_torus(one, part, network, 2);
    CHECK(parts.compute_s == Approx(6 * 0.7 + 1));
    CHECK(parts.host_s == 0.5);
    CHECK(parts.exchange_s == Approx(0.02 + 0.005));
    CHECK(parts.collect_s == Approx(10 * (0.001 + 0.0005)));
    CHECK(parts.broadcast_s == Approx(0.001 + 0.04));
    CHECK(predict_torus(one, part, network, 1).compute_s == Approx(2 * 5.2));

    TorusPart alone = part;
    alone.ranks = 1;
    alone.most_nodes = 8;
    alone.cycles = 1000;
    CHECK(predict_torus(one, alone, network, 1).total_s() == Approx(8.5));
}

TEST_CASE("a torus whose nodes are cut into eight has sides twice as long", "[study]") {
    const TorusPart part{.ranks = 8,
                         .nodes = 8,
                         .most_nodes = 1,
                         .supersteps = 10,
                         .cycles = 800,
                         .all_cycles = 1600,
                         .messages = 20,
                         .bytes = 4000,
                         .status_bytes = 1000};
    const TorusPart cut = cut_further(part, 8);
    CHECK(cut.ranks == 64);
    CHECK(cut.nodes == 64);
    CHECK(cut.most_nodes == 1);
    CHECK(cut.supersteps == Approx(20));
    CHECK(cut.cycles == Approx(100));
    CHECK(cut.all_cycles == 1600);
    CHECK(cut.messages == Approx(40));
    CHECK(cut.bytes == Approx(1000));
    CHECK(cut.status_bytes == 8000);
    CHECK(cut.host_times == Approx(16));
    CHECK(cut_further(part, 1).bytes == 4000);
}

// Four nodes in a row, +x and -x their links; two ranks have two each.
TEST_CASE("a rank's cycles, messages and bytes in each superstep", "[study]") {
    const raya_torus torus = make_torus({4, 1, 1}, Links::kTorus3d);
    BrickCounter two(torus, 2), one(torus, 1);
    std::vector<std::uint64_t> words(4 * RAYA_LINKS);
    const auto over = [&](std::uint32_t node, std::uint32_t link) -> std::uint64_t& {
        return words[node * RAYA_LINKS + link];
    };
    over(0, 0) = 100;  // to node 1: the same rank
    over(1, 0) = 10;   // to node 2: rank 1
    over(0, 1) = 5;    // to node 3, round: rank 1, by another link
    over(2, 1) = 7;    // to node 1: rank 0
    for (BrickCounter* counter : {&two, &one}) counter->add({1, 2, 3, 4}, words);
    std::fill(words.begin(), words.end(), 0);
    for (BrickCounter* counter : {&two, &one}) counter->add({9, 0, 1, 0}, words);

    CHECK(two.part().ranks == 2);
    CHECK(two.part().nodes == 4);
    CHECK(two.part().most_nodes == 2);
    CHECK(two.part().supersteps == 2);
    CHECK(two.part().cycles == 7 + 9);
    CHECK(two.part().all_cycles == 20);
    CHECK(two.part().messages == 2);
    CHECK(two.part().bytes == 60);
    CHECK(one.part().cycles == 20);
    CHECK(one.part().messages == 0);
    CHECK(one.part().bytes == 0);
    CHECK_THROWS_AS(BrickCounter(torus, 5), UserError);
}

TEST_CASE("two faces of a rank's nodes to the same rank are one message a link", "[study]") {
    const raya_torus torus = make_torus({2, 2, 1}, Links::kTorus3d);
    BrickCounter counter(torus, 2);
    std::vector<std::uint64_t> words(4 * RAYA_LINKS);
    for (std::uint32_t node = 0; node < 4; ++node)
        for (std::uint32_t link = 0; link < 4; ++link) words[node * RAYA_LINKS + link] = 1;
    counter.add({1, 1, 1, 1}, words);
    CHECK(counter.part().messages == 2);  // + and - of the axis that was cut
    CHECK(counter.part().bytes == 4 * 4);
}

TEST_CASE("the first number of ranks on which communication takes half", "[study]") {
    const std::vector<std::uint32_t> ranks = {1, 2, 4};
    const RankParts little{.compute_s = 3, .exchange_s = 1}, half{.compute_s = 2, .exchange_s = 2},
        much{.compute_s = 1, .exchange_s = 5};
    CHECK(half_at(ranks, std::vector{little, little, half}) == 4);
    CHECK(half_at(ranks, std::vector{little, much, little}) == 2);
    CHECK(half_at(ranks, std::vector{little, little, little}) == 0);
}

TEST_CASE("processors' time is read from a line of the system, and nothing else", "[study]") {
    const auto time = processor_time("cpu  100 20 30 400 50 6 7 8 9 10", 10);
    REQUIRE(time);
    CHECK(time->busy_s == Approx(17.1));  // (100 + 20 + 30 + 6 + 7 + 8) / 10
    CHECK(time->all_s == Approx(62.1));
    CHECK_FALSE(processor_time("cpu 1 2 3", 10));
    CHECK_FALSE(processor_time("intr 1 2 3 4 5 6 7 8", 10));
    CHECK_FALSE(processor_time("", 10));
}

TEST_CASE("the study of ranks on small pictures: its shape, and what holds of any network", "[study][slow]") {
    const Mpirun mpirun(nullptr, RAYA_PROGRAM);
    if (const std::string lack = mpirun.lack(); !lack.empty()) {
        WARN(lack);
        return;
    }
    Session session(choose_device(""));
    Laboratory lab(session, 0);
    const StudyPage page = ranks_page(lab, embedded_scene("centre"), even_scene(64), {.ring = 32, .torus = 32}, mpirun);
    check_page(page);
    const auto& here = page.table("ranks-here").rows;
    REQUIRE(here.size() >= 6);  // 1, 2 and 4 ranks of each machine
    CHECK(page.value("ranks-here", 0, "predicted / measured") == Approx(1).epsilon(0.01));  // the model rests on it
    const StudyTable& all = page.table("ranks-all");
    CHECK(all.rows.size() == 3 * (11 + 17));  // the ring's 1024 pixels end at 1024 ranks
    for (std::size_t i = 0; i < all.rows.size(); ++i) {
        const auto of = [&](const char* label) { return all.at(i, label).number(); };
        CHECK(of("time") == Approx(of("compute") + of("host") + of("exchange") + of("collect") + of("broadcast")));
        if (of("ranks") == 1) CHECK(of("communication") == 0);
        if (of("ranks") == 1) CHECK(of("speed-up") == Approx(1));
        if (of("ranks") > 1) CHECK(of("collect") > all.at(i - 1, "collect").number());
    }
    for (std::size_t i = 0; i < all.rows.size() / 3; ++i) CHECK(all.at(i, "compute").number() > 0);
}

TEST_CASE("reports of renders and of pings read as such, and nothing else does", "[study]") {
    const RankedRender render = ranked_render(Json::parse(
        R"({"image": {"width": 4, "height": 2, "hash": "abc"}, "machine": {"pes": 8}, "load": {"mean": 2.5},
            "device": {"name": "d", "platform": "Portable Computing Language"},
            "rays": {"primary": 8, "reflected": 1, "refracted": 2, "shadow": 3},
            "measured": {"render_s": 0.5, "commands": [
                {"label": "trace", "kind": "kernel", "launches": 1, "total_ns": 300000000},
                {"label": "gather", "kind": "read", "launches": 2, "total_ns": 100000000}]}})",
        {"report"}));
    CHECK(render.work == 20);
    CHECK(render.rays == 14);
    CHECK(render.on_processors());
    CHECK(render.device_s() == Approx(0.4));
    CHECK(render.device_s("trace") == Approx(0.3));
    const RankedMachine machine{"ring", {}, {}, {}, {}, "trace"};
    const MeasuredWork work = work_of(machine, render);
    CHECK(work.trace_s == Approx(0.3));
    CHECK(work.spread_s == Approx(0.1));
    CHECK(work.host_s == Approx(0.1));
    CHECK_THROWS_AS(ranked_render(Json::parse("{}", {"report"})), JsonError);
    CHECK_THROWS_WITH(ping_of(Mpirun("echo", "raya"), 2),
                      Catch::Contains("the ranks' report of raya ping:1: not valid JSON"));
}

}  // namespace
}  // namespace raya
