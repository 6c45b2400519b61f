// Names of topologies, and the layout of a 3-D array of nodes on a 2-D torus.
#include "host/torus/topology.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "host/error.hpp"

namespace raya {
namespace {

// Returns C, the number of slabs in a row (see make_torus()). The product of the sides I C and J K / C does not depend
// on C. So the C with the smallest difference of the sides also has the ratio of the sides nearest to 1.
std::uint32_t slabs_per_row(const std::array<std::uint32_t, 3>& nodes) {
    const std::int64_t i = nodes[0], j = nodes[1], k = nodes[2];
    const auto side_difference = [&](std::uint32_t c) { return std::abs(i * c - j * (k / c)); };
    std::uint32_t best_slabs = 1;
    for (std::uint32_t c = 2; c <= k; ++c)
        if (k % c == 0 && side_difference(c) < side_difference(best_slabs)) best_slabs = c;
    return best_slabs;
}

}  // namespace

std::string links_name(Links links) { return links == Links::kTorus3d ? "torus3d" : "torus2d"; }

raya_torus make_torus(const std::array<std::uint32_t, 3>& nodes, Links links) {
    std::uint64_t count = 1;
    for (const std::uint32_t side : nodes) {
        if (side == 0)
            throw UserError(
                fmt::format("--nodes {}: a side of 0 nodes; use 1 or more on each side", sides_text(nodes)));
        count *= side;  // cannot overflow: `count` was at most 2^16
        if (count > kMaxNodes)
            throw UserError(fmt::format("--nodes {}: more than {} nodes; use fewer", sides_text(nodes), kMaxNodes));
    }
    const auto [i, j, k] = nodes;
    if (links == Links::kTorus3d) return {{i, j, k}, {i, j, k}, 1};
    const std::uint32_t slabs = slabs_per_row(nodes);
    return {{i, j, k}, {i * slabs, j * (k / slabs), 1}, slabs};
}

std::uint32_t links_of_node(const raya_torus& torus) {
    return 2 * static_cast<std::uint32_t>(std::ranges::count_if(torus.sides, [](auto side) { return side > 1; }));
}

std::uint32_t destination_of(const raya_torus& torus, std::uint32_t sender, const raya_head& packet) {
    if (raya_state_kind(packet.state) == RAYA_KIND_RETURN) return RAYA_ROOT;
    if (packet.voxel == RAYA_NO_VOXEL) return sender;
    const raya_place v = raya_unpack_place(packet.voxel);
    return raya_node_of(torus, v.at[0] % torus.nodes[0], v.at[1] % torus.nodes[1], v.at[2] % torus.nodes[2]);
}

std::string sides_text(const std::array<std::uint32_t, 3>& sides) {
    return fmt::format("{}x{}x{}", sides[0], sides[1], sides[2]);
}

namespace {

// A cuboid of nodes: along each axis the places from `first` to `end` - 1.
struct Cuboid {
    raya_place first, end;

    std::uint32_t side(std::uint32_t axis) const { return end.at[axis] - first.at[axis]; }
    std::uint32_t nodes() const { return side(0) * side(1) * side(2); }
};

// Returns the rank of the node at `place`: divides the cuboid of all nodes, then the part that contains the node, until
// a part has one rank. `ranks` must not exceed the number of nodes.
std::uint32_t rank_of_place(const raya_torus& torus, const raya_place& place, std::uint32_t ranks) {
    Cuboid cuboid{{{0, 0, 0}}, {{torus.sides[0], torus.sides[1], torus.sides[2]}}};
    std::uint32_t first_rank = 0;
    while (ranks > 1) {
        std::uint32_t axis = 0;
        for (std::uint32_t candidate : {1, 2})
            if (cuboid.side(candidate) > cuboid.side(axis)) axis = candidate;
        const double layers = cuboid.side(axis);
        const double low_layers = std::clamp(std::round(layers * (ranks / 2) / ranks), 1.0, layers - 1);
        Cuboid low = cuboid, high = cuboid;
        low.end.at[axis] = high.first.at[axis] = cuboid.first.at[axis] + static_cast<std::uint32_t>(low_layers);
        // Each part has at least one node for each of its ranks.
        const std::uint32_t low_ranks =
            std::clamp(ranks / 2, ranks - std::min(ranks - 1, high.nodes()), std::min(ranks - 1, low.nodes()));
        const bool is_low = place.at[axis] < low.end.at[axis];
        cuboid = is_low ? low : high;
        first_rank += is_low ? 0 : low_ranks;
        ranks = is_low ? low_ranks : ranks - low_ranks;
    }
    return first_rank;
}

}  // namespace

std::vector<std::uint32_t> ranks_of_nodes(const raya_torus& torus, std::uint32_t ranks) {
    if (ranks > raya_nodes(torus))
        throw UserError(
            fmt::format("{} ranks for {} nodes: a rank needs at least one node; start {} ranks or fewer, or use more "
                        "nodes (--nodes)",
                        ranks, raya_nodes(torus), raya_nodes(torus)));
    std::vector<std::uint32_t> rank_of;
    for (std::uint32_t node = 0; node < raya_nodes(torus); ++node)
        rank_of.push_back(rank_of_place(torus, raya_torus_place(torus, node), ranks));
    return rank_of;
}

NodeDistribution::NodeDistribution(const raya_torus& torus, Ranks& ranks)
    : Distribution(ranks_of_nodes(torus, ranks.count()), ranks), torus_(torus), remote_senders_(RAYA_LINKS) {
    for (std::uint32_t link = 0; link < RAYA_LINKS; ++link) {
        for (std::uint32_t node = 0; node < all(); ++node)
            if (!has(node) && has(raya_link_end(torus, node, link))) remote_senders_[link].push_back(node);
        inboxes_ = std::max(inboxes_, count() + static_cast<std::uint32_t>(remote_senders_[link].size()));
    }
}

std::uint32_t NodeDistribution::inbox_from(std::uint32_t sender, std::uint32_t link) const {
    if (has(sender)) return slot_of(sender);
    const std::vector<std::uint32_t>& senders = remote_senders_[link];
    return count() + static_cast<std::uint32_t>(std::ranges::lower_bound(senders, sender) - senders.begin());
}

}  // namespace raya
