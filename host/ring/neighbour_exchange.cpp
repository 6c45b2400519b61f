#include "host/ring/neighbour_exchange.hpp"

#include <algorithm>

namespace raya {
namespace {

constexpr std::size_t kColours = 3;

}  // namespace

NeighbourExchange::NeighbourExchange(Session& session, Communication& communication, const raya_mapping& mapping,
                                     std::uint32_t capacity, std::uint32_t band, ExchangeMethod method, Ranks& ranks)
    : pes_(mapping.pes),
      capacity_(capacity),
      band_(band),
      method_(method),
      ring_(session, communication, mapping.pes, kColours, band, ranks),
      bus_(session, communication, mapping.pes, ranks) {
    for (raya_u32 side = 0; side < RAYA_SIDES; ++side) distances_[side] = neighbour_distances(mapping, side);
    if (method == ExchangeMethod::kBroadcast)
        broadcast_blocks_ = session.buffer<float>("blocks that were broadcast", std::size_t{pes_} * kColours * band);
}

void NeighbourExchange::visit(const Buffer<float>& pixels, std::initializer_list<raya_u32> sides,
                              const ArrivalCallback& on_arrival) {
    for (std::uint32_t begin = 0; begin < capacity_; begin += band_) {
        if (method_ == ExchangeMethod::kBroadcast) exchange_by_broadcast(pixels, sides, begin, on_arrival);
        for (const raya_u32 side : sides) {
            if (method_ == ExchangeMethod::kRing) exchange_by_rotation(pixels, side, begin, on_arrival);
            if (method_ == ExchangeMethod::kBus) exchange_by_transfers(pixels, side, begin, on_arrival);
        }
    }
}

// Rotates the ring along the shortest route, and reports an arrival at each stop.
void NeighbourExchange::exchange_by_rotation(const Buffer<float>& pixels, raya_u32 side, std::uint32_t begin,
                                             const ArrivalCallback& on_arrival) {
    for (const Leg& leg : shortest_route(pes_, distances_[side])) {
        ring_.load(pixels, capacity_, begin);
        std::uint32_t rotations = 0;
        for (const std::uint32_t stop : leg.stops) {
            for (; rotations < stop; ++rotations) ring_.rotate(leg.direction);
            on_arrival({ring_.blocks(), side, leg.direction == RingDirection::kDown ? stop : pes_ - stop, begin});
        }
    }
}

// For each distance, sends the block of PE (i + distance) mod P over the bus to each PE i.
void NeighbourExchange::exchange_by_transfers(const Buffer<float>& pixels, raya_u32 side, std::uint32_t begin,
                                              const ArrivalCallback& on_arrival) {
    for (const std::uint32_t distance : distances_[side]) {
        if (distance == 0) ring_.load(pixels, capacity_, begin);
        for (std::size_t pe = 0; distance > 0 && pe < pes_; ++pe)
            bus_.send(pixels, {(pe + distance) % pes_, capacity_, begin, kColours}, ring_.blocks(),
                      {pe, band_, 0, kColours}, band_pixels(begin));
        on_arrival({ring_.blocks(), side, distance, begin});
    }
}

// Broadcasts the block of each PE in turn. Broadcasts nothing if every PE itself owns all its pixels' neighbours.
void NeighbourExchange::exchange_by_broadcast(const Buffer<float>& pixels, std::initializer_list<raya_u32> sides,
                                              std::uint32_t begin, const ArrivalCallback& on_arrival) {
    const bool any_distant = std::ranges::any_of(
        sides, [&](raya_u32 side) { return !distances_[side].empty() && distances_[side].back() > 0; });
    for (std::size_t pe = 0; any_distant && pe < pes_; ++pe)
        bus_.broadcast_from(pixels, {pe, capacity_, begin, kColours}, *broadcast_blocks_, {pe, band_, 0, kColours},
                            band_pixels(begin));
    for (const raya_u32 side : sides)
        for (const std::uint32_t distance : distances_[side]) {
            distance == 0 ? ring_.load(pixels, capacity_, begin) : ring_.take(*broadcast_blocks_, distance);
            on_arrival({ring_.blocks(), side, distance, begin});
        }
}

// Returns the number of pixels of the band that starts at `begin`; the last band may be shorter.
std::size_t NeighbourExchange::band_pixels(std::uint32_t begin) const { return std::min(band_, capacity_ - begin); }

}  // namespace raya
