// Names of topologies, and the layout of a 3-D array of nodes on a 2-D torus.
#include "host/torus/topology.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <iterator>

#include "host/error.hpp"

namespace raya {
namespace {

// Returns C, the number of slabs in a row (see make_torus()). The product of the sides I C and J K / C does not depend
// on C. So the C with the smallest difference of the sides also has the ratio of the sides nearest to 1.
std::uint32_t slabs_per_row(const std::array<std::uint32_t, 3>& nodes) {
    const std::uint32_t i = nodes[0], j = nodes[1], k = nodes[2];
    const auto side_difference = [&](std::uint32_t c) {
        const std::uint32_t first = i * c, second = j * (k / c);
        return first > second ? first - second : second - first;
    };
    std::uint32_t best_slabs = 1;
    for (std::uint32_t c = 2; c <= k; ++c)
        if (k % c == 0 && side_difference(c) < side_difference(best_slabs)) best_slabs = c;
    return best_slabs;
}

void check_nodes(const std::array<std::uint32_t, 3>& nodes) {
    std::uint64_t count = 1;
    for (const std::uint32_t side : nodes) {
        if (side == 0)
            throw UserError(
                fmt::format("--nodes {}: a side of 0 nodes; use 1 or more on each side", sides_text(nodes)));
        count *= side;  // cannot overflow: `count` was at most 2^16
        if (count > kMaxNodes)
            throw UserError(fmt::format("--nodes {}: more than {} nodes; use fewer", sides_text(nodes), kMaxNodes));
    }
}

}  // namespace

std::string links_name(Links links) { return links == Links::kTorus3d ? "torus3d" : "torus2d"; }

raya_torus make_torus(const std::array<std::uint32_t, 3>& nodes, Links links) {
    check_nodes(nodes);
    const auto [i, j, k] = nodes;
    if (links == Links::kTorus3d) return {{i, j, k}, {i, j, k}, 1};
    const std::uint32_t slabs = slabs_per_row(nodes);
    return {{i, j, k}, {i * slabs, j * (k / slabs), 1}, slabs};
}

std::uint32_t links_of_node(const raya_torus& torus) {
    return static_cast<std::uint32_t>(
        2 * std::count_if(std::begin(torus.sides), std::end(torus.sides), [](std::uint32_t side) { return side > 1; }));
}

std::string sides_text(const std::array<std::uint32_t, 3>& sides) {
    return fmt::format("{}x{}x{}", sides[0], sides[1], sides[2]);
}

}  // namespace raya
