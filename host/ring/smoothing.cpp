#include "host/ring/smoothing.hpp"

#include <utility>

namespace raya {

RingFilter::RingFilter(Kernels& kernels, const ExchangeSetup& setup)
    : setup_(setup),
      add_neighbours_(kernels.get<AddNeighboursKernel>()),
      take_means_(kernels.get<TakeMeansKernel>()),
      sums_(setup.session.buffer<float>("filter sums", 3ull * setup.pes.count * setup.capacity)) {
    Buffer<float> no_blocks = setup.session.buffer<float>("no blocks", 3);
    add_neighbours("warm-up", {no_blocks, RAYA_LEFT, 0, 0}, 0, 0);
    setup.session.launch("warm-up", take_means_, setup.pes.count, setup.group_size, setup.broadcast,
                         Uint<"capacity">{0}, Uint<"first_pe">{0}, sums_);
}

void RingFilter::apply(Buffer<float>& pixels, NeighbourExchange& exchange) {
    const SpanLog::Span span = setup_.session.span("filter");
    sum_two_sides(pixels, exchange, "filter.sum_rows", RAYA_LEFT, RAYA_RIGHT);
    sum_two_sides(pixels, exchange, "filter.sum_columns", RAYA_ABOVE, RAYA_BELOW);
    setup_.session.launch("filter.take_means", take_means_, setup_.pes.count, setup_.group_size, setup_.broadcast,
                          Uint<"capacity">{setup_.capacity}, Uint<"first_pe">{setup_.pes.first}, pixels);
}

// Computes pixels = (pixels + neighbours on the first side) + neighbours on the second side. The rounded sum depends on
// the order, so the sides are exchanged one after the other.
void RingFilter::sum_two_sides(Buffer<float>& pixels, NeighbourExchange& exchange, const std::string& label,
                               raya_u32 first_side, raya_u32 second_side) {
    setup_.session.copy("filter.begin_sums", pixels, 0, sums_, 0, pixels.size());
    for (const raya_u32 side : {first_side, second_side})
        exchange.visit(pixels, {side}, [&](const Arrival& arrival) {
            add_neighbours(label, arrival, exchange.band(), setup_.capacity);
        });
    std::swap(pixels, sums_);
}

void RingFilter::add_neighbours(const std::string& label, const Arrival& arrival, std::uint32_t band,
                                std::uint32_t capacity) {
    setup_.session.launch(label, add_neighbours_, setup_.pes.count, setup_.group_size, setup_.broadcast,
                          Uint<"side">{arrival.side}, Uint<"distance">{arrival.distance}, Uint<"begin">{arrival.begin},
                          Uint<"band">{band}, Uint<"capacity">{capacity}, Uint<"first_pe">{setup_.pes.first},
                          arrival.blocks, sums_);
}

RingContrast::RingContrast(Kernels& kernels, const ExchangeSetup& setup, float threshold)
    : setup_(setup),
      threshold_(threshold),
      mark_contrasts_(kernels.get<MarkContrastsKernel>()),
      marks_(setup.session.buffer<std::uint8_t>("marks", std::size_t{setup.pes.count} * setup.capacity)) {
    Buffer<float> no_blocks = setup.session.buffer<float>("no blocks", 3);
    mark_contrasts("warm-up", {no_blocks, RAYA_LEFT, 0, 0}, 0, 0, no_blocks);
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
