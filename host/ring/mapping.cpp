#include "host/ring/mapping.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <functional>
#include <limits>
#include <numeric>
#include <queue>
#include <stdexcept>
#include <utility>

#include "host/error.hpp"
#include "kernels/shared/share_pixels.h"

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

void check_image(const CostImage& image, std::uint32_t pes) {
    const std::uint64_t pixels = std::uint64_t{image.width} * image.height;
    if (pixels == 0 || image.cycles.size() != pixels)
        throw std::invalid_argument("a cost image must have at least one pixel, and one cost for each pixel");
    if (pes < 1 || pes > pixels) throw std::invalid_argument("the number of PEs must be 1..W * H");
}

void check_mapping(const CostImage& image, const raya_mapping& mapping) {
    check_image(image, mapping.pes);
    if (mapping.width != image.width || mapping.height != image.height)
        throw std::invalid_argument("the mapping has another size than the cost image");
}

/// Adds the cost of each PE's static part to `busy`: the first `fraction` of its pixels, which are not scheduled
/// dynamically. Returns a flag for each pixel of the image: true if the pixel is in a static part.
std::vector<bool> add_static_costs(const CostImage& image, const raya_mapping& static_mapping, double fraction,
                                   std::vector<std::uint64_t>& busy) {
    std::vector<bool> done(image.cycles.size());
    if (fraction == 0) return done;
    for (std::uint32_t pe = 0; pe < static_mapping.pes; ++pe) {
        const raya_share share = raya_share_of(static_mapping, pe);
        const auto pixels = static_cast<std::uint32_t>(fraction * raya_share_size(share));
        for (std::uint32_t k = 0; k < pixels; ++k) {
            const raya_pixel pixel = raya_pixel_of(static_mapping, share, k);
            const std::size_t at = std::size_t{pixel.row} * image.width + pixel.column;
            busy[pe] += image.cycles[at];
            done[at] = true;
        }
    }
    return done;
}

/// Divides the pixels that are not done into chunks of `chunk` pixels, and returns the cost of each chunk without
/// overhead.
std::vector<std::uint64_t> chunk_costs(const CostImage& image, const std::vector<bool>& done, std::uint32_t chunk) {
    std::vector<std::uint64_t> chunks;
    std::uint32_t free_pixels = 0;  // number of pixels that the last chunk can still take
    for (std::size_t at = 0; at < done.size(); ++at) {
        if (done[at]) continue;
        if (free_pixels == 0) {
            chunks.push_back(0);
            free_pixels = chunk;
        }
        chunks.back() += image.cycles[at];
        --free_pixels;
    }
    return chunks;
}

/// Assigns each chunk to the PE that becomes idle first. The root answers one request after another. `finish`:
/// finishing time of each PE, in and out.
void assign_chunks(const std::vector<std::uint64_t>& chunks, const DynamicPlan& plan,
                   std::vector<std::uint64_t>& finish) {
    using IdleTime = std::pair<std::uint64_t, std::uint32_t>;  // time at which a PE becomes idle, PE number
    std::priority_queue<IdleTime, std::vector<IdleTime>, std::greater<>> idle;
    for (std::uint32_t pe = 0; pe < finish.size(); ++pe) idle.emplace(finish[pe], pe);
    std::uint64_t answered = 0;  // time at which the root has answered the previous request
    for (const std::uint64_t cost : chunks) {
        const auto [time, pe] = idle.top();
        idle.pop();
        answered = std::max(answered, time) + plan.root_cycles;
        finish[pe] = (plan.root_cycles > 0 ? answered : time) + plan.overhead + cost;
        idle.emplace(finish[pe], pe);
    }
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

std::string exchange_name(ExchangeMethod method) {
    return std::array{"ring", "bus", "bus-broadcast"}.at(static_cast<std::size_t>(method));
}

MovesOfSides exchange_moves(const raya_mapping& mapping, ExchangeMethod method, bool any_order) {
    MovesOfSides moves{};
    for (raya_u32 side = 0; side < RAYA_SIDES; ++side) {
        const bool already_served = method == ExchangeMethod::kBroadcast && any_order && sum_of(moves) > 0;
        if (!already_served) moves[side] = moves_of_side(mapping, method, side);
    }
    return moves;
}

std::uint64_t sum_of(std::span<const std::uint64_t> numbers) {
    return std::accumulate(numbers.begin(), numbers.end(), std::uint64_t{0});
}

std::string dynamic_text(const DynamicPlan& plan) {
    const std::string root = plan.root_cycles > 0 ? fmt::format(",{}", plan.root_cycles) : "";
    if (plan.static_fraction > 0)
        return fmt::format("hybrid:{},{},{}{}", plan.chunk, plan.overhead, plan.static_fraction, root);
    return plan.overhead > 0 || plan.root_cycles > 0 ? fmt::format("dynamic:{},{}{}", plan.chunk, plan.overhead, root)
                                                     : fmt::format("dynamic:{}", plan.chunk);
}

Load static_load(const CostImage& image, const raya_mapping& mapping) {
    check_mapping(image, mapping);
    std::vector<std::uint64_t> per_pe(mapping.pes);
    std::size_t at = 0;
    for (std::uint32_t row = 0; row < image.height; ++row)
        for (std::uint32_t column = 0; column < image.width; ++column)
            per_pe[raya_owner(mapping, row, column)] += image.cycles[at++];
    return load_of(std::move(per_pe));
}

std::vector<double> imbalance_of_offsets(const CostImage& image, std::uint32_t pes, std::uint32_t fold,
                                         const std::vector<std::uint32_t>& offsets) {
    check_image(image, pes);
    if (fold != RAYA_FOLD_CYCLIC && fold != RAYA_FOLD_BLOCK)
        throw std::invalid_argument(
            "`fold` must be RAYA_FOLD_CYCLIC or RAYA_FOLD_BLOCK: only cyclic mappings have an offset");
    std::vector<double> imbalances;
    for (const std::uint32_t offset : offsets) {
        if (offset >= image.width) throw std::invalid_argument("an offset must be 0..W-1");
        imbalances.push_back(static_load(image, {image.width, image.height, pes, offset, fold}).imbalance);
    }
    return imbalances;
}

Schedule dynamic_schedule(const CostImage& image, const raya_mapping& static_mapping, const DynamicPlan& plan) {
    check_mapping(image, static_mapping);
    if (!is_valid_plan(plan))
        throw std::invalid_argument("a plan's chunk, overhead, static fraction or root cycles are out of range");
    std::vector<std::uint64_t> finish(static_mapping.pes);
    const auto done = add_static_costs(image, static_mapping, plan.static_fraction, finish);
    const auto chunks = chunk_costs(image, done, plan.chunk);
    assign_chunks(chunks, plan, finish);
    Schedule schedule{load_of(std::move(finish)), chunks.size()};
    Load& load = schedule.load;
    if (load.max > 0) load.speedup = static_cast<double>(sum_of(image.cycles)) / static_cast<double>(load.max);
    load.efficiency = load.speedup / static_mapping.pes;
    return schedule;
}

std::uint64_t lower_bound(const CostImage& image, std::uint32_t pes) {
    check_image(image, pes);
    const std::uint64_t total = sum_of(image.cycles);
    const std::uint64_t mean_load = total / pes + (total % pes != 0);  // rounded up
    return std::max(mean_load, *std::max_element(image.cycles.begin(), image.cycles.end()));
}

}  // namespace raya
