// Tests of the report and the summary of a render on the torus.
#include <catch2/catch.hpp>
#include <string>

#include "host/torus/topology.hpp"
#include "host/torus/torus_result.hpp"
#include "tests/document.hpp"

namespace raya {
namespace {

TEST_CASE("torus_report: has the figures of settings and result", "[report]") {
    TorusSettings settings;
    settings.links = Links::kTorus2d;
    settings.torus = make_torus({2, 2, 1}, settings.links);
    settings.voxels = {8, 4, 4};
    settings.inject = Injection::kRoot;
    settings.packets = {24, true};
    TorusResult result;
    result.events[RAYA_DISCARDED] = 90;
    result.load = load_of({10, 10, 10, 10});
    result.supersteps.resize(31);
    result.supersteps[5].live = 900;
    for (std::uint32_t kind = 1; kind < RAYA_KINDS; ++kind) result.made[kind] = result.ended[kind] = 10 * kind;
    result.returns = 70;
    result.hops = 400;
    result.link_words.assign(4 * RAYA_LINKS, 0);
    result.link_packets = result.link_words;
    result.link_words[0] = 3 << 18;                     // node 0, link +x: 3 MB
    result.link_words[RAYA_LINKS + 3] = (2 << 18) + 1;  // node 1, link -y
    result.buffers = {2048, 512};
    result.queue_max = 77;
    result.copies = 5;
    const MachineReport report = torus_report(settings, result, AsynchronousTime{5.5, 3.5, 4.5, 0.5, 77, 8});
    const Document json = read_back(report.json);
    CHECK(json["torus"] == Document::parse(R"({"nodes": [2, 2, 1], "voxels": [8, 4, 4], "links": "torus2d",
        "inject": "root", "discarded": 90, "returns": {"of": "rays", "messages": 70},
        "message_words": {"ray": 24, "return": 6}, "supersteps": 31, "packets": {
            "primary": {"made": 10, "ended": 10}, "reflected": {"made": 20, "ended": 20},
            "refracted": {"made": 30, "ended": 30}, "shadow": {"made": 40, "ended": 40},
            "return": {"made": 50, "ended": 50}},
        "live_max": 900, "hops": 400, "bytes_per_link": {"links": 16, "max": 3145728, "mean": 327680.25,
            "total": 5242884, "by_direction": [3145728, 0, 0, 2097156, 0, 0], "sent_by_node": [3145728, 2097156, 0, 0]},
        "queue": 2048, "queue_max": 77, "box": 512, "copies": 5})"));
    const TorusTime time = torus_time(settings.torus, result);
    CHECK(json["modelled_ms"]["links"] == time.links_ms);
    CHECK(json["modelled_ms"]["overlapped"] == time.overlapped_ms);
    CHECK(json["modelled_ms"]["asynchronous"] ==
          Document::parse(R"({"finish": 5.5, "processor": 3.5, "links": 4.5, "port": 0.5, "delivered": 77,
        "queue_max": 8})"));
    INFO(report.lines);
    CHECK(report.title == "2x2x1 nodes, torus2d, 8x4x4 voxels");
    CHECK(report.memory == "; queues of 2048 packets, at most 77 used; 5 copies of objects");
    for (const char* part :
         {"packets 150 = 10 primary + 20 reflected + 30 refracted + 40 shadow + 50 return; 31 supersteps",
          "70 returns of rays, 24 words a ray and 6 a return; 90 primary rays discarded",
          "400 messages over 16 links, 5.0 MB in all; mean 320.0 KB, maximum 3.0 MB over one link",
          " if nothing waits (processors ", " step by step",
          "async   5.5 ms without supersteps (busiest processor 3.5 ms, link 4.5 ms; longest wait of a main task for "
          "links 0.5 ms; 77 messages)"})
        CHECK_THAT(report.lines, Catch::Contains(part));
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

}  // namespace
}  // namespace raya
