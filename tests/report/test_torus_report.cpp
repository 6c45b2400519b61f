// Tests of the report and the summary of a render on the torus.
#include <catch2/catch.hpp>
#include <string>

#include "host/report/render_report.hpp"
#include "tests/document.hpp"

namespace raya {
namespace {

RenderReport report_with_figures() {
    RenderReport report;
    report.scene = "u.nff";
    report.image = {512, 256, "t.png", "abc"};
    report.machine.name = "torus";
    report.machine.topology = "torus2d";
    report.machine.mapping = "voxels";
    report.machine.format = "fp32";
    report.machine.pes = 64;
    report.machine.pe_memory_bytes = 4 << 20;
    report.machine.pe_memory_used_bytes = 3 << 19;
    for (std::size_t event = 0; event < RAYA_EVENTS; ++event) report.events[event] = 100 + event;
    report.load = load_of(std::vector<std::uint64_t>(64, 10));
    report.measured.render_s = 1;
    TorusReport t;
    t.nodes = {4, 4, 4};
    t.voxels = {8, 4, 4};
    t.links = "torus2d";
    t.inject = "root";
    t.packets = {24, true};
    t.returns = 70;
    t.discarded = 90;
    t.supersteps = 31;
    t.live_max = 900;
    for (std::uint32_t kind = 1; kind < RAYA_KINDS; ++kind) t.made[kind] = t.ended[kind] = 10 * kind;
    t.hops = 400;
    t.link = {256, 3 << 20, 128 << 20, {1, 2, 3, 4, 5, 6}, {9, 12}};
    t.queue = 2048;
    t.queue_max = 77;
    t.box = 512;
    t.copies = 5;
    t.modelled = {1, 2, 3, 4, 5, 6};
    report.torus = t;
    return report;
}

TEST_CASE("to_json: the report of a torus has the members of a torus and none of a ring", "[report]") {
    const Document json = read_back(to_json(report_with_figures()));
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
    CHECK(torus["bytes_per_link"] ==
          Document::parse(R"({"links": 256, "max": 3145728, "mean": 524288.0, "total": 134217728,
        "by_direction": [1, 2, 3, 4, 5, 6], "sent_by_node": [9, 12]})"));
    CHECK(torus["queue"] == 2048);
    CHECK(torus["queue_max"] == 77);
    CHECK(torus["box"] == 512);
    CHECK(torus["copies"] == 5);
    CHECK(json["walks"] == 100 + RAYA_WALKS);
    CHECK(json["steps"] == 100 + RAYA_STEPS);
    CHECK(json["modelled_ms"] == Document::parse(R"({"compute": 1.0, "messages": 2.0, "processor": 3.0, "links": 4.0,
        "overlapped": 5.0, "stepwise": 6.0})"));
    RenderReport async = report_with_figures();
    async.torus->modelled.asynchronous = AsynchronousTime{5.5, 3.5, 4.5, 0.5, 77, 8};
    CHECK(read_back(to_json(async))["modelled_ms"]["asynchronous"] ==
          Document::parse(R"({"finish": 5.5, "processor": 3.5, "links": 4.5, "port": 0.5, "delivered": 77,
        "queue_max": 8})"));
    CHECK_THAT(summary_text(async),
               Catch::Contains("async   5.5 ms without supersteps (busiest processor 3.5 ms, link "
                               "4.5 ms; longest wait of a main task for links 0.5 ms; 77 messages)"));
    CHECK(json["load"]["per_pe"].size() == 64);
    for (const char* key : {"antialias", "communication"}) CHECK_FALSE(json.contains(key));
    RenderReport ring = report_with_figures();
    ring.torus.reset();
    CHECK(to_json(ring).find("torus") == nullptr);
    for (const char* key : {"antialias", "communication", "modelled_ms"}) CHECK(to_json(ring).find(key) != nullptr);
}

// A reflected ray costs 1 multiplication, 10 moves, 2 branches and 16 packet words; a sphere test costs 11 additions,
// 9 multiplications and 1 branch.
TEST_CASE("t805_budget_json: contains the operations of a T805", "[report]") {
    EventCounts events{};
    events[RAYA_REFLECTED] = 3;
    events[RAYA_SPHERE_TESTS] = 2;
    CHECK(read_back(t805_budget_json(events, {})) ==
          Document::parse(R"({"additions": 22, "multiplications": 21, "divisions": 0, "roots": 0, "moves": 30,
              "packet_words": 48, "branches": 8})"));
}

TEST_CASE("summary_text: the summary of a torus has nodes, packets, links, memory and both bounds of the modelled time",
          "[report]") {
    const std::string text = summary_text(report_with_figures());
    INFO(text);
    for (const char* part :
         {"512 x 256 pixels on torus (4x4x4 nodes, torus2d, 8x4x4 voxels), fp32",
          "packets 150 = 10 primary + 20 reflected + 30 refracted + 40 shadow + 50 return; 31 supersteps",
          "70 returns of rays, 24 words a ray and 6 a return; 90 primary rays discarded",
          "400 messages over 256 links, 128.0 MB in all; mean 512.0 KB, maximum 3.0 MB over one link",
          "1536.0 KB in the fullest node of 4096 KB; queues of 2048 packets, at most 77 used; 5 copies of objects",
          "5.0 ms if nothing waits", "6.0 ms step by step"})
        CHECK_THAT(text, Catch::Contains(part));
    CHECK_THAT(text, !Catch::Contains("mapping"));
    RenderReport without_links = report_with_figures();
    without_links.torus->link = {};
    CHECK_THAT(summary_text(without_links), Catch::Contains("over 0 links, 0 bytes in all"));
}

}  // namespace
}  // namespace raya
