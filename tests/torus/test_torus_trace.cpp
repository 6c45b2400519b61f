// Trace of the modelled torus machine in stepwise time.
#include <catch2/catch.hpp>
#include <cmath>
#include <numeric>

#include "host/model/budget.hpp"
#include "host/torus/torus_result.hpp"
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
};

TracedRender render(const Scene& scene, const TorusCase& c, std::size_t nodes) {
    Session session(choose_device(""));
    TracedRender t{settings_of(c), {}, {}};
    std::vector<std::uint64_t> cycles, words;
    const auto record = [&](const SuperstepDetail& step) {
        cycles.insert(cycles.end(), step.cycles.begin(), step.cycles.end());
        words.insert(words.end(), step.link_words.begin(), step.link_words.end());
    };
    t.result = TorusRenderer(session, scene, t.settings).render({}, {.supersteps = record});
    TraceFile trace(10'000'000);
    add_torus_machine(trace, t.settings.torus, t.result, cycles, words, nodes);
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
    for (const std::uint64_t seed : {27u, 53u}) {
        const TorusCase c{.nodes = {2, 2, 2}, .links = seed % 2 ? Links::kTorus2d : Links::kTorus3d, .lanes = 4};
        CAPTURE(seed, case_text(c));
        const TracedRender t = render(random_view_scene(seed), c, 8);
        const TraceSchema schema(t.trace);
        CHECK(schema.faults() == std::vector<std::string>{});
        CHECK(schema.tracks().size() == 9);
        const Slices& steps = schema.slices().at({kTraceMachine, 1});
        REQUIRE(steps.size() == t.result.supersteps.size());
        std::size_t counters = 0;
        double mean_words = 0;  // of a link
        for (const Document& e : t.trace["traceEvents"]) {
            if (e["name"] == "live rays") CHECK(e["args"]["packets"] == t.result.supersteps.at(counters++).live);
            if (e["name"] == "link words") mean_words += e["args"]["mean"].get<double>();
        }
        const int links = c.links == Links::kTorus2d ? 4 : 6;
        const auto& words = t.result.link_words;
        CHECK(8 * links * mean_words == Approx(std::accumulate(words.begin(), words.end(), 0.0)));
        CHECK(counters == steps.size());
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
    }
}

TEST_CASE("a trace of some nodes has tracks for these nodes only", "[torus]") {
    const TracedRender t = render(random_view_scene(27), {.lanes = 4}, 3);
    CHECK(TraceSchema(t.trace).tracks().size() == 4);
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
