// What a render on a ring machine made, counted and measured.
#pragma once
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "host/cl/profile.hpp"
#include "host/image/image.hpp"
#include "host/model/machine.hpp"
#include "host/model/time_model.hpp"
#include "host/ranks/ranks.hpp"
#include "host/report/roofline.hpp"
#include "host/report/trace_file.hpp"
#include "host/ring/pe_memory.hpp"
#include "host/ring/ring_plan.hpp"
#include "host/ring/schedule.hpp"
#include "host/scene/length_scale.hpp"

namespace raya {

/// Names of the phases, and labels of their commands.
inline constexpr const char *kTracePass = "trace", *kSupersamplePass = "supersample";

/// What was counted in one phase of a render.
struct Phase {
    std::string name;  // kTracePass, kSupersamplePass
    EventCounts events{};
    Load load;                           // modelled cycles of each PE, from its own counters
    std::optional<CostImage> kept_cost;  // where RingSettings::keep_costs asks for it

    /// Modelled cycles of each pixel. std::logic_error where nobody asked for them.
    const CostImage& cost() const;
};

struct RingResult {
    Image image;
    std::vector<Phase> phases;              // the first pass, and supersampling where it was asked for
    Phase all;                              // their sums, but for the cost of a single phase: cost()
    Image mask;                             // 1 where a pixel was supersampled, else 0; empty without supersampling
    std::uint64_t recomputed = 0;           // pixels supersampled
    std::optional<std::uint64_t> requests;  // of a simulated dynamic distribution
    Communication communication;
    LengthScale scale;
    PeMemory pe_memory;
    std::optional<AccelSummary> accel;  // of the grid or tree that rays walked
    bool words_local = true;            // PEs copied the broadcast words into local memory at each launch
    std::uint32_t parts_here = 0;       // PEs of this rank
    RankTraffic traffic;                // of this rank, while it rendered
    std::uint32_t lanes = 0, group_size = 0;
    std::string build_options;
    std::string tuned;  // where lanes, group and what goes with them come from (host/cl/tuned.hpp)
    // Measured on the host: to make the grid or tree; kernel build; everything after it.
    double accel_s = 0, build_s = 0, render_s = 0;
    double earlier_s = 0;  // of render_s what runs took whose state this one went on with
    std::vector<LabelSummary> commands;

    /// Modelled cycles of each pixel in all phases. std::logic_error where nobody asked for them.
    const CostImage& cost() const { return (phases.size() == 1 ? phases.front() : all).cost(); }
};

/// Seconds that tracing one image took on the device; by the host's clock where the device does not time its commands.
double trace_seconds(const RingResult& result);

/// One for each label of a kernel, those that did not run among them. Bytes, at least:
///   - trace, supersample: at each launch the words of the scene, by every PE that copies them into its own memory;
///   counters
///     read and written; of each pixel traced 12 bytes of colour and 8 of cycles written; supersampling also reads a
///     mark of each pixel and the colour of those marked. Words of the scene that a kernel reads again and again
///     where they lie (--accel grid) are not in it.
///   - sums of neighbours: of each pixel that has such a neighbour, its colour and the sum read, the sum written;
///     comparisons: of each, both colours read; means: of each pixel, the sum read and the mean written.
std::vector<KernelWork> ring_kernel_work(const RingSettings& settings, const RingResult& result);

/// A track for the machine's phases and one for each of `pes` PEs (report/traced_pes.hpp), from the trace's time 0 on:
/// broadcast, trace, then rotations (or turns on the bus) and sums or comparisons, supersampling, then gather, each PE
/// waiting for the busiest one. Counters: rays alive, one for each PE that traces, and u of the phase. The times are
/// those of modelled_time() (machine/time_model.hpp), and end at its total: as it does, phases are taken as a whole
/// where a PE's memory holds only a block of its share; and a side's share of the arithmetic between neighbours is a
/// quarter of it. Where the machine's rates are not known, or `pes` is 0, there is no process, and the metadata says
/// why.
void add_ring_machine(TraceFile& trace, const RingSettings& settings, const RingResult& result, std::size_t pes);

}  // namespace raya
