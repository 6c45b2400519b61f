#include "host/ring/mapping.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <limits>
#include <numeric>

#include "host/error.hpp"

namespace raya {
namespace {

// Returns the divisor of `side` that is nearest to `wanted`; the smaller one in a tie.
std::uint32_t nearest_divisor(std::uint32_t side, std::uint32_t wanted) {
    const auto distance = [&](std::uint32_t d) { return d < wanted ? wanted - d : d - wanted; };
    std::uint32_t nearest = 1;
    for (std::uint32_t d = 2; d <= side; ++d)
        if (side % d == 0 && distance(d) < distance(nearest)) nearest = d;
    return nearest;
}

void check_tiles(const raya_mapping& m) {
    const std::uint32_t w = raya_first_of(m.parameter), h = raya_second_of(m.parameter);
    if (m.width % w == 0 && m.height % h == 0) return;
    throw UserError(
        fmt::format("--mapping {}: tiles must divide the image of {} x {} pixels; the nearest are tiles:{}x{}",
                    mapping_text(m), m.width, m.height, nearest_divisor(m.width, w), nearest_divisor(m.height, h)));
}

void check_pes(const MappingRule& rule, const raya_mapping& m) {
    const std::uint32_t pixels = m.width * m.height, required_pes = rule.pes().value_or(m.pes);
    if (required_pes > pixels && rule.pes())
        throw UserError(fmt::format("--mapping {}: {} PEs: must be 1..{}, at most one for each pixel",
                                    mapping_text(rule), required_pes, pixels));
    if (required_pes != m.pes)
        throw UserError(fmt::format("--pes {} with --mapping {}: this mapping has {} PEs; omit --pes, or use {}", m.pes,
                                    mapping_text(rule), required_pes, required_pes));
    if (m.pes < 1 || m.pes > pixels)
        throw UserError(fmt::format("--pes {}: must be 1..{}, at most one for each pixel", m.pes, pixels));
}

void check_offset(const raya_mapping& m) {
    if (m.parameter < m.width) return;
    throw UserError(fmt::format("--mapping {}: the offset must be 0..{}, less than the image's width", mapping_text(m),
                                m.width - 1));
}

}  // namespace

raya_mapping make_mapping(const MappingRule& rule, const ImageSize& image, std::uint32_t pes) {
    const auto [width, height] = image;
    if (width < 1 || width > kMaxSide || height < 1 || height > kMaxSide)
        throw UserError(fmt::format("--size {}x{}: both sides must be 1..{} pixels", width, height, kMaxSide));
    const raya_mapping mapping{width, height, pes, rule.parameter, rule.kind};
    check_pes(rule, mapping);
    if (rule.kind == RAYA_TILES) check_tiles(mapping);
    if (rule.has_slots()) check_offset(mapping);
    return mapping;
}

std::string mapping_text(const MappingRule& rule) {
    const std::uint32_t first = raya_first_of(rule.parameter), second = raya_second_of(rule.parameter);
    switch (rule.kind) {
        case RAYA_ROWS:
            return "rows";
        case RAYA_BLOCKS:
            return "blocks";
        case RAYA_GRID:
            return fmt::format("grid:{}x{}", first, second);
        case RAYA_TILES:
            return fmt::format("tiles:{}x{}", first, second);
        case RAYA_RANDOM:
            return fmt::format("random:{}", rule.parameter);
        default:
            return fmt::format("cyclic:{}", rule.parameter);
    }
}

std::string mapping_text(const raya_mapping& mapping) {
    return mapping_text(MappingRule{mapping.kind, mapping.parameter});
}

std::uint32_t largest_share(const raya_mapping& mapping) {
    std::uint32_t largest = 0;
    for (std::uint32_t pe = 0; pe < mapping.pes; ++pe)
        largest = std::max(largest, raya_share_size(raya_share_of(mapping, pe)));
    return largest;
}

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
