#include "host/study/lattice.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace raya {

LatticeVector shortest_vector(std::uint32_t offset, std::uint32_t side) {
    LatticeVector least{0, side};
    for (std::uint64_t rows = 1; rows * rows < least.square(); ++rows) {
        const std::uint64_t right = rows * offset % side, left = side - right;
        const LatticeVector next{static_cast<std::int64_t>(rows),
                                 right <= left ? static_cast<std::int64_t>(right) : -static_cast<std::int64_t>(left)};
        if (next.square() < least.square()) least = next;
    }
    return least;
}

std::uint64_t shortest_square(std::uint32_t offset, std::uint32_t side) {
    return shortest_vector(offset, side).square();
}

bool shares_blocks(std::uint32_t offset, std::uint32_t side, std::uint32_t n) {
    for (std::uint64_t rows = 1; rows < n; ++rows) {
        const std::uint64_t right = rows * offset % side;
        if (std::min(right, side - right) < n) return false;
    }
    return n <= side;
}

SpreadOffsets well_spread_offsets(std::uint32_t side, std::uint32_t reference) {
    SpreadOffsets offsets;
    const std::uint64_t own = shortest_square(reference, side);
    for (std::uint32_t p = reference + 1; p < side; ++p) {
        if (p == side - reference) continue;
        if (shortest_square(p, side) > own) offsets.longer.push_back(p);
        if (shortest_square(p, side) == own) offsets.as_long.push_back(p);
    }
    return offsets;
}

std::vector<double> ranks_of(const std::vector<double>& values) {
    std::vector<std::size_t> order(values.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return values[a] < values[b]; });
    std::vector<double> ranks(values.size());
    for (std::size_t first = 0; first < order.size();) {
        std::size_t last = first;  // one behind the values that are equal
        while (last < order.size() && values[order[last]] == values[order[first]]) ++last;
        const double shared = static_cast<double>(first + 1 + last) / 2;
        for (; first < last; ++first) ranks[order[first]] = shared;
    }
    return ranks;
}

double rank_correlation(const std::vector<double>& a, const std::vector<double>& b) {
    const std::vector<double> ra = ranks_of(a), rb = ranks_of(b);
    const double mean = (static_cast<double>(a.size()) + 1) / 2;
    double both = 0, of_a = 0, of_b = 0;
    for (std::size_t i = 0; i < a.size(); ++i) {
        both += (ra[i] - mean) * (rb[i] - mean);
        of_a += (ra[i] - mean) * (ra[i] - mean);
        of_b += (rb[i] - mean) * (rb[i] - mean);
    }
    return of_a > 0 && of_b > 0 ? both / std::sqrt(of_a * of_b) : 0;
}

}  // namespace raya
