// The trace kernel: its build for a job and a device, and its launches, each of which does a bounded amount of work.
#pragma once
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "host/base/progress.hpp"
#include "host/cl/kernels.hpp"
#include "host/ring/antialias.hpp"
#include "host/ring/bus_and_ring.hpp"
#include "host/scene/packer.hpp"
#include "kernels/shared/trace_progress.h"

namespace raya {

/// Counters of one pass over the image (tracing or supersampling).
struct PassCounters {
    Buffer<std::uint64_t> cycles;  // [PE][capacity]: modelled cycles of each pixel
    Buffer<std::uint64_t> events;  // [PE][L][RAYA_EVENTS]; L: work-items of a PE
};

/// Pixels begin .. end - 1 of each PE's share. `window_start`: index in the share of the first pixel that is in
/// the device buffers.
struct PixelRange {
    std::uint32_t window_start = 0, begin = 0, end = 0;
};

/// Limits of the work of one lane in one launch, in tests and traversal steps of the lane's rays. The first launch has
/// the limit `first`, or `with_progress` if progress is shown. The work of later launches is scaled so that a launch
/// takes one second, or half a second if progress is shown, but is at most `max`.
struct LaunchWork {
    std::uint32_t first = 0, with_progress = 0, max = 0;
};

using TraceKernel =
    DescribedKernel<"ring/trace.cl", "trace", const Buffer<std::uint32_t>&, Uint<"word_count">, Uint<"window_start">,
                    Uint<"capacity">, Uint<"end">, Uint<"points">, Uint<"first_pe">, Uint<"work">,
                    const Buffer<std::uint8_t>&, LocalMemory<raya_trace_progress>, LocalMemory<std::uint32_t>,
                    Buffer<float>&, Buffer<std::uint64_t>&, Buffer<std::uint64_t>&, Buffer<raya_trace_progress>&,
                    Buffer<std::uint32_t>&>;

class Tracer {
  public:
    /// `pes`: PEs on this device; `capacity`: number of pixels of each PE in the device buffers.
    Tracer(Kernels& kernels, const PeSegment& pes, std::uint32_t capacity, const LaunchWork& work);

    /// Allocates the counters of a pass.
    PassCounters make_counters(const std::string& pass) const;
    void clear(PassCounters& counters);

    /// Launches the kernel once without pixels, so that its compilation, which PoCL does at the first launch, counts as
    /// build time.
    void warm_up(const Buffer<std::uint32_t>& job, const Buffer<std::uint8_t>& marks, Buffer<float>& pixels,
                 PassCounters& counters);

    /// Traces the sample points `points` (RAYA_POINTS_*) of the range's pixels; supersampling points only of the marked
    /// pixels. `label`: label of the commands; `job`: the broadcast words. Each launch does a bounded amount of work,
    /// so that no GPU watchdog ends it; launches are repeated until all pixels are traced. Calls `host_work` on the
    /// host while the first launch runs. Throws DeviceError if the device ends loops early even in the smallest launch.
    void trace(const std::string& label, const Buffer<std::uint32_t>& job, PixelRange range, raya_u32 points,
               const Buffer<std::uint8_t>& marks, Buffer<float>& pixels, PassCounters& counters,
               const ProgressCallback& progress = {}, const std::function<void()>& host_work = {});

    const KernelOptions& options() const { return options_; }
    const std::string& build_options() const { return build_options_; }

  private:
    /// Launches the kernel for those pixels of the range that have not been traced.
    void launch(const std::string& label, const Buffer<std::uint32_t>& job, PixelRange range, raya_u32 points,
                std::uint32_t work, const Buffer<std::uint8_t>& marks, Buffer<float>& pixels, PassCounters& counters);
    /// Sets the next pixel of every PE to index `pixel` of its share.
    void reset_progress(const std::string& label, std::uint32_t pixel);
    struct State {
        bool done = false;
        std::uint64_t next_pixels = 0;  // sum, over all PEs, of the index of the next pixel to trace in the share
        bool truncated = false;         // the device has ended loops early, so results are wrong
    };
    State read_state(const std::string& label);

    Session& session_;
    KernelOptions options_;
    PeSegment pes_;
    std::uint32_t capacity_;
    LaunchWork work_;
    std::string build_options_;
    TraceKernel kernel_;
    Buffer<raya_trace_progress> progress_;  // [PE]
    Buffer<std::uint32_t> saved_trees_;     // unfinished ray trees, which the next launch continues
    LaunchGuard<raya_trace_progress, std::uint32_t, float, std::uint64_t, std::uint64_t> guard_;
};

}  // namespace raya
