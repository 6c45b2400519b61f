// Trace of the modelled ring machine: the times are those of the time model, and the work is the counted work.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

#include "host/model/budget.hpp"
#include "host/ring/ring_result.hpp"
#include "host/scene/split_mix.hpp"
#include "tests/document.hpp"
#include "tests/report/trace_schema.hpp"
#include "tests/ring/render_scene.hpp"
#include "tests/scene/random_below.hpp"

namespace raya {
namespace {

struct Rendered {
    RingSettings settings;
    RingResult result;
};

Rendered render(const RingCase& c) {
    Session session(choose_device(""));
    Rendered r{settings_of(c), {}};
    r.result = RingRenderer(session, project_scene("centre"), r.settings).render();
    return r;
}

Document trace_of(const Rendered& r, std::size_t pes) {
    TraceFile trace(10'000'000);
    add_ring_machine(trace, r.settings, r.result, pes);
    return Document::parse(trace.finish(false));
}

double modelled_ns(const Rendered& r) { return 1e6 * ring_time(r.settings, r.result).total_ms; }

std::int64_t time_of(const std::vector<TraceSchema::Slice>& slices, const std::string& name) {
    std::int64_t sum = 0;
    for (const TraceSchema::Slice& s : slices)
        if (s.name == name) sum += s.end - s.start;
    return sum;
}

std::int64_t end_of(const std::vector<TraceSchema::Slice>& slices) {
    std::int64_t end = 0;
    for (const TraceSchema::Slice& s : slices) end = std::max(end, s.end);
    return end;
}

std::uint64_t rotations_of(const std::vector<TraceSchema::Slice>& slices) {
    return static_cast<std::uint64_t>(
        std::count_if(slices.begin(), slices.end(), [](const auto& s) { return s.name == "rotation"; }));
}

// Returns the number of exchange slices with one rotation. For such a slice the trace has no inner slices.
std::uint64_t single_rotations(const Document& trace) {
    std::uint64_t singles = 0;
    for (const Document& e : trace["traceEvents"])
        singles += e["ph"] == "X" && e["tid"] == 1 && e["args"].value("rotations", 0) == 1;
    return singles;
}

}  // namespace

TEST_CASE("the trace of the machine ends at the modelled time and has the counted loads", "[ring]") {
    SplitMix random(1);
    const double cycle_ns = 1e6 * compute_ms(machine_named("spa").clock, 1);
    const std::optional<MappingRule> mappings[] = {
        {}, column_mapping(), rows_mapping(), blocks_mapping(), grid_mapping(4, 6), tiles_mapping(4, 4)};
    for (int i = 0; i < static_cast<int>(quick_cases(9, 24)); ++i) {
        RingCase c{.width = 24, .height = 16, .pes = 24, .offset = random_below(random, 24), .machine = "spa"};
        c.mapping = mappings[random_below(random, std::size(mappings))];
        c.lanes = 4;
        c.antialias.method = static_cast<AntialiasMethod>(i % 3);
        c.antialias.exchange = static_cast<ExchangeMethod>(i / 3 % 3);
        if (i % 2) c.split = std::array{2u, 6u, 24u}[random_below(random, 3)];
        const Rendered r = render(c);
        CAPTURE(i, mapping_text(settings_of(c).mapping));
        const Document json = trace_of(r, 24);
        const TraceSchema schema(json);
        CHECK(schema.faults() == std::vector<std::string>{});
        CHECK(schema.tracks().size() == 25);
        const auto& phases = schema.slices().at({kTraceMachine, 1});
        CHECK(std::abs(static_cast<double>(end_of(phases)) - modelled_ns(r)) < 2);
        std::uint64_t moves = 0;
        for (const Document& e : json["traceEvents"])
            if (e["ph"] == "X" && e["tid"] == 1)
                for (const char* const name : {"rotations", "transfers", "broadcasts"})
                    moves += e["args"].value(name, 0);
        const Communication& counted = r.result.communication;
        CHECK(moves == counted.rotations + counted.transfers + counted.pe_broadcasts);
        const auto& names = schema.tracks();
        for (const auto& [track, slices] : schema.slices()) {
            if (track.second == 1) continue;
            const auto pe = static_cast<std::size_t>(track.second - 2);
            CAPTURE(names.at(track));
            CHECK(end_of(slices) == end_of(phases));
            for (const Phase& phase : r.result.phases)
                CHECK(std::abs(static_cast<double>(time_of(slices, phase.name)) -
                               cycle_ns * static_cast<double>(phase.load.per_pe[pe])) < 2);
            if (r.result.turns() > 0) CHECK(time_of(phases, "turn 1") > 0);
            CHECK(rotations_of(slices) + single_rotations(json) == r.result.communication.rotations);
        }
    }
}

TEST_CASE("a PE of the traced ring is live until it has computed its load", "[ring]") {
    const Rendered r = render({.width = 24, .height = 16, .pes = 24, .machine = "spa", .lanes = 4});
    const std::vector<std::uint64_t>& loads = r.result.phases[0].load.per_pe;
    const double cycle_us = 1e3 * compute_ms(machine_named("spa").clock, 1);
    double begin_us = -1;
    std::size_t counters = 0;
    const Document trace = trace_of(r, 24);
    for (const Document& e : trace["traceEvents"]) {
        if (e["name"] != "live rays") continue;
        if (begin_us < 0) begin_us = e["ts"].get<double>();
        const double cycles = (e["ts"].get<double>() - begin_us) / cycle_us;
        CHECK(e["args"].front() == std::ranges::count_if(loads, [&](std::uint64_t load) {
                  return static_cast<double>(load) > cycles + 0.5;
              }));
        ++counters;
    }
    CHECK(counters == 1 + std::ranges::count_if(loads, [](std::uint64_t load) { return load > 0; }));
}

TEST_CASE("the work of the ring's kernels agrees with the counts", "[ring]") {
    RingCase c{.width = 24, .height = 16, .pes = 24, .machine = "spa", .lanes = 4};
    c.antialias.method = AntialiasMethod::kSupersample;
    const Rendered supersampled = render(c);
    const auto works = ring_kernel_work(supersampled.settings, supersampled.result);
    REQUIRE(works.size() == 3);
    CHECK(works[0].label == "trace");
    CHECK(works[1].label == "supersample");
    const Operations all_operations = operations_of(supersampled.result.events);
    CHECK(works[0].operations + works[1].operations == all_operations.multiply_accumulates);
    CHECK(works[0].divisions + works[1].divisions == all_operations.divisions);
    CHECK(works[0].roots + works[1].roots == all_operations.roots);
    // In one launch, each of 24 PEs reads the job's words, reads and writes RAYA_EVENTS counters per work-item, and
    // writes 20 bytes per pixel.
    const std::uint64_t words = supersampled.result.communication.broadcast_words;
    CHECK(works[0].bytes == 24 * 4 * words + 24 * 16 * RAYA_EVENTS * supersampled.result.group_size + 20 * 24 * 16);
    const std::uint64_t neighbours = 2 * 23 * 16 + 2 * 24 * 15;
    CHECK(works[2].label == "supersample.compare");
    CHECK(works[2].operations == 18 * neighbours);
    CHECK(works[2].bytes == 24 * neighbours);
    c.antialias.method = AntialiasMethod::kFilter;
    const Rendered filter = render(c);
    std::uint64_t operations = 0;
    for (const KernelWork& w : ring_kernel_work(filter.settings, filter.result))
        if (w.label != "trace") operations += w.operations;
    CHECK(operations == 3 * (neighbours + 24 * 16));
}

}  // namespace raya
