#include "host/ring/exchange_plan.hpp"

#include <algorithm>
#include <numeric>

#include "host/ring/route.hpp"

namespace raya {
namespace {

// In the order of ExchangeWay.
constexpr std::array<const char*, 3> kWays = {"ring", "bus", "bus-broadcast"};

std::uint64_t moves_of_side(const raya_mapping& mapping, ExchangeWay way, raya_u32 side) {
    const std::vector<std::uint32_t> distances = neighbour_distances(mapping, side);
    const auto distant = static_cast<std::uint64_t>(
        std::ranges::count_if(distances, [](std::uint32_t distance) { return distance > 0; }));
    if (way == ExchangeWay::kBus) return distant * mapping.pes;
    if (way == ExchangeWay::kBroadcast) return distant > 0 ? mapping.pes : 0;
    std::uint64_t turns = 0;
    for (const Leg& leg : shortest_route(mapping.pes, distances)) turns += leg.turns();
    return turns;
}

}  // namespace

std::string exchange_name(ExchangeWay way) { return kWays.at(static_cast<std::size_t>(way)); }

MovesOfSides exchange_moves(const raya_mapping& mapping, ExchangeWay way, bool together) {
    MovesOfSides moves{};
    for (raya_u32 side = 0; side < RAYA_SIDES; ++side) {
        const bool served = way == ExchangeWay::kBroadcast && together && sum_of(moves) > 0;
        if (!served) moves[side] = moves_of_side(mapping, way, side);
    }
    return moves;
}

std::uint64_t sum_of(const MovesOfSides& moves) {
    return std::accumulate(moves.begin(), moves.end(), std::uint64_t{0});
}

}  // namespace raya
