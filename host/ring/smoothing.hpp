// The parts of anti-aliasing that need neighbouring pixels: the 3 x 3 filter (kernels/ring/filter.cl), and the
// detection of pixels that differ from a neighbour (kernels/ring/contrast.cl).
#pragma once
#include <cstdint>
#include <span>

#include "host/cl/commands.hpp"
#include "host/cl/kernels.hpp"
#include "host/ring/bus_and_ring.hpp"
#include "host/ring/neighbour_exchange.hpp"

namespace raya {

/// Arguments that all launches of RingFilter and RingContrast have in common.
struct ExchangeSetup {
    Session& session;
    Buffer<std::uint32_t> broadcast;  // the job's words
    PeSegment pes;                    // PEs on the device
    std::uint32_t capacity = 0;       // number of pixels in the memory of each PE
    std::uint32_t group_size = 1;
};

using AddNeighboursKernel = DescribedKernel<"ring/filter.cl", "add_neighbours", const Buffer<std::uint32_t>&,
                                            Uint<"side">, Uint<"distance">, Uint<"begin">, Uint<"band">,
                                            Uint<"capacity">, Uint<"first_pe">, const Buffer<float>&, Buffer<float>&>;
using TakeMeansKernel = DescribedKernel<"ring/filter.cl", "take_means", const Buffer<std::uint32_t>&, Uint<"capacity">,
                                        Uint<"first_pe">, Buffer<float>&>;

class RingFilter {
  public:
    /// The kernels must be built for one lane. Allocates the device memory, and launches each kernel once without
    /// pixels, because PoCL compiles a kernel at its first launch.
    RingFilter(Kernels& kernels, const ExchangeSetup& setup);

    /// Replaces every pixel by the mean of its 3 x 3 neighbourhood. `pixels`: [PE][3][capacity]; afterwards `pixels`
    /// refers to another buffer of the same size.
    void apply(Buffer<float>& pixels, NeighbourExchange& exchange);

  private:
    void sum_two_sides(Buffer<float>& pixels, NeighbourExchange& exchange, const std::string& label,
                       raya_u32 first_side, raya_u32 second_side);
    void add_neighbours(const std::string& label, const Arrival& arrival, std::uint32_t band, std::uint32_t capacity);

    ExchangeSetup setup_;
    AddNeighboursKernel add_neighbours_;
    TakeMeansKernel take_means_;
    Buffer<float> sums_;  // [PE][3][capacity]
};

using MarkContrastsKernel =
    DescribedKernel<"ring/contrast.cl", "mark_contrasts", const Buffer<std::uint32_t>&, Uint<"side">, Uint<"distance">,
                    Uint<"begin">, Uint<"band">, Uint<"capacity">, Uint<"first_pe">, cl_float, const Buffer<float>&,
                    const Buffer<float>&, Buffer<std::uint8_t>&>;

class RingContrast {
  public:
    /// The kernel must be built for one lane. Allocates the device memory, and launches the kernel once without pixels,
    /// because PoCL compiles a kernel at its first launch. `threshold`, 0..1, must be representable in the number
    /// format.
    RingContrast(Kernels& kernels, const ExchangeSetup& setup, float threshold);

    /// Marks each pixel that differs from a neighbour by the threshold or more. `pixels`: [PE][3][capacity].
    void apply(const Buffer<float>& pixels, NeighbourExchange& exchange);

    /// [PE][capacity]: 1 for marked pixels, else 0.
    const Buffer<std::uint8_t>& marks() const { return marks_; }

    /// Restores the marks of a checkpoint.
    void set_marks(std::span<const std::uint8_t> marks) { setup_.session.write("set marks", marks_, marks); }

  private:
    void mark_contrasts(const std::string& label, const Arrival& arrival, std::uint32_t band, std::uint32_t capacity,
                        const Buffer<float>& pixels);

    ExchangeSetup setup_;
    float threshold_;
    MarkContrastsKernel mark_contrasts_;
    Buffer<std::uint8_t> marks_;
};

}  // namespace raya
