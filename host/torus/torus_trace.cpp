#include <fmt/core.h>

#include <algorithm>
#include <numeric>
#include <span>

#include "host/model/t805.hpp"
#include "host/torus/topology.hpp"
#include "host/torus/torus_result.hpp"

namespace raya {
namespace {

constexpr TraceTrack kSupersteps = {kTraceMachine, 1};

TraceTrack track_of(std::uint32_t node) { return {kTraceMachine, kSupersteps.thread + 1 + node}; }

// Like torus_time(), assumes the same number of words in both directions of the link.
double link_ms(std::uint64_t words) { return t805_link_ms(words, words); }

std::uint64_t sum(std::span<const std::uint64_t> numbers) {
    return std::accumulate(numbers.begin(), numbers.end(), std::uint64_t{0});
}

// A superstep in modelled time.
struct TracedStep {
    std::string name;
    const Superstep& all;
    std::span<const std::uint64_t> cycles, link_words;  // [node], [node][RAYA_LINKS]
    double begin_ms, computed_ms, end_ms;
};

void add_superstep(TraceFile& trace, const raya_torus& torus, const TracedStep& step) {
    const Load load = load_of({step.cycles.begin(), step.cycles.end()});
    const std::uint64_t begin_ns = nanoseconds(step.begin_ms), words = sum(step.link_words);
    trace.slice(kSupersteps, step.name, begin_ns, nanoseconds(step.end_ms),
                {{"live", step.all.live},
                 {"u", load.imbalance},
                 {"busiest_cycles", step.all.max_node_cycles},
                 {"busiest_link_words", step.all.max_link_words},
                 {"words", words}});
    const double links = static_cast<double>(step.cycles.size()) * links_of_node(torus);
    trace.counter(kTraceMachine, "live rays", begin_ns, {{"packets", static_cast<double>(step.all.live)}});
    trace.counter(kTraceMachine, "u", begin_ns, {{"u", load.imbalance}});
    trace.counter(kTraceMachine, "link words", begin_ns,
                  {{"busiest", static_cast<double>(step.all.max_link_words)},
                   {"mean", links > 0 ? static_cast<double>(words) / links : 0}});
}

void add_node(TraceFile& trace, std::uint32_t node, const TracedStep& step) {
    const auto slice = [&](const char* name, double begin_ms, double end_ms, const Json& arguments = {}) {
        if (nanoseconds(end_ms) > nanoseconds(begin_ms))
            trace.slice(track_of(node), name, nanoseconds(begin_ms), nanoseconds(end_ms), arguments);
    };
    trace.slice(track_of(node), step.name, nanoseconds(step.begin_ms), nanoseconds(step.end_ms));
    const std::span<const std::uint64_t> words = step.link_words.subspan(std::size_t{node} * RAYA_LINKS, RAYA_LINKS);
    const std::uint64_t busiest = std::ranges::max(words);
    const double done_ms = step.begin_ms + t805_ms(step.cycles[node]), sent_ms = step.computed_ms + link_ms(busiest);
    slice("compute", step.begin_ms, done_ms, {{"cycles", step.cycles[node]}});
    slice("wait for the busiest node", done_ms, step.computed_ms);
    slice("exchange", step.computed_ms, sent_ms, {{"busiest_link_words", busiest}, {"words", sum(words)}});
    slice("wait for the busiest link", sent_ms, step.end_ms);
}

}  // namespace

void add_torus_machine(TraceFile& trace, const raya_torus& torus, const TorusResult& result,
                       const std::vector<std::uint64_t>& cycles, const std::vector<std::uint64_t>& link_words,
                       std::size_t nodes) {
    if (nodes == 0) {
        trace.metadata()["machine"] = "left out: the number of nodes to trace is 0";
        return;
    }
    trace.name_process(kTraceMachine, "torus of T805s (modelled time, step by step)");
    trace.name_track(kSupersteps, "supersteps");
    const std::vector<TracedPe> traced = traced_pes(result.load.per_pe, nodes);
    for (const TracedPe& n : traced) trace.name_track(track_of(n.pe), traced_pe_name("node", n));
    const std::size_t all_nodes = raya_nodes(torus);
    double now_ms = 0;
    for (std::size_t i = 0; i < result.supersteps.size(); ++i) {
        const Superstep& all = result.supersteps[i];
        const double computed_ms = now_ms + t805_ms(all.max_node_cycles),
                     end_ms = computed_ms + link_ms(all.max_link_words);
        const TracedStep step{fmt::format("superstep {}", i),
                              all,
                              std::span(cycles).subspan(i * all_nodes, all_nodes),
                              std::span(link_words).subspan(i * all_nodes * RAYA_LINKS, all_nodes * RAYA_LINKS),
                              now_ms,
                              computed_ms,
                              end_ms};
        add_superstep(trace, torus, step);
        for (const TracedPe& n : traced) add_node(trace, n.pe, step);
        now_ms = end_ms;
    }
    trace.metadata()["machine"] = {
        {"name", "torus"},
        {"nodes", all_nodes},
        {"note",
         "modelled time, from time 0 of the trace; every superstep waits for its busiest node and link. The modelled "
         "time is independent of the measured times above"}};
}

}  // namespace raya
