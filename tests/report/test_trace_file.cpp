// Tests of TraceFile: TraceSchema finds no errors in its traces.
#include <catch2/catch.hpp>

#include "host/report/trace_file.hpp"
#include "host/scene/split_mix.hpp"
#include "tests/base/gunzip.hpp"
#include "tests/document.hpp"
#include "tests/report/trace_schema.hpp"

namespace raya {
namespace {

// Adds random slices between `start` and `end`, nested in up to `depth` + 1 levels.
void add_slices(TraceFile& trace, TraceTrack track, SplitMix& random, std::uint64_t start, std::uint64_t end,
                int depth) {
    std::uint64_t at = start;
    while (at < end) {
        const std::uint64_t slice_start = at + random.next() % (end - at + 1);
        const std::uint64_t slice_end = slice_start + random.next() % (end - slice_start + 1);
        trace.slice(track, "s" + std::to_string(depth), slice_start, slice_end);
        if (depth > 0) add_slices(trace, track, random, slice_start, slice_end, depth - 1);
        at = slice_end + 1 + (end - start) / 4;
    }
}

TraceFile random_trace(std::uint64_t seed, std::size_t limit) {
    SplitMix random(seed);
    TraceFile trace(limit);
    const auto processes = static_cast<std::uint32_t>(1 + random.next() % 3);
    for (std::uint32_t p = 1; p <= processes; ++p) {
        trace.name_process(p, "process \"" + std::to_string(p) + "\" \\ \xff");
        for (std::uint32_t t = 1; t <= 3; ++t) {
            trace.name_track({p, t}, "track");
            trace.slice({p, t}, "all", 0, 1'000'000'000'000);
            add_slices(trace, {p, t}, random, 0, random.next() % 1'000'000'000'000, 3);
        }
        for (int i = 0; i < 5; ++i)
            trace.counter(p, "c", random.next() % 1000, {{"a", random.uniform(-1, 1)}, {"b", 1e300}});
    }
    trace.metadata()["seed"] = seed;
    return trace;
}

}  // namespace

TEST_CASE("TraceFile: random traces are valid", "[report]") {
    for (std::uint64_t seed = 0; seed < 300; ++seed) {
        CAPTURE(seed);
        const TraceFile trace = random_trace(seed, 1'000'000);
        const Document json = json_of(trace);
        const TraceSchema schema(json);
        CHECK(schema.faults() == std::vector<std::string>{});
        CHECK(json["otherData"]["seed"] == seed);
        CHECK(json["otherData"]["events_left_out"] == 0);
        if (seed < 5) CHECK(gunzip(trace.finish(true)) == trace.finish(false));
    }
}

TEST_CASE("TraceFile: leaves out and counts events beyond the limit", "[report]") {
    for (std::uint64_t seed = 0; seed < 200; ++seed) {
        const std::size_t all = random_trace(seed, 1'000'000).events(), limit = seed % (all + 2);
        CAPTURE(seed, all, limit);
        const TraceFile trace = random_trace(seed, limit);
        const Document json = json_of(trace);
        CHECK(trace.events() <= limit);
        CHECK(trace.events() + trace.left_out() == all);
        CHECK(trace.events() == std::min(limit, all));
        CHECK(TraceSchema(json).faults() == std::vector<std::string>{});
    }
}

TEST_CASE("TraceFile: refuses events that readers would misinterpret", "[report]") {
    TraceFile trace(100);
    trace.name_process(1, "host");
    trace.name_track({1, 1}, "steps");
    CHECK_THROWS_AS(trace.slice({1, 2}, "nowhere", 0, 1), std::logic_error);
    CHECK_THROWS_AS(trace.slice({1, 1}, "backwards", 2, 1), std::logic_error);
    trace.slice({1, 1}, "outer", 10, 20);
    CHECK_THROWS_AS(trace.slice({1, 1}, "crossing", 15, 21), std::logic_error);
    CHECK_THROWS_AS(trace.slice({1, 1}, "late", 5, 6), std::logic_error);
    trace.slice({1, 1}, "inner", 10, 20);
    trace.slice({1, 1}, "next, longer", 20, 35);
    CHECK_THROWS_AS(trace.counter(1, "c", 0, {{"a", std::nan("")}}), std::logic_error);
}

}  // namespace raya
