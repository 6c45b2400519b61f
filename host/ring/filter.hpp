// The 3 x 3 filter over ring or bus (kernels/ring/filter.cl).
#pragma once
#include "host/cl/kernels.hpp"
#include "host/ring/exchange_setup.hpp"
#include "host/ring/neighbour_exchange.hpp"

namespace raya {

using AddNeighboursKernel = DescribedKernel<"ring/filter.cl", "add_neighbours", const Buffer<std::uint32_t>&,
                                            Uint<"side">, Uint<"distance">, Uint<"begin">, Uint<"band">,
                                            Uint<"capacity">, Uint<"first_pe">, const Buffer<float>&, Buffer<float>&>;
using TakeMeansKernel = DescribedKernel<"ring/filter.cl", "take_means", const Buffer<std::uint32_t>&, Uint<"capacity">,
                                        Uint<"first_pe">, Buffer<float>&>;

class RingFilter {
  public:
    /// Takes the kernels, which are for one lane, launches each once for nothing (PoCL compiles at the first launch)
    /// and takes the device memory.
    RingFilter(Kernels& kernels, const ExchangeSetup& setup);

    /// Every pixel becomes the mean of its 3 x 3 neighbourhood. `pixels` is [PE][3][capacity]; afterwards it may name
    /// another buffer of that shape.
    void apply(Buffer<float>& pixels, NeighbourExchange& exchange);

  private:
    void sum_line(Buffer<float>& pixels, NeighbourExchange& exchange, const std::string& label, raya_u32 first_side,
                  raya_u32 second_side);
    void add_neighbours(const std::string& label, const Arrival& arrival, std::uint32_t band, std::uint32_t capacity);

    ExchangeSetup setup_;
    AddNeighboursKernel add_neighbours_;
    TakeMeansKernel take_means_;
    Buffer<float> sums_;  // [PE][3][capacity]
};

}  // namespace raya
