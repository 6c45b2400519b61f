// Ring distances to the PEs that own a PE's neighbouring pixels, and the minimum number of rotations that bring these
// pixels.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cstdint>
#include <deque>
#include <functional>
#include <limits>
#include <numeric>
#include <set>
#include <vector>

#include "host/ring/bus_and_ring.hpp"
#include "host/ring/mapping.hpp"
#include "kernels/shared/share_pixels.h"
#include "tests/ring/small_mapping.hpp"

using namespace raya;

namespace {

using Distances = std::vector<std::uint32_t>;

/// Returns the owner of each pixel, [row][column], from the PEs' lists of pixels.
std::vector<std::uint32_t> listed_owners(const raya_mapping& m) {
    std::vector<std::uint32_t> owners(std::size_t{m.width} * m.height);
    for (std::uint32_t pe = 0; pe < m.pes; ++pe) {
        const raya_share share = raya_share_of(m, pe);
        for (std::uint32_t k = 0; k < raya_share_size(share); ++k) {
            const raya_pixel pixel = raya_pixel_of(m, share, k);
            owners[std::size_t{pixel.row} * m.width + pixel.column] = pe;
        }
    }
    return owners;
}

/// Returns the distances according to the definition in mapping.hpp, computed with signed numbers.
Distances defined_distances(const raya_mapping& m, raya_u32 side) {
    const std::vector<std::uint32_t> owners = listed_owners(m);
    const std::int64_t right = side == RAYA_LEFT ? -1 : side == RAYA_RIGHT ? 1 : 0;
    const std::int64_t down = side == RAYA_ABOVE ? -1 : side == RAYA_BELOW ? 1 : 0;
    const std::int64_t width = m.width, height = m.height, pes = m.pes;
    std::set<std::uint32_t> found;
    for (std::int64_t j = 0; j < height; ++j)
        for (std::int64_t x = 0; x < width; ++x) {
            const std::int64_t row = j + down, column = x + right;
            if (row < 0 || row >= height || column < 0 || column >= width) continue;
            const std::int64_t pe = owners[j * width + x], neighbour_pe = owners[row * width + column];
            found.insert(static_cast<std::uint32_t>((neighbour_pe - pe + pes) % pes));
        }
    return {found.begin(), found.end()};
}

std::uint64_t route_rotations(const std::vector<Leg>& route) {
    return std::accumulate(route.begin(), route.end(), std::uint64_t{0},
                           [](std::uint64_t sum, const Leg& leg) { return sum + leg.rotations(); });
}

/// Returns the distances at which a route stops, in ascending order, with repetitions.
Distances stops_of(const std::vector<Leg>& route, std::uint32_t pes) {
    Distances stops;
    for (const Leg& leg : route)
        for (const std::uint32_t stop : leg.stops)
            stops.push_back(leg.direction == RingDirection::kDown ? stop : (pes - stop) % pes);
    std::sort(stops.begin(), stops.end());
    return stops;
}

/// Returns true if a route has at most one leg down, followed by at most one leg up, and if no leg is empty and the
/// stops of each leg ascend and lie within one round of the ring.
bool well_formed(const std::vector<Leg>& route, std::uint32_t pes) {
    if (route.size() > 2) return false;
    if (route.size() == 2 && (route[0].direction != RingDirection::kDown || route[1].direction != RingDirection::kUp))
        return false;
    return std::all_of(route.begin(), route.end(), [&](const Leg& leg) {
        return !leg.stops.empty() && leg.rotations() < pes &&
               std::adjacent_find(leg.stops.begin(), leg.stops.end(), std::greater_equal<>()) == leg.stops.end();
    });
}

/// Returns the minimum number of rotations that visit all distances in `wanted` (bit d: distance d). A rotation in
/// either direction costs 1; a restart from the PEs' own blocks costs 0. The function searches the states (distance,
/// visited distances) breadth first.
int min_rotations(std::uint32_t pes, std::uint32_t wanted) {
    constexpr int kUnreached = std::numeric_limits<int>::max();
    const std::uint32_t seen_sets = 1u << pes;  // number of sets of distances
    std::vector<int> rotations(std::size_t{pes} * seen_sets, kUnreached);
    std::deque<std::uint32_t> next;  // states: distance * seen_sets + seen
    const auto reach = [&](std::uint32_t distance, std::uint32_t seen, int cost, bool costs_nothing) {
        const std::uint32_t state = distance * seen_sets + (seen | 1u << distance);
        if (cost >= rotations[state]) return;
        rotations[state] = cost;
        costs_nothing ? next.push_front(state) : next.push_back(state);
    };
    reach(0, 0, 0, true);
    while (!next.empty()) {
        const std::uint32_t state = next.front(), distance = state / seen_sets, seen = state % seen_sets;
        next.pop_front();
        if ((seen & wanted) == wanted) return rotations[state];
        reach(0, seen, rotations[state], true);
        reach((distance + 1) % pes, seen, rotations[state] + 1, false);
        reach((distance + pes - 1) % pes, seen, rotations[state] + 1, false);
    }
    return kUnreached;
}

std::uint64_t exchange_rotations(const raya_mapping& m, std::uint32_t capacity, std::uint32_t band) {
    return sum_of(exchange_moves(m, ExchangeMethod::kRing, false)) * ((capacity + band - 1) / band);
}

}  // namespace

TEST_CASE("neighbour distances agree with the owners of all neighbouring pixels", "[ring][route]") {
    constexpr std::uint64_t kSeed = 5;
    SplitMix random(kSeed);
    for (int i = 0; i < 600; ++i) {
        const raya_mapping m = any_mapping(random, 14);
        CAPTURE(kSeed, i, m.width, m.height, m.pes, mapping_text(m), m.kind);
        for (raya_u32 side = 0; side < RAYA_SIDES; ++side) {
            CAPTURE(side);
            CHECK(neighbour_distances(m, side) == defined_distances(m, side));
        }
    }
}

TEST_CASE("routes have the minimum number of rotations: every set of distances on up to nine PEs", "[ring][route]") {
    for (std::uint32_t pes = 1; pes <= 9; ++pes)
        for (std::uint32_t wanted = 0; wanted < 1u << pes; ++wanted) {
            Distances distances;
            for (std::uint32_t d = 0; d < pes; ++d)
                if (wanted >> d & 1u) distances.push_back(d);
            const std::vector<Leg> route = shortest_route(pes, distances);
            const bool good = well_formed(route, pes) && stops_of(route, pes) == distances &&
                              route_rotations(route) == static_cast<std::uint64_t>(min_rotations(pes, wanted));
            if (good) continue;
            CAPTURE(pes, distances, route_rotations(route), min_rotations(pes, wanted), stops_of(route, pes));
            CHECK(good);
        }
    CHECK(min_rotations(9, 0b000101001) == 5);  // 5 rotations down reach distances 3 and 5; upwards, 6 rotations do
    CHECK(min_rotations(9, 0b100000010) == 2);  // distances 1 and 8 take one rotation each, in opposite directions
}

TEST_CASE("if a PE owns whole columns, four sides take 2 (min(p, P - p) + 1) rotations", "[ring][route]") {
    for (const std::uint32_t p : {0u, 8u, 16u}) {  // the paper's image and array: 2, 18 and 34 rotations
        CAPTURE(p);
        CHECK(exchange_rotations({256, 256, 256, p, RAYA_FOLD_CYCLIC}, 256, 256) == 2 * p + 2);
    }
    for (const std::uint32_t pes : {2u, 3u, 24u})
        for (std::uint32_t p = 0; p < pes; ++p) {
            CAPTURE(pes, p);
            const raya_mapping m{pes, 20, pes, p, RAYA_FOLD_CYCLIC};
            const std::uint64_t rotations = 2 * (std::min(p, pes - p) + 1);
            CHECK(exchange_rotations(m, 20, 20) == rotations);
            CHECK(exchange_rotations(m, 20, 10) == 2 * rotations);  // the rotations are repeated for each of two bands
            CHECK(exchange_rotations(m, 20, 7) == 3 * rotations);   // three bands, of which the last is shorter
        }
    CHECK(exchange_rotations({6, 4, 1, 3, RAYA_FOLD_BLOCK}, 24, 5) == 0);  // one PE owns all neighbours
}

TEST_CASE("on the bus each PE needs one transfer per distance other than 0, or one broadcast", "[ring][route]") {
    constexpr std::uint64_t kSeed = 8;
    SplitMix random(kSeed);
    for (int i = 0; i < 300; ++i) {
        const raya_mapping m = any_mapping(random, 14);
        CAPTURE(kSeed, i, m.width, m.height, m.pes, mapping_text(m), m.kind);
        std::uint64_t distances = 0, sides = 0;
        for (raya_u32 side = 0; side < RAYA_SIDES; ++side) {
            Distances d = defined_distances(m, side);
            std::erase(d, 0);
            distances += d.size();
            sides += !d.empty();
        }
        for (const bool together : {false, true}) {
            CHECK(sum_of(exchange_moves(m, ExchangeMethod::kBus, together)) == m.pes * distances);
            const std::uint64_t rounds = together ? sides > 0 : sides;
            CHECK(sum_of(exchange_moves(m, ExchangeMethod::kBroadcast, together)) == m.pes * rounds);
        }
    }
    // The paper's array: 256 PEs with 4 distances each.
    const raya_mapping paper{256, 256, 256, 16, RAYA_FOLD_CYCLIC};
    CHECK(exchange_moves(paper, ExchangeMethod::kRing, false) == MovesOfSides{1, 1, 16, 16});
    CHECK(exchange_moves(paper, ExchangeMethod::kBus, false) == MovesOfSides{256, 256, 256, 256});
    CHECK(exchange_moves(paper, ExchangeMethod::kBroadcast, true) == MovesOfSides{256, 0, 0, 0});
}
