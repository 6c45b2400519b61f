// Tests of TraceFile: TraceSchema finds no errors in its traces. Tests of TraceSchema: it finds the errors of invalid
// traces.
#include <catch2/catch.hpp>
#include <functional>

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
        for (int i = 0; i < 5; ++i) {
            const std::uint64_t from_ns = random.next() % 1'000'000'000;
            trace.flow("f", {p, 1}, from_ns, {1, 2}, from_ns + random.next() % 1000);
        }
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
        CHECK(schema.flows() >= 5);
        CHECK(json["otherData"]["seed"] == seed);
        CHECK(json["otherData"]["events_left_out"] == 0);
        if (seed < 5) CHECK(gunzip(trace.finish(true)) == trace.finish(false));
    }
}

TEST_CASE("TraceFile: leaves out and counts events beyond the limit, both ends of a flow together", "[report]") {
    for (std::uint64_t seed = 0; seed < 200; ++seed) {
        const std::size_t all = random_trace(seed, 1'000'000).events(), limit = seed % (all + 2);
        CAPTURE(seed, all, limit);
        const TraceFile trace = random_trace(seed, limit);
        const Document json = json_of(trace);
        CHECK(trace.events() <= limit);
        CHECK(trace.events() + trace.left_out() == all);
        CHECK(trace.events() + 1 >= std::min(limit, all));  // a flow needs two events
        const std::vector<std::string> faults = TraceSchema(json).faults();
        for (const std::string& fault : faults) CHECK_THAT(fault, Catch::Contains("outside all slices"));
    }
}

TEST_CASE("TraceFile: writes the expected text of a small trace", "[report]") {
    TraceFile trace(10);
    trace.name_process(1, "host");
    trace.name_track({1, 7}, "steps");
    trace.slice({1, 7}, "render", 1'234'567'890, 1'234'567'895, {{"bytes", 4}});
    trace.counter(1, "u", 1000, {{"u", 0.5}});
    CHECK(trace.finish(false) ==
          R"({"displayTimeUnit":"ms","traceEvents":[
{"ph":"M","name":"process_name","pid":1,"tid":0,"args":{"name":"host"}},
{"ph":"M","name":"process_sort_index","pid":1,"tid":0,"args":{"sort_index":1}},
{"ph":"M","name":"thread_name","pid":1,"tid":7,"args":{"name":"steps"}},
{"ph":"M","name":"thread_sort_index","pid":1,"tid":7,"args":{"sort_index":7}},
{"ph":"X","name":"render","pid":1,"tid":7,"ts":1234567.890,"dur":0.005,"args":{"bytes":4}},
{"ph":"C","name":"u","pid":1,"ts":1.000,"args":{"u":0.5}}
],"otherData":{"events":2,"events_left_out":0}}
)");
    CHECK(TraceSchema(Document::parse(TraceFile(1).finish(false))).faults().empty());  // a trace without events
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
    CHECK_THROWS_AS(trace.flow("f", {1, 1}, 12, {1, 1}, 11), std::logic_error);
    CHECK_THROWS_AS(trace.flow("f", {1, 1}, 12, {2, 1}, 13), std::logic_error);
    CHECK_THROWS_AS(trace.counter(1, "c", 0, {{"a", std::nan("")}}), std::logic_error);
}

TEST_CASE("TraceSchema: finds each broken rule", "[report]") {
    struct Defect {
        std::string fault;                     // text of the expected fault
        std::function<void(Document&)> apply;  // changes the trace's list of events
    };
    const auto first = [](Document& events, const char* phase) -> Document& {
        return *std::find_if(events.begin(), events.end(), [&](const Document& e) { return e["ph"] == phase; });
    };
    const Document slice = {{"ph", "X"}, {"name", "x"}, {"pid", 1}, {"tid", 1}, {"ts", 999'999'999.5}, {"dur", 2.0}};
    const std::vector<Defect> defects = {
        {"unknown phase", [&](Document& e) { first(e, "X")["ph"] = "Z"; }},
        {"no name", [&](Document& e) { first(e, "X").erase("name"); }},
        {"pid is not an integer", [&](Document& e) { first(e, "X")["pid"] = "1"; }},
        {"tid is not an integer", [&](Document& e) { first(e, "X")["tid"] = 1.5; }},
        {"no time ts", [&](Document& e) { first(e, "X")["ts"] = "0"; }},
        {"no time ts", [&](Document& e) { first(e, "C").erase("ts"); }},
        {"no time dur", [&](Document& e) { first(e, "X")["dur"] = -1; }},
        {"args are not an object", [&](Document& e) { first(e, "X")["args"] = 5; }},
        {"a name after other events", [&](Document& e) { std::swap(e.front(), e.back()); }},
        {"has no process_name", [&](Document& e) { e.erase(0); }},
        {"has no process_sort_index", [&](Document& e) { e.erase(1); }},
        {"has no thread_name", [&](Document& e) { e.erase(2); }},
        {"has no thread_sort_index", [&](Document& e) { e.erase(3); }},
        {"named twice", [&](Document& e) { e.insert(e.begin(), Document(e.front())); }},
        {"a name without its value", [&](Document& e) { e[0]["args"].clear(); }},
        {"a name of the wrong kind", [&](Document& e) { e[1]["args"]["sort_index"] = "1"; }},
        {"slices cross", [&](Document& e) { e.push_back(slice); }},
        {"a counter without values", [&](Document& e) { first(e, "C")["args"] = Document::object(); }},
        {"a counter that is not a number", [&](Document& e) { first(e, "C")["args"]["a"] = "much"; }},
        {"a flow without id", [&](Document& e) { first(e, "s").erase("id"); }},
        {"binds to the next slice", [&](Document& e) { first(e, "f").erase("bp"); }},
        {"two beginnings or two ends", [&](Document& e) { e.push_back(Document(first(e, "s"))); }},
        {"has no end", [&](Document& e) { first(e, "f")["id"] = 4711; }},
        {"has no beginning", [&](Document& e) { first(e, "f")["id"] = 4711; }},
        {"ends do not agree", [&](Document& e) { first(e, "f")["ts"] = 0; }},
        {"ends do not agree", [&](Document& e) { first(e, "f")["name"] = "g"; }},
        {"outside all slices", [&](Document& e) { first(e, "f")["ts"] = 1e12; }},
        {"does not count the events", [&](Document& e) { e.erase(e.size() - 1); }},
    };
    for (const Defect& defect : defects) {
        CAPTURE(defect.fault);
        Document json = json_of(random_trace(3, 1'000'000));
        REQUIRE(TraceSchema(json).faults().empty());
        defect.apply(json["traceEvents"]);
        std::string all;
        const TraceSchema schema(json);
        for (const std::string& fault : schema.faults()) all += fault + "\n";
        CHECK_THAT(all, Catch::Contains(defect.fault));
    }
    CHECK(TraceSchema(Document::array()).faults() == std::vector<std::string>{"no traceEvents"});
}

}  // namespace raya
