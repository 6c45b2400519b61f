// Preparation of a render on a ring machine: the user's settings, the settings that raya chooses, and the packed scene.
#pragma once
#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "host/array/render.hpp"
#include "host/base/log.hpp"
#include "host/cl/commands.hpp"
#include "host/cl/device.hpp"
#include "host/cl/kernel_options.hpp"
#include "host/model/machine.hpp"
#include "host/ranks/ranks.hpp"
#include "host/ring/bus_and_ring.hpp"
#include "host/scene/packer.hpp"
#include "host/scene/scene.hpp"
#include "kernels/shared/mapping.h"
#include "kernels/shared/trace_progress.h"

namespace raya {

// Plan of a PE's memory: the contents, and the number of the PE's pixels that fit at a time. A PE of the ring machine
// can access only its own memory.

/// Contents of the memory of each PE. A word has 4 bytes.
struct PeMemory {
    std::uint64_t job_words = 0;     // number of words of the job or, if the objects are divided, of its base
    std::uint64_t part_words = 0;    // number of words of a part of divided objects, stored twice: one is in transit
    std::uint64_t tree_words = 0;    // number of words of one ray tree's state
    std::uint32_t trees = 1;         // number of ray trees in flight; 1 if each PE has all objects
    std::uint32_t block_pixels = 0;  // number of traced pixels that are not gathered yet, 3 words each
    std::uint32_t sum_pixels = 0;    // number of filter sums, 3 words each
    std::uint32_t band_pixels = 0;   // number of pixels received from another PE, 3 words each
    std::uint32_t marks = 0;         // number of marks for supersampling, one byte each

    std::uint64_t bytes() const {
        return 4 * (job_words + 2 * part_words + tree_words * trees +
                    3ull * (block_pixels + sum_pixels + band_pixels)) +
               marks;
    }
};

/// Properties of a render that determine a PE's memory.
struct PeDemand {
    std::string scene;               // name of the scene, for messages
    std::uint64_t job_words = 0;     // see PeMemory
    std::uint32_t parts = 1;         // number of parts of the objects
    std::uint64_t part_words = 0;    // see PeMemory; 0 for one part
    bool divisible = false;          // the objects may be divided into more parts
    std::uint32_t bounces = 0;       // maximum number of reflections and refractions after the primary ray
    std::uint32_t share_pixels = 0;  // maximum number of pixels that a PE owns
    AntialiasMethod antialias = AntialiasMethod::kNone;
};

/// Plans the memory of each PE. Without anti-aliasing, block_pixels is the whole share if the share fits. Otherwise it
/// is the number of pixels that fit, and the image is gathered block by block. (The paper's run on one PE, 256 x 256
/// pixels with 32 KB, requires this.) With anti-aliasing, each PE holds its whole share with sums or marks, and
/// band_pixels is the number of pixels that fit, reduced so that all bands have about the same length. With divided
/// objects, the rest holds as many ray trees in flight as fit, at most one for each pixel of the share. Throws
/// DoesNotFit, with the required and available bytes and a remedy, if not even one pixel of the block or band fits.
PeMemory plan_pe_memory(const Machine& machine, const PeDemand& demand);

/// Settings of a render on a ring machine.
struct RingSettings : RenderSettings {
    std::optional<DynamicPlan> dynamic;  // dynamic distribution, whose loads are simulated from the pixels' costs
    raya_mapping mapping{};              // image size, number of PEs, and owner of each pixel
    Antialias antialias;
    // Rays of neighbouring pixels descend through the BVH together, which takes less time. Only rays and their hits are
    // counted then, because the numbers of steps and tests would depend on the neighbours. See use_packets().
    bool packets = false;
    bool record_costs = false;  // record each pixel's cost, which takes 8 bytes of host memory; implied by `dynamic`
    Accel accel;
    // Maximum number of pixels of all PEs that the device holds at a time, 20 bytes each. With anti-aliasing the device
    // holds all pixels.
    std::uint64_t device_pixels = 1 << 22;
    // Number of parts G of the objects, which rotate on the ring; a divisor of the number of PEs. 1: every PE stores
    // all objects; 0: the smallest number with which the scene fits a PE.
    std::uint32_t split = 0;
};

/// Sets settings.packets if that is possible: in fp32 with a BVH, if the mapping is tiles, so that the lanes hold
/// neighbouring pixels. If `may_change_mapping`, first chooses small tiles that divide the image, if there are any.
void use_packets(RingSettings& settings, bool may_change_mapping);

/// Returns the properties of a render that determine a PE's memory. `scene`: name of the scene, for messages.
/// `job_words`: number of words of the job.
PeDemand pe_demand(const RingSettings& settings, const std::string& scene, std::uint64_t job_words);

/// Throws UserError if the objects cannot be divided into settings.split parts.
void check_split(const RingSettings& settings);

/// Returns the settings with the number of lanes and the group size chosen for the device. Throws UserError if the
/// kernels cannot be built with these settings. Call it before packing the scene, so that raya fails early.
RingSettings checked_settings(RingSettings settings, const DeviceInfo& device);

/// Work of one lane in the first launch, in tests and traversal steps of the lane's rays: `first`, or `with_progress`
/// if progress is shown. Later launches take about `target_s` seconds, or half of them if progress is shown.
struct LaunchWork {
    std::uint32_t first = 0, with_progress = 0;
    double target_s = 1;
};

/// Returns the work of the first launch: about a quarter of a second on two CPU cores, and at least a pixel of each
/// lane. `objects`: number of objects of the scene; `pes`: number of PEs on this device.
LaunchWork launch_work(const RingSettings& settings, const KernelOptions& options, std::size_t objects,
                       std::uint32_t pes);

/// Returns the kernel options for the packed job. `pe_words`: number of its words that a PE stores at a time; `accel`:
/// summary of the accelerator that settings.accel selects.
KernelOptions kernel_options(const RingSettings& settings, const PackedJob& job, std::size_t pe_words,
                             const AccelSummary& accel, const DeviceInfo& device);

/// What is known of a packed job besides its words.
struct JobFigures {
    AccelSummary accel;
    double accel_s = 0;  // measured build time of the accelerator, seconds
    LengthScale scale;
    std::uint64_t objects = 0;  // number of objects of the scene
    bool has_patches = false;
};

/// A packed job with its grid or BVH.
struct RingJob : JobFigures {
    PackedJob job;
};

/// Packs a scene for the ring machine, with its mapping but without an accelerator.
PackedJob pack_for_ring(const Scene& scene, const RingSettings& settings, const LengthScale& scale);

/// Builds the accelerator of settings.accel, which must not be kNone, and appends it to the job.
AccelSummary append_accel(PackedJob& job, const RingSettings& settings);

/// Collective: rank 0 packs the scene, calls `packed` if it is not empty, and sends the job to all ranks. After the
/// call of `packed` the scene's objects are not used. Other ranks do not use `scene`.
RingJob make_ring_job(const Session& session, const Scene& scene, const RingSettings& settings, Ranks& ranks,
                      const std::function<void()>& packed = {});

// The trace kernel: its build for a job and a device, and its launches, each of which does a bounded amount of work.

/// Counters of one pass over the image (tracing or supersampling).
struct PassCounters {
    Buffer<std::uint64_t> cycles;  // [PE][capacity]: modelled cycles of each pixel
    Buffer<std::uint64_t> events;  // [PE][L][RAYA_EVENTS]; L: work-items of a PE
    // With divided objects: modelled cycles of each turn, if each step of a turn waits for the busiest PE of all ranks.
    std::vector<std::uint64_t> turn_cycles{};
};

/// Pixels begin .. end - 1 of each PE's share. `window_start`: index in the share of the first pixel that is in
/// the device buffers.
struct PixelRange {
    std::uint32_t window_start = 0, begin = 0, end = 0;
};

/// A pass, or a part of it, over the pixels of the PEs on a device.
struct TracePass {
    std::string label;                  // of the commands
    const Buffer<std::uint32_t>& job;   // the broadcast words
    PixelRange range;                   // the pixels
    raya_u32 points;                    // RAYA_POINTS_*: sample points; supersampling points only of marked pixels
    const Buffer<std::uint8_t>& marks;  // [PE][capacity]
    Buffer<float>& pixels;              // [PE][3][capacity]
    PassCounters& counters;
};

using TraceKernel =
    DescribedKernel<"ring/trace.cl", "trace", const Buffer<std::uint32_t>&, Uint<"word_count">, Uint<"window_start">,
                    Uint<"capacity">, Uint<"end">, Uint<"points">, Uint<"first_pe">, Uint<"work">,
                    const Buffer<std::uint8_t>&, LocalMemory<raya_trace_progress>, LocalMemory<std::uint32_t>,
                    Buffer<float>&, Buffer<std::uint64_t>&, Buffer<std::uint64_t>&, Buffer<raya_trace_progress>&,
                    Buffer<std::uint32_t>&>;

/// Traces sample points of the pixels of all PEs on a device.
class SampleTracer {
  public:
    virtual ~SampleTracer() = default;

    /// Allocates the counters of a pass.
    PassCounters make_counters(const std::string& pass) const;
    void clear(PassCounters& counters);

    /// Launches the kernels once with an empty range, so that their compilation, which PoCL does at the first launch,
    /// counts as build time.
    virtual void warm_up(const TracePass& pass) = 0;

    /// Traces a pass. Each launch does a bounded amount of work, so that no GPU watchdog ends it; launches are repeated
    /// until all pixels are traced. Throws DeviceError if the device ends loops early even in the smallest launch.
    virtual void trace(const TracePass& pass, const ProgressCallback& progress) = 0;

    const KernelOptions& options() const { return options_; }
    const std::string& build_options() const { return build_options_; }

  protected:
    /// `pes`: PEs on this device; `capacity`: number of pixels of each PE in the device buffers.
    SampleTracer(Kernels& kernels, std::string build_options, const Distribution& pes, std::uint32_t capacity);

    /// Sets the next pixel of every PE to the first of the range.
    void reset_progress(const TracePass& pass);
    /// Reads the progress of all PEs in the range, and calls `progress` if it is not empty.
    LaunchEnd read_progress(const TracePass& pass, const ProgressCallback& progress);

    Session& session_;
    KernelOptions options_;
    std::string build_options_;
    Distribution pes_;
    std::uint32_t capacity_;
    Buffer<raya_trace_progress> progress_;  // [PE]
};

/// Traces with the whole job in every PE (kernels/ring/trace.cl).
class Tracer : public SampleTracer {
  public:
    Tracer(Kernels& kernels, const Distribution& pes, std::uint32_t capacity, const LaunchWork& work);

    void warm_up(const TracePass& pass) override;
    void trace(const TracePass& pass, const ProgressCallback& progress) override;

  private:
    /// Launches the kernel for those pixels of the range that have not been traced.
    void launch(const TracePass& pass, std::uint32_t work);

    LaunchWork work_;
    TraceKernel kernel_;
    Buffer<std::uint32_t> saved_trees_;  // unfinished ray trees, which the next launch continues
    LaunchLoop<raya_trace_progress, std::uint32_t, float, std::uint64_t, std::uint64_t> launches_{
        "fewer tests of a ray (--accel bvh or grid), other --lanes or --group"};
};

}  // namespace raya
