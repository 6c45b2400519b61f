#include "host/ring/neighbour_exchange.hpp"

#include <algorithm>

namespace raya {
namespace {

constexpr std::size_t kColours = 3;

}  // namespace

NeighbourExchange::NeighbourExchange(Session& session, Communication& counted, const raya_mapping& mapping,
                                     std::uint32_t capacity, std::uint32_t band, ExchangeWay way, Ranks& ranks)
    : pes_(mapping.pes),
      capacity_(capacity),
      band_(band),
      way_(way),
      ring_(session, counted, mapping.pes, kColours, band, ranks),
      bus_(session, counted, mapping.pes, ranks) {
    for (raya_u32 side = 0; side < RAYA_SIDES; ++side) distances_[side] = neighbour_distances(mapping, side);
    if (way == ExchangeWay::kBroadcast)
        heard_ = session.buffer<float>("blocks that were broadcast", std::size_t{pes_} * kColours * band);
}

void NeighbourExchange::visit(const Buffer<float>& own, std::initializer_list<raya_u32> sides, const Arrived& arrived) {
    for (std::uint32_t begin = 0; begin < capacity_; begin += band_) {
        if (way_ == ExchangeWay::kBroadcast) hear(own, sides, begin, arrived);
        for (const raya_u32 side : sides) {
            if (way_ == ExchangeWay::kRing) turn(own, side, begin, arrived);
            if (way_ == ExchangeWay::kBus) fetch(own, side, begin, arrived);
        }
    }
}

// Round the ring, the shortest way past all PEs that have neighbours.
void NeighbourExchange::turn(const Buffer<float>& own, raya_u32 side, std::uint32_t begin, const Arrived& arrived) {
    for (const Leg& leg : shortest_route(pes_, distances_[side])) {
        ring_.load(own, capacity_, begin);
        std::uint32_t turns = 0;
        for (const std::uint32_t stop : leg.stops) {
            for (; turns < stop; ++turns) ring_.rotate(leg.turn);
            arrived({ring_.blocks(), side, leg.turn == Turn::kDown ? stop : pes_ - stop, begin});
        }
    }
}

// From PE to PE: to each in turn from the one that is so far away.
void NeighbourExchange::fetch(const Buffer<float>& own, raya_u32 side, std::uint32_t begin, const Arrived& arrived) {
    for (const std::uint32_t distance : distances_[side]) {
        if (distance == 0) ring_.load(own, capacity_, begin);
        for (std::size_t pe = 0; distance > 0 && pe < pes_; ++pe)
            bus_.send(own, {(pe + distance) % pes_, capacity_, begin, kColours}, ring_.blocks(),
                      {pe, band_, 0, kColours}, pixels_from(begin));
        arrived({ring_.blocks(), side, distance, begin});
    }
}

// From each PE in turn to all, where one of them needs what another has.
void NeighbourExchange::hear(const Buffer<float>& own, std::initializer_list<raya_u32> sides, std::uint32_t begin,
                             const Arrived& arrived) {
    const bool needed = std::ranges::any_of(
        sides, [&](raya_u32 side) { return !distances_[side].empty() && distances_[side].back() > 0; });
    for (std::size_t pe = 0; needed && pe < pes_; ++pe)
        bus_.broadcast_from(own, {pe, capacity_, begin, kColours}, *heard_, {pe, band_, 0, kColours},
                            pixels_from(begin));
    for (const raya_u32 side : sides)
        for (const std::uint32_t distance : distances_[side]) {
            distance == 0 ? ring_.load(own, capacity_, begin) : ring_.take(*heard_, distance);
            arrived({ring_.blocks(), side, distance, begin});
        }
}

// Of a band, as many as there are.
std::size_t NeighbourExchange::pixels_from(std::uint32_t begin) const { return std::min(band_, capacity_ - begin); }

}  // namespace raya
