// The 3 x 3 filter over the ring (kernels/ring/filter.cl).
#pragma once
#include "host/ring/exchange_setup.hpp"
#include "host/ring/neighbour_exchange.hpp"

namespace raya {

class RingFilter {
  public:
    /// Builds the kernels, launches each once for nothing (PoCL compiles at the first launch) and takes the device
    /// memory.
    explicit RingFilter(const ExchangeSetup& setup);

    /// Every pixel becomes the mean of its 3 x 3 neighbourhood. `pixels` is [PE][capacity][3]; afterwards it may name
    /// another buffer of that shape.
    void apply(Buffer<float>& pixels, NeighbourExchange& exchange);

  private:
    void sum_line(Buffer<float>& pixels, NeighbourExchange& exchange, const std::string& label, raya_u32 first_side,
                  raya_u32 second_side);
    void add_neighbours(const std::string& label, raya_u32 side, const Arrival& arrival, std::uint32_t band,
                        std::uint32_t capacity);

    ExchangeSetup setup_;
    Program program_;
    Kernel<const Buffer<std::uint32_t>&, cl_uint, cl_uint, cl_uint, cl_uint, cl_uint, const Buffer<float>&,
           Buffer<float>&>
        add_neighbours_;
    Kernel<const Buffer<std::uint32_t>&, cl_uint, Buffer<float>&> take_means_;
    Buffer<float> sums_;  // [PE][capacity][3]
};

}  // namespace raya
