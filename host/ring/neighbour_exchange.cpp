#include "host/ring/neighbour_exchange.hpp"

namespace raya {
namespace {

constexpr std::size_t kPixelWords = 3;

}  // namespace

NeighbourExchange::NeighbourExchange(Session& session, Communication& counted, const raya_mapping& mapping,
                                     std::uint32_t capacity, std::uint32_t band)
    : pes_(mapping.pes), capacity_(capacity), band_(band), ring_(session, counted, mapping.pes, kPixelWords * band) {
    for (raya_u32 side = 0; side < RAYA_SIDES; ++side)
        routes_[side] = shortest_route(pes_, neighbour_distances(mapping, side));
}

void NeighbourExchange::visit(const Buffer<float>& own, raya_u32 side,
                              const std::function<void(const Arrival&)>& arrived) {
    for (std::uint32_t begin = 0; begin < capacity_; begin += band_)
        for (const Leg& leg : routes_[side]) travel(own, leg, begin, arrived);
}

void NeighbourExchange::travel(const Buffer<float>& own, const Leg& leg, std::uint32_t begin,
                               const std::function<void(const Arrival&)>& arrived) {
    ring_.load(own, kPixelWords * capacity_, kPixelWords * begin);
    std::uint32_t turns = 0;
    for (const std::uint32_t stop : leg.stops) {
        for (; turns < stop; ++turns) ring_.rotate(leg.turn);
        arrived({ring_.blocks(), leg.turn == Turn::kDown ? stop : pes_ - stop, begin});
    }
}

std::uint64_t NeighbourExchange::rotations() const {
    std::uint64_t turns = 0;
    for (const std::vector<Leg>& route : routes_)
        for (const Leg& leg : route) turns += leg.turns();
    return turns * ((capacity_ + band_ - 1) / band_);
}

}  // namespace raya
