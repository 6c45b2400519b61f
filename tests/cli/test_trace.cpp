// render --trace: traces conform to TraceSchema and agree with the report of the same run.
#include <map>

#include "host/report/trace_file.hpp"
#include "tests/base/gunzip.hpp"
#include "tests/cli/render_files.hpp"
#include "tests/document.hpp"
#include "tests/report/trace_schema.hpp"

namespace raya {
namespace {

struct TracedRun {
    RunOutcome run;
    Document trace, report;
};

TracedRun run_with_trace(const std::string& scene, const Arguments& options, const std::string& ending = ".json") {
    const ScratchFolder folder;
    const std::string file = folder / ("t" + ending), report = folder / "r.json";
    Arguments arguments = {"render", scene_file(scene), "-o", folder / "x.pfm", "--size", "24x16", "--lanes",
                           "4",      "--trace",         file, "--report",       report};
    arguments.insert(arguments.end(), options.begin(), options.end());
    TracedRun traced{run_raya(arguments), {}, {}};
    INFO(traced.run.describe());
    REQUIRE(traced.run.code == 0);
    CHECK(folder.entries() == 3);
    const std::string text = file_contents(file);
    traced.trace = Document::parse(ending.ends_with(".gz") ? gunzip(text) : text);
    traced.report = Document::parse(file_contents(report));
    return traced;
}

// Key: "label/kind" of commands; value: [total time in nanoseconds, number of commands].
using Sums = std::map<std::string, std::pair<std::int64_t, std::int64_t>>;

Sums sums_of_trace(const Document& trace) {
    Sums sums;
    for (const Document& event : trace["traceEvents"]) {
        if (event["ph"] != "X" || event["pid"] != kTraceDevice) continue;
        auto& [ns, commands] = sums[event["name"].get<std::string>() + "/" + event["args"]["kind"].get<std::string>()];
        ns += std::llround(1000 * event["dur"].get<double>());
        ++commands;
        const Document& a = event["args"];
        CHECK(a["queued_ns"] <= a["submitted_ns"]);
        CHECK(a["submitted_ns"] <= a["started_ns"]);
        CHECK(a["ended_ns"].get<std::int64_t>() - a["started_ns"].get<std::int64_t>() ==
              std::llround(1000 * event["dur"].get<double>()));
    }
    return sums;
}

Sums sums_of_report(const Document& report) {
    Sums sums;
    for (const Document& c : report["measured"]["commands"])
        sums[c["label"].get<std::string>() + "/" + c["kind"].get<std::string>()] = {c["total_ns"], c["launches"]};
    return sums;
}

void check_trace(const TracedRun& traced) {
    INFO(traced.run.describe());
    const TraceSchema schema(traced.trace);
    CHECK(schema.faults() == std::vector<std::string>{});
    CHECK(sums_of_trace(traced.trace) == sums_of_report(traced.report));
    for (const std::int64_t pid : {1, 2, 3}) CHECK_FALSE(schema.slices_of(pid).empty());
    CHECK(traced.trace["otherData"]["events_left_out"] == 0);
    CHECK(traced.trace["otherData"]["device_clock"].is_object());
}

// Checks that both clocks agree: the host's step "render" contains all commands of the device.
void check_clocks(const Document& trace) {
    const TraceSchema schema(trace);
    const auto steps = schema.slices_of(kTraceHost);
    const auto render = std::find_if(steps.begin(), steps.end(), [](const auto& s) { return s.name == "render"; });
    REQUIRE(render != steps.end());
    for (const auto& command : schema.slices_of(kTraceDevice)) {
        CAPTURE(command.name, command.start, command.end, render->start, render->end);
        CHECK(render->start <= command.start);
        CHECK(command.end <= render->end);
    }
}

const Document& kernel_of(const Document& trace, const std::string& label) {
    for (const Document& event : trace["traceEvents"])
        if (event["ph"] == "X" && event["name"] == label && event["args"].value("kind", "") == "kernel")
            return event["args"];
    throw std::runtime_error("no kernel " + label);
}

}  // namespace

TEST_CASE("render --trace: the trace of a ring follows the schema, and its sums equal those of the report", "[cli]") {
    const TracedRun traced = run_with_trace("centre", {"--pes", "24"});
    check_trace(traced);
    check_clocks(traced.trace);
    CHECK(kernel_of(traced.trace, "trace")["groups"] == 24);
    CHECK(kernel_of(traced.trace, "trace")["kernel"] == "trace");
    const auto steps = TraceSchema(traced.trace).slices_of(kTraceHost);
    for (const std::string name : {"read scene", "pack scene", "set up device", "build ring/trace.cl", "render",
                                   "trace", "gather", "write images"})
        CHECK(std::count_if(steps.begin(), steps.end(), [&](const auto& s) { return s.name == name; }) == 1);
}

TEST_CASE("render --trace: works with anti-aliasing, gzip and --profile", "[cli]") {
    const TracedRun traced =
        run_with_trace("centre", {"--pes", "24", "--antialias", "supersample", "--profile"}, ".json.gz");
    check_trace(traced);
    const Document& measured = traced.report["measured"];
    CHECK((measured["builds"].size() >= 2 && measured["peak"]["copy_bytes_per_s"] > 0));
    Arguments labels;
    for (const Document& row : measured["roofline"]) {
        labels.push_back(row["label"]);
        CHECK((row["operations"] > 0 && row["share_of_roof"] > 0));
        CHECK_THAT(traced.run.out, Catch::Contains("\n" + labels.back() + " "));
    }
    CHECK(labels == Arguments{"trace", "supersample", "supersample.compare"});
}

TEST_CASE("render --trace --machine torus: the trace has nodes and links", "[cli]") {
    const TracedRun traced =
        run_with_trace("centre", {"--machine", "torus", "--nodes", "2x2x2", "--trace-pes", "5", "--profile"});
    check_trace(traced);
    check_clocks(traced.trace);
    const TraceSchema schema(traced.trace);
    CHECK(std::count_if(schema.tracks().begin(), schema.tracks().end(),
                        [](const auto& track) { return track.first.first == kTraceMachine; }) == 6);
    for (const char* label : {"inject", "trace_voxel", "route", "accept", "compose"})
        CHECK_THAT(traced.run.out, Catch::Contains(std::string("\n") + label + " "));
}

}  // namespace raya
