// The trace kernel: built for a job and a device, and launched in slices.
#pragma once
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "host/files/progress.hpp"
#include "host/kernels/kernels.hpp"
#include "host/ring/antialias.hpp"
#include "host/ring/pe_segment.hpp"
#include "host/scene/packer.hpp"

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

/// Pixels of each share that one launch traces: `most`; where somebody watches how far it has come, `first` and then as
/// many, from `least` on, as half a second is enough for.
struct LaunchSlices {
    std::uint32_t first = 0, least = 0, most = 0;
};

using TraceKernel = DescribedKernel<"ring/trace.cl", "trace", const Buffer<std::uint32_t>&, Uint<"word_count">,
                                    Uint<"block">, Uint<"capacity">, Uint<"begin">, Uint<"end">, Uint<"points">,
                                    Uint<"first_pe">, const Buffer<std::uint8_t>&, LocalMemory<std::uint32_t>,
                                    Buffer<float>&, Buffer<std::uint64_t>&, Buffer<std::uint64_t>&>;

class Tracer {
  public:
    /// `pes` are on the device; `capacity`: pixels in the memory of each PE.
    Tracer(Kernels& kernels, const PeSegment& pes, std::uint32_t capacity, const LaunchSlices& slices);

    /// Counters of a pass, all 0.
    PassCounters make_counters(const std::string& pass) const;
    void clear(PassCounters& counters);

    /// One launch for no pixels: PoCL compiles a kernel's body at its first launch, and this counts as building.
    void warm_up(const Buffer<std::uint32_t>& job, const Buffer<std::uint8_t>& marks, Buffer<float>& pixels,
                 PassCounters& counters);

    /// Traces `points` (RAYA_POINTS_*) of the range's pixels, of those marked only where the points are new ones. Every
    /// command is labelled `label`. `job` has been broadcast.
    void trace(const std::string& label, const Buffer<std::uint32_t>& job, PixelRange range, raya_u32 points,
               const Buffer<std::uint8_t>& marks, Buffer<float>& pixels, PassCounters& counters,
               const ProgressCallback& progress = {});

    const KernelOptions& options() const { return options_; }
    const std::string& build_options() const { return build_options_; }

  private:
    void launch(const std::string& label, const Buffer<std::uint32_t>& job, PixelRange range, raya_u32 points,
                const Buffer<std::uint8_t>& marks, Buffer<float>& pixels, PassCounters& counters);

    Session& session_;
    KernelOptions options_;
    PeSegment pes_;
    std::uint32_t capacity_;
    LaunchSlices slices_;
    std::string build_options_;
    TraceKernel kernel_;
};

}  // namespace raya
