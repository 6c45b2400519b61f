// The modelled run of a ring machine in a trace file.
#include <fmt/core.h>

#include <algorithm>
#include <array>

#include "host/model/budget.hpp"
#include "host/report/trace_file.hpp"
#include "host/ring/mapping.hpp"
#include "host/ring/ring_result.hpp"

namespace raya {
namespace {

constexpr TraceTrack kPhases = {kTraceMachine, 1};
constexpr std::array<const char*, RAYA_SIDES> kSides = {"left", "right", "above", "below"};

// Adds the phases to the trace, one after another, from time 0 on.
class RingTimeline {
  public:
    RingTimeline(TraceFile& trace, const Machine& machine, std::vector<TracedPe> pes)
        : trace_(trace), cycle_ms_(compute_ms(machine.clock, 1)), pes_(std::move(pes)) {
        trace.name_process(kTraceMachine, machine.name + " (modelled time)");
        trace.name_track(kPhases, "phases");
        for (const TracedPe& p : pes_) trace.name_track(track_of(p), traced_pe_name("PE", p));
    }

    // Adds a phase that is the same for all PEs: a slice of `ms` milliseconds on each track. If `rotations` > 1,
    // the slice contains that many rotations of equal duration.
    void add_common_phase(const std::string& name, double ms, const Json& arguments, std::uint64_t rotations = 1) {
        const double begin = now_ms_;
        add_phase(name, ms, arguments);
        for (const TracedPe& p : pes_) {
            trace_.slice(track_of(p), name, nanoseconds(begin), nanoseconds(now_ms_));
            const double each_ms = ms / static_cast<double>(rotations);
            const auto time_of = [&](std::uint64_t n) { return nanoseconds(begin + each_ms * static_cast<double>(n)); };
            for (std::uint64_t i = 0; rotations > 1 && i < rotations; ++i)
                trace_.slice(track_of(p), "rotation", time_of(i),
                             i + 1 < rotations ? time_of(i + 1) : nanoseconds(now_ms_));
        }
    }

    // Adds a phase in which each PE computes for its own number of cycles, then waits for the busiest PE.
    void add_compute_phase(const std::string& name, const Load& load) {
        const double begin = now_ms_;
        const auto busiest = std::max_element(load.per_pe.begin(), load.per_pe.end()) - load.per_pe.begin();
        const Json arguments = {
            {"u", load.imbalance}, {"mean_cycles", load.mean}, {"max_cycles", load.max}, {"busiest", busiest}};
        trace_.counter(kTraceMachine, "u", nanoseconds(begin), {{"u", load.imbalance}});
        add_phase(name, cycle_ms_ * static_cast<double>(load.max), arguments);
        const std::string wait = fmt::format("wait for PE {}", busiest);
        for (const TracedPe& p : pes_) {
            const std::uint64_t cycles = load.per_pe[p.pe];
            const std::uint64_t done = nanoseconds(begin + cycle_ms_ * static_cast<double>(cycles));
            if (cycles > 0) trace_.slice(track_of(p), name, nanoseconds(begin), done, {{"cycles", cycles}});
            if (cycles < load.max)
                trace_.slice(track_of(p), wait, done, nanoseconds(now_ms_), {{"cycles", load.max - cycles}});
        }
    }

    // Adds a tracing phase with a counter of live rays. A PE of this machine traces one ray at a time, so the number of
    // live rays is the number of PEs that are tracing. The counter has at most kMaxPoints points after the first point.
    void add_tracing_phase(const std::string& name, const Load& load) {
        constexpr std::size_t kMaxPoints = 512;
        std::vector<std::uint64_t> ends = load.per_pe;
        std::sort(ends.begin(), ends.end());
        const std::size_t step = (ends.size() + kMaxPoints - 1) / kMaxPoints;
        add_live_rays(0, static_cast<double>(ends.end() - std::upper_bound(ends.begin(), ends.end(), 0u)));
        for (std::size_t i = 0; i < ends.size(); i += step) {
            const std::size_t last = std::min(i + step, ends.size()) - 1;
            if (ends[last] > 0) add_live_rays(ends[last], static_cast<double>(ends.size() - 1 - last));
        }
        add_compute_phase(name, load);
    }

  private:
    static TraceTrack track_of(const TracedPe& p) { return {kTraceMachine, p.pe + 2}; }

    void add_live_rays(std::uint64_t cycles, double rays) {
        trace_.counter(kTraceMachine, "live rays", nanoseconds(now_ms_ + cycle_ms_ * static_cast<double>(cycles)),
                       {{"rays", rays}});
    }

    void add_phase(const std::string& name, double ms, const Json& arguments) {
        trace_.slice(kPhases, name, nanoseconds(now_ms_), nanoseconds(now_ms_ + ms), arguments);
        now_ms_ += ms;
    }

    TraceFile& trace_;
    double cycle_ms_, now_ms_ = 0;
    std::vector<TracedPe> pes_;
};

// Returns one side's quarter of each PE's cycles. `cycles_of` returns the cycles for a number of pixels. The quarters
// of the four sides add up to all cycles exactly.
Load quarter_load(const raya_mapping& m, std::uint64_t (*cycles_of)(std::uint64_t), std::uint32_t side) {
    std::vector<std::uint64_t> cycles;
    for (std::uint32_t pe = 0; pe < m.pes; ++pe) {
        const std::uint64_t all_cycles = cycles_of(raya_share_size(raya_share_of(m, pe)));
        cycles.push_back(all_cycles * (side + 1) / RAYA_SIDES - all_cycles * side / RAYA_SIDES);
    }
    return load_of(std::move(cycles));
}

// `slice`: name of the slice of a side's moves. `count`: name of the slice's argument with the number of moves.
struct MoveNames {
    const char *slice, *count;
};
constexpr std::array<MoveNames, 3> kMoves = {  // in the order of ExchangeMethod
    {{"rotate", "rotations"}, {"send over the bus", "transfers"}, {"broadcast from each PE", "broadcasts"}}};

void add_smoothing(RingTimeline& timeline, const RingSettings& s, const RingResult& r, double communication_ms) {
    const bool filter = s.antialias.method == AntialiasMethod::kFilter;
    const MoveNames& names = kMoves[static_cast<std::size_t>(s.antialias.exchange)];
    const MovesOfSides moves_of_sides = smoothing_moves(s.antialias, s.mapping);
    const auto all_moves = static_cast<double>(std::max<std::uint64_t>(1, sum_of(moves_of_sides)));
    const std::uint64_t bands = (r.pe_memory.block_pixels + r.pe_memory.band_pixels - 1) / r.pe_memory.band_pixels;
    for (std::uint32_t side = 0; side < RAYA_SIDES; ++side) {
        const std::uint64_t moves = moves_of_sides[side] * bands;
        if (moves > 0)
            timeline.add_common_phase(fmt::format("{}, for neighbours {}", names.slice, kSides[side]),
                                      communication_ms * static_cast<double>(moves_of_sides[side]) / all_moves,
                                      {{names.count, moves}},
                                      s.antialias.exchange == ExchangeMethod::kRing ? moves : 1);
        timeline.add_compute_phase(fmt::format("{} {}", filter ? "filter" : "compare", kSides[side]),
                                   quarter_load(s.mapping, filter ? filter_cycles : compare_cycles, side));
    }
}

}  // namespace

void add_ring_machine(TraceFile& trace, const RingSettings& settings, const RingResult& result, std::size_t pes) {
    std::vector<Load> loads;
    for (const Phase& phase : result.phases) loads.push_back(phase.load);
    const Communication& c = result.communication;
    if (pes == 0) {
        trace.metadata()["machine"] = "left out: the number of PEs to trace is 0";
        return;
    }
    const ModelledTime time = modelled_time(
        settings.machine.clock, loads, c, smoothing_cycles(settings.antialias.method, largest_share(settings.mapping)));
    RingTimeline timeline(trace, settings.machine, traced_pes(result.all.load.per_pe, pes));
    timeline.add_common_phase("broadcast", time.objects_ms, {{"words", c.broadcast_words}});
    timeline.add_tracing_phase(result.phases[0].name, result.phases[0].load);
    if (settings.antialias.method != AntialiasMethod::kNone)
        add_smoothing(timeline, settings, result, time.communication_ms);
    if (result.phases.size() > 1) timeline.add_tracing_phase(result.phases[1].name, result.phases[1].load);
    timeline.add_common_phase("gather", time.image_ms, {{"words", c.gather_words}});
    if (time.display_ms > 0) timeline.add_common_phase("display", time.display_ms, Json::object());
    trace.metadata()["machine"] = {{"name", settings.machine.name},
                                   {"modelled_ms", time.total_ms},
                                   {"pes", settings.mapping.pes},
                                   {"note",
                                    "modelled time, from time 0 of the trace; independent of the measured times "
                                    "above"}};
}

}  // namespace raya
