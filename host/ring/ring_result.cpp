#include "host/ring/ring_result.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <stdexcept>

#include "host/model/budget.hpp"
#include "host/model/number_format.hpp"
#include "host/ring/mapping.hpp"

namespace raya {
namespace {

constexpr std::uint64_t kColourBytes = 3 * sizeof(float);

// Returns the bytes of all launches with this label, except those of pixels: the job's words, if PEs copy them, and the
// counters, which are read and written.
std::uint64_t launch_bytes(const RingResult& r, const std::string& label) {
    const std::uint64_t words = r.words_local ? r.pe_memory.job_words * r.parts_of_rank : 0;
    const std::uint64_t counters = std::uint64_t{r.parts_of_rank} * r.group_size * RAYA_EVENTS;
    // With divided objects, one launch of each turn reads and writes the counters.
    const std::uint64_t launches = r.launches(label) / (r.parts > 1 ? r.parts + 1 : 1);
    return launches * (sizeof(std::uint32_t) * words + 2 * sizeof(std::uint64_t) * counters);
}

// `pixels`: number of pixels of this rank.
KernelWork trace_work(const RingResult& r, const Phase& phase, std::uint64_t pixels, bool first_pass) {
    KernelWork work = work_of(phase.name, phase.rank_events);
    const std::uint64_t written_bytes =
        (kColourBytes + sizeof(std::uint64_t)) * (first_pass ? pixels : r.rank_recomputed);
    const std::uint64_t read_bytes = first_pass ? 0 : pixels + kColourBytes * r.rank_recomputed;
    work.bytes = launch_bytes(r, phase.name) + written_bytes + read_bytes;
    return work;
}

// Numbers of this rank's pixels, and of pairs of such a pixel and its left or right neighbour, and of such a pixel and
// its upper or lower neighbour.
struct RankPixels {
    std::uint64_t pixels = 0, horizontal_pairs = 0, vertical_pairs = 0;
};

RankPixels pixels_of_rank(const raya_mapping& m, const RingResult& r) {
    RankPixels own;
    for (std::uint32_t i = 0; i < r.parts_of_rank; ++i) own.pixels += raya_share_size(raya_share_of(m, r.first_pe + i));
    const auto is_own = [&](std::uint32_t row, std::uint32_t column) {
        const std::uint32_t pe = raya_owner(m, row, column);
        return pe >= r.first_pe && pe < r.first_pe + r.parts_of_rank;
    };
    own.horizontal_pairs = own.vertical_pairs = 2 * own.pixels;  // less those of pixels at the image's borders
    for (std::uint32_t row = 0; row < m.height; ++row)
        own.horizontal_pairs -= is_own(row, 0) + is_own(row, m.width - 1);
    for (std::uint32_t column = 0; column < m.width; ++column)
        own.vertical_pairs -= is_own(0, column) + is_own(m.height - 1, column);
    return own;
}

// Returns the work of a kernel that, for each of `pixels` pixels, does `operations` operations on each of three colour
// components and reads or writes `colours` colours.
KernelWork neighbour_work(const std::string& label, std::uint64_t pixels, std::uint64_t operations,
                          std::uint64_t colours) {
    return {.label = label, .operations = 3 * operations * pixels, .bytes = colours * kColourBytes * pixels};
}

}  // namespace

const CostImage& Phase::cost() const {
    if (!recorded_cost) throw std::logic_error("the costs of pixels were not recorded: set RingSettings::record_costs");
    return *recorded_cost;
}

std::uint64_t Phase::barrier_cycles() const { return turn_cycles.empty() ? load.max : sum_of(turn_cycles); }

std::uint64_t RingResult::turns() const {
    std::uint64_t turns = 0;
    for (const Phase& phase : phases) turns += phase.turn_cycles.size();
    return turns;
}

ModelledTime ring_time(const RingSettings& settings, const RingResult& result) {
    std::vector<Load> loads;
    SmoothingCycles cycles = smoothing_cycles(settings.antialias.method, largest_share(settings.mapping));
    for (const Phase& phase : result.phases) {
        loads.push_back(phase.load);
        cycles.wait += phase.barrier_cycles() - phase.load.max;
    }
    return modelled_time(settings.machine.clock, loads, result.communication, cycles);
}

double trace_seconds(const RingResult& result) {
    double ns = 0;
    for (const LabelSummary& command : result.commands)
        if (command.label == kTracePass || command.label == kSupersamplePass)
            ns += static_cast<double>(command.total_ns);
    return ns > 0 ? ns * 1e-9 : result.render_s;
}

std::vector<KernelWork> ring_kernel_work(const RingSettings& settings, const RingResult& result) {
    std::vector<KernelWork> works;
    const RankPixels own = pixels_of_rank(settings.mapping, result);
    for (std::size_t i = 0; i < result.phases.size(); ++i)
        works.push_back(trace_work(result, result.phases[i], own.pixels, i == 0));
    if (settings.antialias.method == AntialiasMethod::kFilter) {
        works.push_back(neighbour_work("filter.sum_rows", own.horizontal_pairs, 1, 3));
        works.push_back(neighbour_work("filter.sum_columns", own.vertical_pairs, 1, 3));
        works.push_back(neighbour_work("filter.take_means", own.pixels, 1, 2));
    }
    // Operations per component, as in compare_cycles(): 4 to clamp both colours to 0..1, 1 difference, 1 comparison.
    if (settings.antialias.method == AntialiasMethod::kSupersample)
        works.push_back(neighbour_work("supersample.compare", own.horizontal_pairs + own.vertical_pairs, 4 + 1 + 1, 2));
    return works;
}

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

    // Adds a phase in which each PE computes for its own number of cycles, then waits for the busiest PE. If the
    // objects are divided, all PEs wait for each other after each part.
    void add_compute_phase(const Phase& phase) {
        const Load& load = phase.load;
        const std::vector<std::uint64_t>& turns = phase.turn_cycles;
        const double begin = now_ms_;
        const auto busiest = std::max_element(load.per_pe.begin(), load.per_pe.end()) - load.per_pe.begin();
        const Json arguments = {
            {"u", load.imbalance}, {"mean_cycles", load.mean}, {"max_cycles", load.max}, {"busiest", busiest}};
        trace_.counter(kTraceMachine, "u", nanoseconds(begin), {{"u", load.imbalance}});
        const std::uint64_t all = phase.barrier_cycles();
        add_phase(phase.name, cycle_ms_ * static_cast<double>(all), arguments);
        double turn_begin = begin;
        for (std::size_t i = 0; i < turns.size(); ++i) {
            const double turn_end = turn_begin + cycle_ms_ * static_cast<double>(turns[i]);
            trace_.slice(kPhases, fmt::format("turn {}", i + 1), nanoseconds(turn_begin),
                         std::min(nanoseconds(turn_end), nanoseconds(now_ms_)), {{"cycles", turns[i]}});
            turn_begin = turn_end;
        }
        const std::string wait = turns.empty() ? fmt::format("wait for PE {}", busiest) : "wait for other PEs";
        for (const TracedPe& p : pes_) {
            const std::uint64_t cycles = load.per_pe[p.pe];
            const std::uint64_t done = nanoseconds(begin + cycle_ms_ * static_cast<double>(cycles));
            if (cycles > 0) trace_.slice(track_of(p), phase.name, nanoseconds(begin), done, {{"cycles", cycles}});
            if (cycles < all) trace_.slice(track_of(p), wait, done, nanoseconds(now_ms_), {{"cycles", all - cycles}});
        }
    }

    // Adds a tracing phase with a counter of live rays. A PE of this machine traces one ray at a time, so the number of
    // live rays is the number of PEs that are tracing; with divided objects, of PEs that would be without waiting. The
    // counter has at most kMaxPoints points after the first point.
    void add_tracing_phase(const Phase& phase) {
        constexpr std::size_t kMaxPoints = 512;
        std::vector<std::uint64_t> ends = phase.load.per_pe;
        std::sort(ends.begin(), ends.end());
        const std::size_t step = (ends.size() + kMaxPoints - 1) / kMaxPoints;
        add_live_rays(0, static_cast<double>(ends.end() - std::upper_bound(ends.begin(), ends.end(), 0u)));
        for (std::size_t i = 0; i < ends.size(); i += step) {
            const std::size_t last = std::min(i + step, ends.size()) - 1;
            if (ends[last] > 0) add_live_rays(ends[last], static_cast<double>(ends.size() - 1 - last));
        }
        add_compute_phase(phase);
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

// Names of the slice of a side's moves, and of the slice's argument with their number, in the order of ExchangeMethod.
constexpr std::pair<const char*, const char*> kMoves[] = {
    {"rotate", "rotations"}, {"send over the bus", "transfers"}, {"broadcast from each PE", "broadcasts"}};

void add_smoothing(RingTimeline& timeline, const RingSettings& s, const RingResult& r, double communication_ms) {
    const bool filter = s.antialias.method == AntialiasMethod::kFilter;
    const auto& [slice, count] = kMoves[static_cast<std::size_t>(s.antialias.exchange)];
    const MovesOfSides moves_of_sides = smoothing_moves(s.antialias, s.mapping);
    const auto all_moves = static_cast<double>(std::max<std::uint64_t>(1, sum_of(moves_of_sides)));
    const std::uint64_t bands = (r.pe_memory.block_pixels + r.pe_memory.band_pixels - 1) / r.pe_memory.band_pixels;
    for (std::uint32_t side = 0; side < RAYA_SIDES; ++side) {
        const std::uint64_t moves = moves_of_sides[side] * bands;
        if (moves > 0)
            timeline.add_common_phase(fmt::format("{}, for neighbours {}", slice, kSides[side]),
                                      communication_ms * static_cast<double>(moves_of_sides[side]) / all_moves,
                                      {{count, moves}}, s.antialias.exchange == ExchangeMethod::kRing ? moves : 1);
        timeline.add_compute_phase({.name = fmt::format("{} {}", filter ? "filter" : "compare", kSides[side]),
                                    .load = quarter_load(s.mapping, filter ? filter_cycles : compare_cycles, side)});
    }
}

double recomputed_share(const RingResult& result) {
    return static_cast<double>(result.recomputed) / (1.0 * result.image.width * result.image.height);
}

void antialias_members(Members& m, const RingSettings& settings, const RingResult& result) {
    const Antialias& a = settings.antialias;
    const bool smooths = a.method != AntialiasMethod::kNone, supersamples = a.method == AntialiasMethod::kSupersample;
    m("method", antialias_name(a.method), "Method, as given to --antialias.");
    m.when(smooths, "exchange", exchange_name(a.exchange), "Way of neighbouring pixels to a PE (--exchange).");
    m.when(smooths, "band_pixels", result.pe_memory.band_pixels, "Number of pixels that a PE sends in one transfer.");
    m.when(supersamples, "threshold", a.threshold, "Difference of colours from which on a pixel is supersampled.");
    m.when(supersamples, "points", points_name(a.points),
           "Positions of the additional samples: `axes` or `diagonals`.");
    m.when(supersamples, "recomputed_pixels", result.recomputed, "Number of supersampled pixels.");
    m.when(supersamples, "recomputed_share", recomputed_share(result), "Supersampled pixels / all pixels.");
}

void communication_members(Members& m, const Communication& c) {
    m("broadcasts", c.broadcasts, "Number of broadcasts from the host to all PEs.");
    m("broadcast_words", c.broadcast_words, "Number of words in these broadcasts.");
    m("rotations", c.rotations, "Number of rotations. In a rotation every PE sends its block to its neighbour.");
    m("rotation_words", c.rotation_words, "Number of words that all PEs together sent in these rotations.");
    m("transfers", c.transfers, "Number of transfers from one PE to another PE over the bus.");
    m("transfer_words", c.transfer_words, "Number of words in these transfers.");
    m("pe_broadcasts", c.pe_broadcasts, "Number of broadcasts from one PE to all other PEs over the bus.");
    m("pe_broadcast_words", c.pe_broadcast_words, "Number of words in these broadcasts.");
    m("gathers", c.gathers, "Number of gathers from all PEs to the host.");
    m("gather_words", c.gather_words, "Number of words in these gathers.");
}

void split_members(Members& m, const RingResult& result) {
    m("parts", result.parts, "Number G of parts. PE i starts with part i mod G.");
    m("part_words", result.pe_memory.part_words, "Number of words of the largest part.");
    m("trees", result.pe_memory.trees,
      "Number of ray trees that fit a PE's memory; each has at most one ray in flight, "
      "and the shadow rays of one hit.");
    m("turns", result.turns(),
      "Number of turns. In a turn the parts rotate G - 1 times, and each ray meets each part.");
    m("resumed", result.events[RAYA_RESUMED], "Number of rays that PEs took up to test a part.");
    std::uint64_t cycles = 0;
    for (const Phase& phase : result.phases) cycles += phase.barrier_cycles();
    m("barrier_cycles", cycles, "Modelled cycles of all turns, if each step of a turn waits for the busiest PE.");
}

void accel_members(Members& m, const std::optional<AccelSummary>& accel) {
    const AccelSummary a = accel.value_or(AccelSummary{});
    const bool grid = a.kind == AccelKind::kGrid, bvh = a.kind == AccelKind::kBvh;
    m("kind",
      bvh    ? "bvh"
      : grid ? "grid"
             : "none",
      "`none` (every ray is tested against all objects), `grid` (uniform), or `bvh` (bounding volume hierarchy).");
    m.when(grid, "divisions", a.divisions, "Numbers of voxels along x, y and z.");
    m.when(grid, "copies", a.copies, "Number of entries in voxel lists beyond the first entry of each object.");
    m.when(bvh, "nodes", a.nodes, "Number of nodes.");
    m.when(bvh, "leaves", a.leaves, "Number of leaves.");
    m.when(bvh, "depth", a.depth, "Number of nodes on the longest path from the BVH's root node to a leaf.");
    m.when(grid || bvh, "words", a.words, "Size of the acceleration structure in 32-bit words.");
    m.when(grid || bvh, "apart", a.separate, "Separate objects, against which every ray is tested.");
}

// The numbers of operations of all events, according to the instruction budget of the modelled PEs.
void budget_members(Members& m, const EventCounts& events) {
    const Operations sum = operations_of(events);
    m("multiply_accumulates", sum.multiply_accumulates,
      "Additions, multiplications, comparisons, multiply-accumulates.");
    m("divisions", sum.divisions, "Number of divisions.");
    m("roots", sum.roots, "Number of square roots.");
    m("moves", sum.moves, "Number of moves that cost a cycle because no arithmetic runs in parallel.");
    m("branches", sum.branches, "Number of conditional branches, calls and returns.");
}

void time_members(Members& m, const ModelledTime& time) {
    m("objects", time.objects_ms, "Time of the broadcast of the scene, ms.");
    m("compute", time.compute_ms, "Computation time of the busiest PE, summed over the phases, ms.");
    m("filter", time.filter_ms, "Part of `compute` in which the PEs average neighbouring pixels, ms.");
    m("compare", time.compare_ms, "Part of `compute` in which the PEs compare neighbouring pixels, ms.");
    m.when(time.wait_ms > 0, "wait", time.wait_ms,
           "Part of `compute` in which the busiest PE waits for other PEs after each part of divided objects, ms.");
    m("communication", time.communication_ms,
      "Time of the rotations of the ring and of the transfers and broadcasts between PEs over the bus, ms.");
    m("image", time.image_ms, "Time of the transfer of the image to the host, ms.");
    m("display", time.display_ms, "Time of the display of the image, ms.");
    m("total", time.total_ms, "objects + compute + communication + image + display, ms.");
    m("factor", time.factor, "Number of the machine's cycles per cycle of the budgets, included in the compute times.");
}

std::string antialias_lines(const RingSettings& settings, const RingResult& result) {
    const Antialias& a = settings.antialias;
    if (a.method == AntialiasMethod::kNone) return {};
    std::string text;
    if (a.method == AntialiasMethod::kSupersample)
        text += fmt::format("super   {} pixels ({:.1f} %) recomputed from 4 more points each, threshold {}\n",
                            result.recomputed, 100 * recomputed_share(result), a.threshold);
    if (result.phases.size() > 1)
        for (const Phase& phase : result.phases) text += load_line("  " + phase.name.substr(0, 5), phase.load);
    const Communication& c = result.communication;
    if (a.exchange == ExchangeMethod::kBus)
        return text +
               fmt::format("bus     {} between PEs, {} words\n", counted(c.transfers, "transfer"), c.transfer_words);
    if (a.exchange == ExchangeMethod::kBroadcast)
        return text + fmt::format("bus     {} by PEs, {} words\n", counted(c.pe_broadcasts, "broadcast"),
                                  c.pe_broadcast_words);
    return text + fmt::format("ring    {}, {} words\n", counted(c.rotations, "rotation"), c.rotation_words);
}

std::string split_line(const RingSettings& settings, const RingResult& r) {
    if (r.parts == 1) return {};
    return fmt::format("split   {} parts of at most {} words{}, {} of {}, {} in flight in each PE\n", r.parts,
                       r.pe_memory.part_words, settings.split ? "" : " (the fewest that fit)",
                       counted(r.turns(), "turn"), counted(r.parts - 1, "rotation"),
                       counted(r.pe_memory.trees, "tree"));
}

std::string model_line(const ModelledTime& t, const std::string& machine) {
    return fmt::format(
        "model   objects {}, compute {}, communication {}, image {}, display {}: {} (modelled time of {})\n",
        time_text(t.objects_ms), time_text(t.compute_ms), time_text(t.communication_ms), time_text(t.image_ms),
        time_text(t.display_ms), time_text(t.total_ms), machine);
}

std::string accel_line(const RingResult& r, bool all_counted) {
    if (!r.accel) return {};
    const AccelSummary& a = *r.accel;
    const auto rays = static_cast<double>(ray_count(r.events));
    const std::string tests = all_counted ? fmt::format("; {:.1f} tests and {:.1f} {} a ray",
                                                        static_cast<double>(test_count(r.events)) / rays,
                                                        static_cast<double>(r.events[RAYA_STEPS]) / rays,
                                                        a.kind == AccelKind::kBvh ? "nodes" : "steps")
                                          : "";
    const std::string separate = a.separate ? fmt::format(", {} listed separately", a.separate) : "";
    if (a.kind == AccelKind::kBvh)
        return fmt::format("bvh     {}, {}, depth {}{}{}\n", counted(a.nodes, "node"),
                           counted(a.leaves, "leaf", "leaves"), a.depth, separate, tests);
    return fmt::format("grid    {}x{}x{} voxels, {} of objects{}{}\n", a.divisions[0], a.divisions[1], a.divisions[2],
                       counted(a.copies, "copy", "copies"), separate, tests);
}

}  // namespace

void add_ring_machine(TraceFile& trace, const RingSettings& settings, const RingResult& result, std::size_t pes) {
    const Communication& c = result.communication;
    if (pes == 0) {
        trace.metadata()["machine"] = "left out: the number of PEs to trace is 0";
        return;
    }
    const ModelledTime time = ring_time(settings, result);
    RingTimeline timeline(trace, settings.machine, traced_pes(result.load.per_pe, pes));
    timeline.add_common_phase("broadcast", time.objects_ms, {{"words", c.broadcast_words}});
    const bool smoothed = settings.antialias.method != AntialiasMethod::kNone;
    constexpr std::uint64_t kMaxShown = 4096;  // rotations that are slices of their own
    const MachineClock& clock = settings.machine.clock;
    const auto rotations_of = [&](const Phase& phase) { return phase.turn_cycles.size() * (result.parts - 1); };
    const auto rotation_ms = [&](const Phase& phase) {  // of the parts, without a set-up
        const auto words = static_cast<double>(rotations_of(phase) * result.pe_memory.part_words);
        return rotations_of(phase) ? exchange_ms(clock, rotations_of(phase), words) - clock.setup_ms : 0;
    };
    double other_ms = time.communication_ms;
    for (const Phase& phase : result.phases) other_ms -= rotation_ms(phase);
    const auto add_tracing = [&](const Phase& phase, double setup_ms) {
        timeline.add_tracing_phase(phase);
        if (rotations_of(phase))
            timeline.add_common_phase("rotate parts", setup_ms + rotation_ms(phase),
                                      {{"rotations", rotations_of(phase)}},
                                      rotations_of(phase) <= kMaxShown ? rotations_of(phase) : 1);
    };
    add_tracing(result.phases[0], smoothed ? 0 : other_ms);
    if (smoothed) add_smoothing(timeline, settings, result, other_ms);
    if (result.phases.size() > 1) add_tracing(result.phases[1], 0);
    timeline.add_common_phase("gather", time.image_ms, {{"words", c.gather_words}});
    if (time.display_ms > 0) timeline.add_common_phase("display", time.display_ms, Json::object());
    trace.metadata()["machine"] = {{"name", settings.machine.name},
                                   {"modelled_ms", time.total_ms},
                                   {"pes", settings.mapping.pes},
                                   {"note",
                                    "modelled time, from time 0 of the trace; independent of the measured times "
                                    "above"}};
}

MachineReport ring_report(const RingSettings& settings, const RingResult& result) {
    const ModelledTime time = ring_time(settings, result);
    const bool all_counted = !settings.packets;
    Members members(Members::Mode::kWrite);
    ring_members(members, settings, result, time);
    return {.json = members.json(),
            .lines = split_line(settings, result) + antialias_lines(settings, result) +
                     (all_counted ? model_line(time, settings.machine.name) : "") + accel_line(result, all_counted)};
}

void ring_members(Members& m, const RingSettings& settings, const RingResult& result, const ModelledTime& time) {
    m("accel", "Ring machines: acceleration structure.", [&](Members& accel) { accel_members(accel, result.accel); });
    m("antialias", "Ring machines: anti-aliasing between neighbouring pixels.",
      [&](Members& antialias) { antialias_members(antialias, settings, result); });
    m.when(result.parts > 1, "split", "Ring machines: objects in parts that rotate on the ring (--split).",
           [&](Members& split) { split_members(split, result); });
    m("communication",
      "Ring machines: transfers over bus and ring, counted when raya executes them. A word has 32 bits; a number "
      "takes "
      "one word, also in a format of fewer bits.",
      [&](Members& c) { communication_members(c, result.communication); });
    m("budget",
      "Numbers of operations of all counted events: on a ring from the instruction budget of a DSP "
      "(host/model/budget.hpp), on the torus of a T805 (host/model/t805.hpp).",
      [&](Members& budget) { budget_members(budget, result.events); });
    m("modelled_ms",
      "Modelled time of the machine in ms, from its clock (docs/architecture.md). Torus: a real machine is between "
      "`overlapped` and `stepwise` (host/torus/torus_result.hpp).",
      [&](Members& ms) { time_members(ms, time); });
}

}  // namespace raya
