// Trace of the modelled torus machine: stepwise time, and flows of packets.
#include <catch2/catch.hpp>
#include <cmath>

#include "host/model/budget.hpp"
#include "host/torus/torus_result.hpp"
#include "host/torus/torus_trace.hpp"
#include "tests/document.hpp"
#include "tests/report/trace_schema.hpp"
#include "tests/torus/render_torus.hpp"

namespace raya {
namespace {

using Slices = std::vector<TraceSchema::Slice>;

struct TracedRender {
    TorusSettings settings;
    TorusResult result;
    Document trace;
    std::uint64_t packets = 0;
};

TracedRender render(const Scene& scene, const TorusCase& c, std::size_t nodes) {
    Session session(choose_device(""));
    TracedRender t{settings_of(c), {}, {}};
    TorusTrace torus_trace(t.settings.torus);
    t.result = TorusRenderer(session, scene, t.settings)
                   .render({}, {.packets =
                                    [&](const PacketRecord& p) {
                                        torus_trace.add_packet(p);
                                        ++t.packets;
                                    },
                                .supersteps = [&](const SuperstepDetail& step) { torus_trace.add_superstep(step); }});
    TraceFile trace(10'000'000);
    torus_trace.add_to(trace, t.result, nodes);
    t.trace = Document::parse(trace.finish(false));
    return t;
}

std::int64_t end_of(const Slices& slices) {
    std::int64_t end = 0;
    for (const TraceSchema::Slice& s : slices) end = std::max(end, s.end);
    return end;
}

}  // namespace

TEST_CASE("the traced torus ends at the stepwise time, and its nodes compute for the counted cycles", "[torus]") {
    for (const std::uint64_t seed : {27u, 53u, 19u, 21u}) {
        const TorusCase c{.nodes = {2, 2, 2}, .links = seed % 2 ? Links::kTorus2d : Links::kTorus3d, .lanes = 4};
        CAPTURE(seed, case_text(c));
        const TracedRender t = render(random_view_scene(seed), c, 8);
        const TraceSchema schema(t.trace);
        CHECK(schema.faults() == std::vector<std::string>{});
        CHECK(schema.tracks().size() == 9);
        const Slices& steps = schema.slices().at({kTraceMachine, 1});
        CHECK(steps.size() == t.result.supersteps.size());
        const double stepwise = 1e6 * torus_time(t.settings.torus, t.result).stepwise_ms;
        CHECK(std::abs(static_cast<double>(end_of(steps)) - stepwise) < 2);
        for (std::uint32_t node = 0; node < 8; ++node) {
            std::int64_t computing = 0;
            for (const TraceSchema::Slice& s : schema.slices().at({kTraceMachine, 2 + node}))
                if (s.name == "compute") computing += s.end - s.start;
            // Both ends of each superstep are rounded to nanoseconds.
            CHECK(std::abs(computing - static_cast<std::int64_t>(40 * t.result.load.per_pe[node])) <=
                  static_cast<std::int64_t>(2 * steps.size()));
        }
        // All nodes are shown, and the sample holds all packets, so every packet is a flow.
        REQUIRE(t.packets < TorusTrace::kMaxPackets);
        CHECK(schema.flows() == t.packets);
        CHECK(t.trace["otherData"]["machine"]["flows"] == t.packets);
    }
}

TEST_CASE("the trace has the counters of each superstep and a track for each requested node", "[torus]") {
    const TracedRender t = render(random_view_scene(27), {.lanes = 4}, 3);
    std::vector<double> live, busiest_link_words;
    for (const Document& e : t.trace["traceEvents"]) {
        if (e["name"] == "live rays") live.push_back(e["args"]["packets"]);
        if (e["name"] == "link words") busiest_link_words.push_back(e["args"]["busiest"]);
    }
    REQUIRE(live.size() == t.result.supersteps.size());
    REQUIRE(busiest_link_words.size() == live.size());
    for (std::size_t i = 0; i < live.size(); ++i) {
        CHECK(live[i] == static_cast<double>(t.result.supersteps[i].live));
        CHECK(busiest_link_words[i] == static_cast<double>(t.result.supersteps[i].max_link_words));
    }
    const TraceSchema schema(t.trace);
    CHECK(schema.tracks().size() == 4);
    CHECK(schema.flows() < t.packets);
    CHECK(TraceSchema(render(random_view_scene(27), {.lanes = 4}, 0).trace).faults().empty());
}

TEST_CASE("recording every fourth superstep gives the same packets of these supersteps as recording all", "[torus]") {
    const Scene scene = random_view_scene(27);
    const TorusCase c{.links = Links::kTorus2d, .queue = 200, .lanes = 4};  // packets wait in their outboxes
    const auto record_packets = [&](std::uint32_t every) {
        Session session(choose_device(""));
        std::vector<std::string> packets;
        TorusRenderer(session, scene, settings_of(c))
            .render({}, {.packets =
                             [&](const PacketRecord& p) {
                                 if (p.superstep % 4 == 0)
                                     packets.push_back(fmt::format("{} {} {} {} {} {} {}", p.superstep, p.source,
                                                                   p.destination, p.head.pixel, p.head.state,
                                                                   p.head.path, p.head.weight));
                                 else
                                     CHECK(every == 1);
                             },
                         .packets_every = every});
        return packets;
    };
    const std::vector<std::string> all_packets = record_packets(1);
    CHECK(all_packets.size() > 100);
    CHECK(record_packets(4) == all_packets);
}

TEST_CASE("the packet sample has kMaxPackets packets and is uniform over time", "[torus]") {
    const raya_torus torus = make_torus({1, 2, 1}, Links::kTorus3d);
    TorusTrace torus_trace(torus);
    const std::uint32_t packets = 5 * TorusTrace::kMaxPackets;
    for (std::uint32_t i = 0; i < packets; ++i) {
        PacketRecord p{.superstep = i / 1000, .source = 0, .destination = 1};
        p.head.state = RAYA_KIND_SHADOW;
        torus_trace.add_packet(p);
    }
    TorusResult result;
    result.load = load_of({1, 1});
    const std::vector<std::uint64_t> words(2 * RAYA_LINKS);
    for (std::uint32_t step = 0; step < packets / 1000 + 2; ++step) {
        result.supersteps.push_back({.max_node_cycles = 100});
        torus_trace.add_superstep({result.supersteps.back(), {100, 50}, words});
    }
    TraceFile trace(10'000'000);
    torus_trace.add_to(trace, result, 2);
    const Document json = Document::parse(trace.finish(false));
    const TraceSchema schema(json);
    CHECK(schema.faults() == std::vector<std::string>{});
    CHECK(schema.flows() == TorusTrace::kMaxPackets);
    std::vector<int> flows_per_quarter(4);
    for (const Document& e : json["traceEvents"])
        if (e["ph"] == "s")
            ++flows_per_quarter[std::min<std::size_t>(3, static_cast<std::size_t>(e["ts"].get<double>() / 4 / 25))];
    for (const int count : flows_per_quarter) CHECK(std::abs(count - 5000) < 400);  // 400: 6 standard deviations
}

TEST_CASE("the work of the torus's kernels agrees with the counts", "[torus]") {
    const TracedRender t = render(random_view_scene(27), {.lanes = 4}, 0);
    const auto works = torus_kernel_work(t.settings, t.result);
    REQUIRE(works.size() == 5);
    const Operations all_operations = operations_of(t.result.events);
    CHECK(works[0].operations + works[1].operations == all_operations.multiply_accumulates);
    CHECK(works[0].rays == t.result.events[RAYA_PRIMARY]);
    CHECK(works[1].rays == t.result.made[RAYA_KIND_PRIMARY] + t.result.made[RAYA_KIND_REFLECTED] +
                               t.result.made[RAYA_KIND_REFRACTED] + t.result.made[RAYA_KIND_SHADOW]);
    std::uint64_t words = 0;
    for (const std::uint64_t w : t.result.link_words) words += w;
    CHECK(works[3].bytes == 2 * 4 * words);  // accept
    CHECK(t.result.contributions == t.result.made[RAYA_KIND_RETURN]);
    CHECK(works[4].operations == 3 * t.result.contributions);
}

}  // namespace raya
