#include "host/torus/torus_trace.hpp"

#include <fmt/core.h>

#include <algorithm>

#include "host/model/t805.hpp"
#include "host/torus/topology.hpp"

namespace raya {
namespace {

constexpr TraceTrack kSupersteps = {kTraceMachine, 1};
constexpr std::uint32_t kFirstNodeTrack = 2;  // track of node 0

// Like torus_time(), assumes the same number of words in both directions of the link.
double link_ms(std::uint64_t words) { return t805_link_ms(words, words); }
TraceTrack track_of(std::uint32_t node) { return {kTraceMachine, kFirstNodeTrack + node}; }

}  // namespace

void TorusTrace::add_superstep(const SuperstepDetail& step) {
    std::vector<NodeStep> nodes(step.cycles.size());
    for (std::size_t node = 0; node < nodes.size(); ++node) {
        nodes[node].cycles = step.cycles[node];
        for (std::uint32_t link = 0; link < RAYA_LINKS; ++link) {
            const auto words = static_cast<std::uint32_t>(step.link_words[node * RAYA_LINKS + link]);
            nodes[node].words += words;
            nodes[node].busiest_link_words = std::max(nodes[node].busiest_link_words, words);
        }
    }
    steps_.push_back(std::move(nodes));
}

// Adds supersteps to a trace. The supersteps follow one another, from time 0 on.
class TorusTrace::Timeline {
  public:
    Timeline(const TorusTrace& machine_trace, TraceFile& trace, const TorusResult& result, std::size_t nodes)
        : machine_trace_(machine_trace), trace_(trace), result_(result), nodes_(traced_pes(result.load.per_pe, nodes)) {
        trace.name_process(kTraceMachine, "torus of T805s (modelled time, step by step)");
        trace.name_track(kSupersteps, "supersteps");
        for (const TracedPe& n : nodes_) trace.name_track(track_of(n.pe), traced_pe_name("node", n));
    }

    void add_supersteps() {
        for (std::size_t step = 0; step < machine_trace_.steps_.size(); ++step) {
            const Superstep& superstep = result_.supersteps[step];
            const double compute_end_ms = now_ms_ + t805_ms(superstep.max_node_cycles);
            const double end_ms = compute_end_ms + link_ms(superstep.max_link_words);
            add_machine(step, end_ms);
            for (const TracedPe& n : nodes_) add_node(step, n.pe, compute_end_ms, end_ms);
            now_ms_ = end_ms;
        }
    }

  private:
    void add_machine(std::size_t step, double end_ms) {
        const std::vector<NodeStep>& nodes = machine_trace_.steps_[step];
        const Superstep& superstep = result_.supersteps[step];
        std::vector<std::uint64_t> cycles;
        std::uint64_t words = 0;
        for (const NodeStep& n : nodes) {
            cycles.push_back(n.cycles);
            words += n.words;
        }
        const Load load = load_of(std::move(cycles));
        const std::uint64_t begin_ns = nanoseconds(now_ms_);
        trace_.slice(kSupersteps, fmt::format("superstep {}", step), begin_ns, nanoseconds(end_ms),
                     {{"live", superstep.live},
                      {"u", load.imbalance},
                      {"busiest_cycles", superstep.max_node_cycles},
                      {"busiest_link_words", superstep.max_link_words},
                      {"words", words}});
        trace_.counter(kTraceMachine, "live rays", begin_ns, {{"packets", static_cast<double>(superstep.live)}});
        trace_.counter(kTraceMachine, "u", begin_ns, {{"u", load.imbalance}});
        const double links = static_cast<double>(nodes.size()) * links_of_node(machine_trace_.torus_);
        trace_.counter(kTraceMachine, "link words", begin_ns,
                       {{"busiest", static_cast<double>(superstep.max_link_words)},
                        {"mean", links > 0 ? static_cast<double>(words) / links : 0}});
    }

    void add_node(std::size_t step, std::uint32_t node, double compute_end_ms, double end_ms) {
        const NodeStep& n = machine_trace_.steps_[step][node];
        const TraceTrack track = track_of(node);
        const auto slice = [&](const char* name, double begin_ms, double finish_ms, const Json& arguments = {}) {
            if (nanoseconds(finish_ms) > nanoseconds(begin_ms))
                trace_.slice(track, name, nanoseconds(begin_ms), nanoseconds(finish_ms), arguments);
        };
        trace_.slice(track, fmt::format("superstep {}", step), nanoseconds(now_ms_), nanoseconds(end_ms));
        const double done_ms = now_ms_ + t805_ms(n.cycles), sent_ms = compute_end_ms + link_ms(n.busiest_link_words);
        slice("compute", now_ms_, done_ms, {{"cycles", n.cycles}});
        slice("wait for the busiest node", done_ms, compute_end_ms);
        slice("exchange", compute_end_ms, sent_ms, {{"busiest_link_words", n.busiest_link_words}, {"words", n.words}});
        slice("wait for the busiest link", sent_ms, end_ms);
    }

    const TorusTrace& machine_trace_;
    TraceFile& trace_;
    const TorusResult& result_;
    std::vector<TracedPe> nodes_;
    double now_ms_ = 0;
};

void TorusTrace::add_to(TraceFile& trace, const TorusResult& result, std::size_t nodes) const {
    if (nodes == 0) {
        trace.metadata()["machine"] = "left out: the number of nodes to trace is 0";
        return;
    }
    Timeline timeline(*this, trace, result, nodes);
    timeline.add_supersteps();
    trace.metadata()["machine"] = {
        {"name", "torus"},
        {"nodes", raya_nodes(torus_)},
        {"note",
         "modelled time, from time 0 of the trace; every superstep waits for its busiest node and link. The modelled "
         "time is independent of the measured times above"}};
}

}  // namespace raya
