#include "host/ring/contrast.hpp"

namespace raya {

RingContrast::RingContrast(Kernels& kernels, const ExchangeSetup& setup, float threshold)
    : setup_(setup),
      threshold_(threshold),
      mark_contrasts_(kernels.get<MarkContrastsKernel>()),
      marks_(setup.session.buffer<std::uint8_t>("marks", std::size_t{setup.pes.count} * setup.capacity)) {
    Buffer<float> none = setup.session.buffer<float>("no blocks", 3);
    mark_contrasts("warm-up", {none, RAYA_LEFT, 0, 0}, 0, 0, none);
}

void RingContrast::apply(const Buffer<float>& pixels, NeighbourExchange& exchange) {
    setup_.session.write("clear marks", marks_, std::vector<std::uint8_t>(marks_.size()));
    exchange.visit(pixels, {RAYA_LEFT, RAYA_RIGHT, RAYA_ABOVE, RAYA_BELOW}, [&](const Arrival& arrival) {
        mark_contrasts("supersample.compare", arrival, exchange.band(), setup_.capacity, pixels);
    });
}

void RingContrast::mark_contrasts(const std::string& label, const Arrival& arrival, std::uint32_t band,
                                  std::uint32_t capacity, const Buffer<float>& pixels) {
    setup_.session.launch(label, mark_contrasts_, setup_.pes.count, setup_.group_size, setup_.broadcast,
                          Uint<"side">{arrival.side}, Uint<"distance">{arrival.distance}, Uint<"begin">{arrival.begin},
                          Uint<"band">{band}, Uint<"capacity">{capacity}, Uint<"first_pe">{setup_.pes.first},
                          threshold_, arrival.blocks, pixels, marks_);
}

}  // namespace raya
