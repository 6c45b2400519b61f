// Results of a render on a ring machine: image, counts and measurements.
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

/// Counts of one phase of a render.
struct Phase {
    std::string name;  // kTracePass, kSupersamplePass
    EventCounts events{};
    Load load;                           // modelled cycles of each PE, from its own counters
    std::optional<CostImage> kept_cost;  // only with RingSettings::keep_costs

    /// Modelled cycles of each pixel. Throws std::logic_error if they were not recorded.
    const CostImage& cost() const;
};

struct RingResult {
    Image image;
    std::vector<Phase> phases;              // the first pass, and supersampling if selected
    Phase all;                              // their sums, without the cost if there is one phase (see cost())
    Image mask;                             // 1 where a pixel was supersampled, else 0; empty without supersampling
    std::uint64_t recomputed = 0;           // pixels supersampled
    std::optional<std::uint64_t> requests;  // of a simulated dynamic distribution
    Communication communication;
    LengthScale scale;
    PeMemory pe_memory;
    std::optional<AccelSummary> accel;  // of the grid or BVH
    bool words_local = true;            // PEs copied the broadcast words into local memory at each launch
    std::uint32_t parts_here = 0;       // PEs of this rank
    RankTraffic traffic;                // of this rank during the render
    std::uint32_t lanes = 0, group_size = 0;
    std::string build_options;
    std::string tuned;  // origin of lanes, group size and related settings (host/cl/tuned.hpp)
    // Measured on the host: build of the grid or BVH; kernel build; everything after it.
    double accel_s = 0, build_s = 0, render_s = 0;
    double earlier_s = 0;  // part of render_s spent in earlier runs, before a resume
    std::vector<LabelSummary> commands;

    /// Modelled cycles of each pixel in all phases. Throws std::logic_error if they were not recorded.
    const CostImage& cost() const { return (phases.size() == 1 ? phases.front() : all).cost(); }
};

/// Seconds of tracing one image on the device, or by the host's clock if the device does not time its commands.
double trace_seconds(const RingResult& result);

/// Work of each kernel label, including kernels that did not run. Bytes are lower bounds:
///   - trace, supersample: at each launch the scene's words for every PE that copies them, and counters read and
///     written; for each traced pixel 12 bytes of colour and 8 of cycles written. Supersampling also reads a mark of
///     each pixel and the colour of marked ones. Words that a kernel reads in place (--accel grid) are not included.
///   - sums of neighbours: for each pixel with such a neighbour, its colour and the sum read, the sum written;
///     comparisons: both colours read; means: for each pixel, the sum read and the mean written.
std::vector<KernelWork> ring_kernel_work(const RingSettings& settings, const RingResult& result);

/// Adds a track for the machine's phases and one for each of `pes` PEs (host/report/trace_file.hpp), from time 0 on:
/// broadcast, trace, rotations (or bus transfers) and sums or comparisons, supersampling, gather; each PE waits for the
/// busiest one. Counters: live rays (one for each PE that traces) and u of the phase. The times are those of
/// modelled_time() (host/model/time_model.hpp) and end at its total: phases are shown as a whole even if a PE's memory
/// holds only a block of its share, and each side has a quarter of the arithmetic between neighbours. Adds only a
/// remark to the metadata if the machine's rates are unknown or `pes` is 0.
void add_ring_machine(TraceFile& trace, const RingSettings& settings, const RingResult& result, std::size_t pes);

}  // namespace raya
