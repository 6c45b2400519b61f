// Tests of the report and the summary of a render on the torus.
#include <catch2/catch.hpp>
#include <string>

#include "host/torus/topology.hpp"
#include "host/torus/torus_result.hpp"
#include "tests/document.hpp"

namespace raya {
namespace {

constexpr std::uint64_t kMegaword = 1 << 18;  // words of 1 MB

struct Case {
    TorusSettings settings;
    TorusResult result;
    std::optional<AsynchronousTime> asynchronous;

    Case() {
        settings.links = Links::kTorus2d;
        settings.torus = make_torus({4, 4, 4}, settings.links);
        settings.voxels = {8, 4, 4};
        settings.inject = Injection::kRoot;
        settings.packets = {24, true};
        result.events[RAYA_DISCARDED] = 90;
        result.load = load_of(std::vector<std::uint64_t>(64, 10));
        result.supersteps.resize(31);
        result.supersteps[5].live = 900;
        for (std::uint32_t kind = 1; kind < RAYA_KINDS; ++kind) result.made[kind] = result.ended[kind] = 10 * kind;
        result.returns = 70;
        result.hops = 400;
        result.link_words.assign(64 * RAYA_LINKS, 0);
        result.link_packets = result.link_words;
        result.link_words[0] = 3 * kMegaword;                   // node 0, link +x
        result.link_words[RAYA_LINKS + 3] = 2 * kMegaword + 1;  // node 1, link -y
        result.buffers = {2048, 512};
        result.queue_max = 77;
        result.copies = 5;
    }
    MachineReport report() const { return torus_report(settings, result, asynchronous); }
};

TEST_CASE("torus_report: has the figures of settings and result", "[report]") {
    const Document json = read_back(Case().report().json);
    const Document& torus = json["torus"];
    CHECK(torus["nodes"] == Document({4, 4, 4}));
    CHECK(torus["voxels"] == Document({8, 4, 4}));
    CHECK(torus["links"] == "torus2d");
    CHECK(torus["inject"] == "root");
    CHECK(torus["returns"] == Document::parse(R"({"of": "rays", "messages": 70})"));
    CHECK(torus["message_words"] == Document::parse(R"({"ray": 24, "return": 6})"));
    CHECK(torus["discarded"] == 90);
    CHECK(torus["supersteps"] == 31);
    CHECK(torus["live_max"] == 900);
    CHECK(torus["packets"] ==
          Document::parse(R"({"primary": {"made": 10, "ended": 10}, "reflected": {"made": 20, "ended": 20},
        "refracted": {"made": 30, "ended": 30}, "shadow": {"made": 40, "ended": 40}, "return": {"made": 50, "ended": 50}})"));
    CHECK(torus["hops"] == 400);
    const Document& bytes = torus["bytes_per_link"];
    CHECK(bytes["links"] == 256);
    CHECK(bytes["max"] == 3 << 20);
    CHECK(bytes["total"] == (5 << 20) + 4);
    CHECK(bytes["mean"] == ((5 << 20) + 4) / 256.0);
    CHECK(bytes["by_direction"] == Document({3 << 20, 0, 0, (2 << 20) + 4, 0, 0}));
    CHECK(bytes["sent_by_node"].size() == 64);
    CHECK(bytes["sent_by_node"][1] == (2 << 20) + 4);
    CHECK(torus["queue"] == 2048);
    CHECK(torus["queue_max"] == 77);
    CHECK(torus["box"] == 512);
    CHECK(torus["copies"] == 5);
    const Case c;
    const TorusTime time = torus_time(c.settings.torus, c.result);
    CHECK(json["modelled_ms"]["links"] == time.links_ms);
    CHECK(json["modelled_ms"]["overlapped"] == time.overlapped_ms);
    CHECK(json["modelled_ms"].size() == 6);
    Case async;
    async.asynchronous = AsynchronousTime{5.5, 3.5, 4.5, 0.5, 77, 8};
    CHECK(read_back(async.report().json)["modelled_ms"]["asynchronous"] ==
          Document::parse(R"({"finish": 5.5, "processor": 3.5, "links": 4.5, "port": 0.5, "delivered": 77,
        "queue_max": 8})"));
    CHECK_THAT(async.report().lines,
               Catch::Contains("async   5.5 ms without supersteps (busiest processor 3.5 ms, link "
                               "4.5 ms; longest wait of a main task for links 0.5 ms; 77 messages)"));
}

// A reflected ray costs 1 multiplication, 10 moves, 2 branches and 16 packet words; a sphere test costs 11 additions,
// 9 multiplications and 1 branch.
TEST_CASE("t805_members: lists the operations of a T805", "[report]") {
    EventCounts events{};
    events[RAYA_REFLECTED] = 3;
    events[RAYA_SPHERE_TESTS] = 2;
    Members members(Members::Mode::kWrite);
    t805_members(members, events, {});
    CHECK(read_back(members.json()) ==
          Document::parse(R"({"additions": 22, "multiplications": 21, "divisions": 0, "roots": 0, "moves": 30,
              "packet_words": 48, "branches": 8})"));
}

TEST_CASE("torus_report: the summary has nodes, packets, links, memory and both bounds of the modelled time",
          "[report]") {
    const MachineReport report = Case().report();
    INFO(report.lines);
    CHECK(report.title == "4x4x4 nodes, torus2d, 8x4x4 voxels");
    CHECK(report.memory == "; queues of 2048 packets, at most 77 used; 5 copies of objects");
    for (const char* part :
         {"packets 150 = 10 primary + 20 reflected + 30 refracted + 40 shadow + 50 return; 31 supersteps",
          "70 returns of rays, 24 words a ray and 6 a return; 90 primary rays discarded",
          "400 messages over 256 links, 5.0 MB in all; mean 20.0 KB, maximum 3.0 MB over one link",
          " if nothing waits (processors ", " step by step"})
        CHECK_THAT(report.lines, Catch::Contains(part));
}

}  // namespace
}  // namespace raya
