#include "host/ring/route.hpp"

#include <algorithm>
#include <limits>
#include <numeric>

namespace raya {
namespace {

// Names of the methods, in the order of ExchangeMethod.
constexpr std::array<const char*, 3> kExchangeNames = {"ring", "bus", "bus-broadcast"};

std::uint64_t moves_of_side(const raya_mapping& mapping, ExchangeMethod method, raya_u32 side) {
    const std::vector<std::uint32_t> distances = neighbour_distances(mapping, side);
    const auto distant_count = static_cast<std::uint64_t>(
        std::ranges::count_if(distances, [](std::uint32_t distance) { return distance > 0; }));
    if (method == ExchangeMethod::kBus) return distant_count * mapping.pes;
    if (method == ExchangeMethod::kBroadcast) return distant_count > 0 ? mapping.pes : 0;
    std::uint64_t rotations = 0;
    for (const Leg& leg : shortest_route(mapping.pes, distances)) rotations += leg.rotations();
    return rotations;
}

}  // namespace

std::vector<std::uint32_t> neighbour_distances(const raya_mapping& mapping, raya_u32 side) {
    std::vector<bool> found(mapping.pes);
    for (std::uint32_t row = 0; row < mapping.height; ++row)
        for (std::uint32_t column = 0; column < mapping.width; ++column) {
            const raya_pixel pixel = {row, column};
            if (!raya_has_neighbour(mapping, pixel, side)) continue;
            const raya_pixel adjacent = raya_neighbour(pixel, side);
            const std::uint32_t neighbour_owner = raya_owner(mapping, adjacent.row, adjacent.column);
            const std::uint32_t owner = raya_owner(mapping, row, column);
            found[neighbour_owner >= owner ? neighbour_owner - owner : neighbour_owner + (mapping.pes - owner)] = true;
        }
    std::vector<std::uint32_t> distances;
    for (std::uint32_t d = 0; d < mapping.pes; ++d)
        if (found[d]) distances.push_back(d);
    return distances;
}

std::vector<Leg> shortest_route(std::uint32_t pes, const std::vector<std::uint32_t>& distances) {
    if (distances.empty()) return {};
    // Downward rotations fetch the blocks at the first `down_count` distances, upward rotations the remaining
    // blocks. A block at distance d arrives after d downward or P - d upward rotations. The loop tries every split.
    std::size_t down_count = 0;
    std::uint64_t min_rotations = std::numeric_limits<std::uint64_t>::max();
    for (std::size_t n = 0; n <= distances.size(); ++n) {
        const std::uint64_t downwards = n ? distances[n - 1] : 0,
                            upwards = n < distances.size() ? pes - distances[n] : 0;
        if (downwards + upwards < min_rotations) {
            min_rotations = downwards + upwards;
            down_count = n;
        }
    }
    const auto split = distances.begin() + static_cast<std::ptrdiff_t>(down_count);
    std::vector<Leg> legs;
    if (down_count > 0) legs.push_back({RingDirection::kDown, {distances.begin(), split}});
    if (split != distances.end()) legs.push_back({RingDirection::kUp, {}});
    for (auto d = distances.end(); d != split;) legs.back().stops.push_back(pes - *--d);
    return legs;
}

std::string exchange_name(ExchangeMethod method) { return kExchangeNames.at(static_cast<std::size_t>(method)); }

MovesOfSides exchange_moves(const raya_mapping& mapping, ExchangeMethod method, bool any_order) {
    MovesOfSides moves{};
    for (raya_u32 side = 0; side < RAYA_SIDES; ++side) {
        const bool already_served = method == ExchangeMethod::kBroadcast && any_order && sum_of(moves) > 0;
        if (!already_served) moves[side] = moves_of_side(mapping, method, side);
    }
    return moves;
}

std::uint64_t sum_of(const MovesOfSides& moves) {
    return std::accumulate(moves.begin(), moves.end(), std::uint64_t{0});
}

}  // namespace raya
