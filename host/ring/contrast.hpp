// Marks the pixels that differ from a neighbour, over ring or bus (kernels/ring/contrast.cl).
#pragma once
#include <cstdint>
#include <span>

#include "host/cl/kernels.hpp"
#include "host/ring/exchange_setup.hpp"
#include "host/ring/neighbour_exchange.hpp"

namespace raya {

using MarkContrastsKernel =
    DescribedKernel<"ring/contrast.cl", "mark_contrasts", const Buffer<std::uint32_t>&, Uint<"side">, Uint<"distance">,
                    Uint<"begin">, Uint<"band">, Uint<"capacity">, Uint<"first_pe">, cl_float, const Buffer<float>&,
                    const Buffer<float>&, Buffer<std::uint8_t>&>;

class RingContrast {
  public:
    /// Takes the kernel, which is for one lane, launches it once for nothing (PoCL compiles at the first launch) and
    /// takes the device memory. `threshold` is a number of the format, 0..1.
    RingContrast(Kernels& kernels, const ExchangeSetup& setup, float threshold);

    /// Marks the pixels of `pixels`, [PE][3][capacity].
    void apply(const Buffer<float>& pixels, NeighbourExchange& exchange);

    /// [PE][capacity]: 1 where a pixel is marked, else 0.
    const Buffer<std::uint8_t>& marks() const { return marks_; }

    /// Takes marks that were made before.
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
