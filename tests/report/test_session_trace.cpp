// Tests of host spans and device commands in a trace, with times of different clocks.
#include <catch2/catch.hpp>

#include "host/report/trace_file.hpp"
#include "host/scene/split_mix.hpp"
#include "tests/document.hpp"
#include "tests/report/trace_schema.hpp"

namespace raya {
namespace {

CommandRecord command(const std::string& label, std::uint64_t start, std::uint64_t end) {
    return {.label = label,
            .kind = "copy",
            .queued = start,
            .submitted = start,
            .started = start,
            .ended = end,
            .bytes = 8,
            .target_name = "a -> b"};
}

Document slice_named(const Document& trace, const std::string& name) {
    for (const Document& e : trace["traceEvents"])
        if (e["ph"] == "X" && e["name"] == name) return e;
    return {};
}

}  // namespace

TEST_CASE("add_host_spans: slices nest like the scopes of the spans", "[report]") {
    const std::uint64_t begin = host_clock_ns();
    SpanLog log;
    const int result = log.during("outer", [&] {
        const SpanLog::Span first(&log, "first");
        return log.during("inner", [] { return 42; });
    });
    CHECK(result == 42);
    const SpanLog::Span open(&log, "open");
    const SpanLog::Span unlogged(nullptr, "unlogged");
    const std::vector<HostSpan> spans = log.spans();
    REQUIRE(spans.size() == 4);
    CHECK(spans[3].ended >= spans[3].started);
    CHECK(spans[2].depth == 2);
    TraceFile trace(100);
    add_host_spans(trace, spans, begin);
    const TraceSchema schema(json_of(trace));
    CHECK(schema.faults() == std::vector<std::string>{});
    const auto slices = schema.slices_of(kTraceHost);
    REQUIRE(slices.size() == 4);
    for (std::size_t i : {1u, 2u}) CHECK((slices[0].start <= slices[i].start && slices[i].end <= slices[0].end));
}

TEST_CASE("add_device_commands: a slice has times, bytes and launch parameters", "[report]") {
    Profile profile(true);
    profile.add({.label = "trace",
                 .kind = "kernel",
                 .queued = 1000,
                 .submitted = 1100,
                 .started = 1250,
                 .ended = 2251,
                 .target_name = "trace_kernel",
                 .groups = 7,
                 .group_size = 3});
    profile.add(command("move", 3000, 3000));
    TraceFile trace(100);
    add_device_commands(trace, "a device", profile, {}, 250);
    const Document json = json_of(trace), slice = slice_named(json, "trace"), copy = slice_named(json, "move");
    CHECK(TraceSchema(json).faults().empty());
    CHECK(slice["ts"] == 1.0);
    CHECK(slice["dur"] == 1.001);
    CHECK(slice["args"] == Document::parse(R"({"kind":"kernel","kernel":"trace_kernel","groups":7,"group_size":3,
        "queued_ns":1000,"submitted_ns":1100,"started_ns":1250,"ended_ns":2251})"));
    CHECK(copy["args"]["bytes"] == 8);
    CHECK(copy["args"]["buffer"] == "a -> b");
    CHECK(json["otherData"]["device_clock"]["same_as_host"] == true);
}

TEST_CASE("add_device_commands: times of another clock are converted, and times before the trace are moved to 0",
          "[report]") {
    Profile profile(true);
    profile.add(command("early", 90, 95));
    profile.add(command("later", 200, 260));
    TraceFile trace(100);
    add_device_commands(trace, "a device", profile, {.same_clock = false, .offset_ns = 900, .uncertainty_ns = 5}, 1000);
    const Document json = json_of(trace);
    CHECK(TraceSchema(json).faults().empty());
    CHECK(slice_named(json, "later")["ts"] == 0.1);
    CHECK(slice_named(json, "later")["dur"] == 0.06);
    CHECK(slice_named(json, "early")["ts"] == 0);
    CHECK(json["otherData"]["device_times_moved"] == 2);  // start and end of "early"
    CHECK(json["otherData"]["device_clock"]["offset_ns"] == 900);
}

TEST_CASE("add_device_commands: commands that overlap or end before they start make a valid trace", "[report]") {
    for (std::uint64_t seed = 0; seed < 300; ++seed) {
        CAPTURE(seed);
        SplitMix random(seed);
        Profile profile(true);
        for (int i = 0; i < 40; ++i) profile.add(command("c", random.next() % 1000, random.next() % 1000));
        TraceFile trace(1000);
        add_device_commands(trace, "a device", profile, {}, random.next() % 500);
        const TraceSchema schema(json_of(trace));
        CHECK(schema.faults() == std::vector<std::string>{});
        CHECK(schema.slices_of(kTraceDevice).size() == 40);
    }
    const Profile untimed(false);
    TraceFile trace(10);
    add_device_commands(trace, "a device", untimed, {}, 0);
    CHECK(json_of(trace)["otherData"]["device"].get<std::string>().starts_with("left out"));
}

}  // namespace raya
