// Results of a render on a ring machine: image, counts and measurements.
#pragma once
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "host/array/render.hpp"
#include "host/model/t805.hpp"
#include "host/report/render_report.hpp"
#include "host/report/trace_file.hpp"
#include "host/ring/mapping.hpp"
#include "host/ring/ring_plan.hpp"

namespace raya {

/// Names of the phases, also used as labels of their device commands.
inline constexpr const char *kTracePass = "trace", *kSupersamplePass = "supersample";

/// Counts of one phase of a render.
struct Phase {
    std::string name;                          // kTracePass, kSupersamplePass
    EventCounts events{}, rank_events{};       // of all ranks; of this rank
    Load load{};                               // modelled cycles of each PE, from the PE's counters
    std::optional<CostImage> recorded_cost{};  // only with RingSettings::record_costs
    std::vector<std::uint64_t> turn_cycles{};  // of each turn, see PassCounters

    /// Modelled cycles of each pixel. Throws std::logic_error if they were not recorded.
    const CostImage& cost() const;
    /// Modelled cycles of the phase: of the busiest PE or, with divided objects, of the busiest PE in each step.
    std::uint64_t barrier_cycles() const;
};

struct RingResult : RenderResult {
    std::vector<Phase> phases;              // the first pass, and supersampling if selected
    std::optional<CostImage> sum_cost;      // sums of Phase::recorded_cost, if there are several phases (see cost())
    Image mask;                             // 1 for supersampled pixels, else 0; empty without supersampling
    std::uint64_t recomputed = 0;           // number of supersampled pixels
    std::uint64_t rank_recomputed = 0;      // number of supersampled pixels of this rank's PEs
    std::optional<std::uint64_t> requests;  // number of requests in a simulated dynamic distribution
    Communication communication;
    PeMemory pe_memory;
    std::uint32_t parts = 1;            // number G of parts of the objects
    std::optional<AccelSummary> accel;  // summary of the grid or BVH
    bool words_local = true;            // in each launch the PEs copied the job's words into local memory
    std::uint32_t first_pe = 0;         // of this rank
    double accel_s = 0;                 // measured build time of the grid or BVH, seconds

    /// Modelled cycles of each pixel in all phases. Throws std::logic_error if they were not recorded.
    const CostImage& cost() const { return sum_cost ? *sum_cost : phases.front().cost(); }
    /// Number of turns of divided objects.
    std::uint64_t turns() const;
};

/// Returns the modelled time of a render.
ModelledTime ring_time(const RingSettings& settings, const RingResult& result);

/// Returns the device time, in seconds, of all commands that trace rays; render_s if the device does not time its
/// commands.
double trace_seconds(const RingResult& result);

/// Returns the arithmetic operations and memory traffic of each kernel of this rank, by label, including kernels that
/// did not run. The bytes are lower bounds:
///   - trace, supersample: each launch reads the job's words once for every PE that copies them, and reads and writes
///     the counters. It writes 12 bytes of colour and 8 bytes of cycles for each traced pixel. Supersampling also reads
///     a mark of each pixel and the colour of each marked pixel. Words that a kernel reads without copying (--accel
///     grid) are not included.
///   - for each neighbour of each pixel, filter.sum_* reads its colour and the pixel's sum and writes the sum;
///     supersample.compare reads both colours. For each pixel, filter.take_means reads the sum and writes the mean.
std::vector<KernelWork> ring_kernel_work(const RingSettings& settings, const RingResult& result);

/// Adds the modelled run of the machine to a trace, from time 0 on: a track for the machine's phases and a track for
/// each of `pes` selected PEs (host/report/trace_file.hpp). The phases are broadcast, trace, rotations (or bus
/// transfers) and sums or comparisons, supersampling, gather. In the tracing phases each PE waits for the busiest PE.
/// Counters: live rays (one for each PE that traces) and the imbalance u of the phase. The times are those of
/// modelled_time() (host/model/t805.hpp) and end at its total. Each phase is shown as a whole, even if a PE's
/// memory holds only a block of its share, and each side of the neighbourhood shows a quarter of the cycles of
/// filtering or comparing. If `pes` is 0, adds only a remark to the metadata.
void add_ring_machine(TraceFile& trace, const RingSettings& settings, const RingResult& result, std::size_t pes);

// The ring machine's part of a render report.

/// Returns accelerator, anti-aliasing, communication, operations and modelled time.
MachineReport ring_report(const RingSettings& settings, const RingResult& result);

/// Lists the members of the ring machine's part of a render report.
void ring_members(Members& m, const RingSettings& settings, const RingResult& result, const ModelledTime& time);

}  // namespace raya
