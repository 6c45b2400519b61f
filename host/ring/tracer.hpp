// The trace kernel: built for a job and a device, and launched in slices.
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

/// What one pass counts.
struct PassCounters {
    Buffer<std::uint64_t> cycles;  // [PE][capacity]: modelled cycles of each pixel
    Buffer<std::uint64_t> events;  // [PE][L][RAYA_EVENTS]
};

/// Pixels `begin` to `end` - 1 of each PE's share; they lie in the block whose first pixel has the number `block`.
struct PixelRange {
    std::uint32_t block = 0, begin = 0, end = 0;
};

/// Work of a lane, in tests and steps of its rays, after which a launch ends: `first` for the first launch, `watched`
/// where somebody watches how far it has come; then as much as takes about a second, half of one where it is watched,
/// and never more than `most`.
struct LaunchWork {
    std::uint32_t first = 0, watched = 0, most = 0;
};

using TraceKernel = DescribedKernel<"ring/trace.cl", "trace", const Buffer<std::uint32_t>&, Uint<"word_count">,
                                    Uint<"block">, Uint<"capacity">, Uint<"end">, Uint<"points">, Uint<"first_pe">,
                                    Uint<"work">, const Buffer<std::uint8_t>&, LocalMemory<raya_trace_progress>,
                                    LocalMemory<std::uint32_t>, Buffer<float>&, Buffer<std::uint64_t>&,
                                    Buffer<std::uint64_t>&, Buffer<raya_trace_progress>&, Buffer<std::uint32_t>&>;

class Tracer {
  public:
    /// `pes` are on the device; `capacity`: pixels in the memory of each PE.
    Tracer(Kernels& kernels, const PeSegment& pes, std::uint32_t capacity, const LaunchWork& work);

    /// Counters of a pass, all 0.
    PassCounters make_counters(const std::string& pass) const;
    void clear(PassCounters& counters);

    /// One launch for no pixels: PoCL compiles a kernel's body at its first launch, and this counts as building.
    void warm_up(const Buffer<std::uint32_t>& job, const Buffer<std::uint8_t>& marks, Buffer<float>& pixels,
                 PassCounters& counters);

    /// Traces `points` (RAYA_POINTS_*) of the range's pixels, of those marked only where the points are new ones. Every
    /// command is labelled `label`. `job` has been broadcast. A launch ends by itself after a bounded amount of work,
    /// so that no watchdog ends it; launches follow until all is done. What the host has to do it does `meanwhile`,
    /// once the device has the first of them. DeviceError where the device ends loops even of the smallest launch.
    void trace(const std::string& label, const Buffer<std::uint32_t>& job, PixelRange range, raya_u32 points,
               const Buffer<std::uint8_t>& marks, Buffer<float>& pixels, PassCounters& counters,
               const ProgressCallback& progress = {}, const std::function<void()>& meanwhile = {});

    const KernelOptions& options() const { return options_; }
    const std::string& build_options() const { return build_options_; }

  private:
    /// What a launch is for: the pixels up to the range's end that PEs have not taken yet.
    void launch(const std::string& label, const Buffer<std::uint32_t>& job, PixelRange range, raya_u32 points,
                std::uint32_t work, const Buffer<std::uint8_t>& marks, Buffer<float>& pixels, PassCounters& counters);
    void begin(const std::string& label, std::uint32_t pixel);  // every PE, with that pixel of its share
    struct Standing {
        bool done = false;
        std::uint64_t taken = 0;  // pixels of all PEs since the share's first
        bool cut = false;         // the device has ended loops early
    };
    Standing look(const std::string& label);

    Session& session_;
    KernelOptions options_;
    PeSegment pes_;
    std::uint32_t capacity_;
    LaunchWork work_;
    std::string build_options_;
    TraceKernel kernel_;
    Buffer<raya_trace_progress> progress_;  // [PE]
    Buffer<std::uint32_t> kept_;            // what work-items go on with in the next launch
    LaunchGuard<raya_trace_progress, std::uint32_t, float, std::uint64_t, std::uint64_t> guard_;
};

}  // namespace raya
