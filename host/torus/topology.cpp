// Names of topologies, and the layout of a 3-D array of nodes on a 2-D torus.
#include "host/torus/topology.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
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

namespace {

// A cuboid of nodes: along each axis the places from `first` to `end` - 1.
struct Cuboid {
    raya_place first, end;

    std::uint32_t side(std::uint32_t axis) const { return end.at[axis] - first.at[axis]; }
    std::uint64_t nodes() const { return std::uint64_t{side(0)} * side(1) * side(2); }
};

// Divides the nodes of a torus among ranks by recursive bisection.
class NodeDivider {
  public:
    explicit NodeDivider(const raya_torus& torus) : torus_(torus), rank_of(raya_nodes(torus)) {}

    // Divides the cuboid among the ranks `first_rank` to `first_rank` + `ranks` - 1; `ranks` must not exceed the number
    // of nodes in the cuboid.
    void divide(const Cuboid& cuboid, std::uint32_t ranks, std::uint32_t first_rank) {
        if (ranks == 1) return assign(cuboid, first_rank);
        std::uint32_t axis = 0;
        for (std::uint32_t candidate : {1, 2})
            if (cuboid.side(candidate) > cuboid.side(axis)) axis = candidate;
        const std::uint64_t layers = cuboid.side(axis), layer_nodes = cuboid.nodes() / layers;
        const std::uint64_t low_layers = layers / 2;
        const std::uint64_t low_nodes = low_layers * layer_nodes, high_nodes = cuboid.nodes() - low_nodes;
        const auto proportional_ranks =
            static_cast<std::uint64_t>(std::llround(double(ranks) * double(low_layers) / double(layers)));
        const std::uint64_t min_low_ranks = ranks > high_nodes ? ranks - high_nodes : 1;
        const auto low_ranks = static_cast<std::uint32_t>(std::clamp<std::uint64_t>(
            proportional_ranks, min_low_ranks, std::min<std::uint64_t>(low_nodes, ranks - 1)));
        const std::uint32_t middle = cut_layer(cuboid, axis, low_ranks, ranks);
        Cuboid low_part = cuboid, high_part = cuboid;
        low_part.end.at[axis] = high_part.first.at[axis] = middle;
        divide(low_part, low_ranks, first_rank);
        divide(high_part, ranks - low_ranks, first_rank + low_ranks);
    }

    const raya_torus torus_;
    std::vector<std::uint32_t> rank_of;  // [node]: rank of the node

  private:
    // Returns the first layer of the high part. The low part gets about low_ranks / ranks of the nodes, and both parts
    // have at least one node for each of their ranks.
    std::uint32_t cut_layer(const Cuboid& cuboid, std::uint32_t axis, std::uint32_t low_ranks,
                            std::uint32_t ranks) const {
        const std::uint32_t layers = cuboid.side(axis);
        const std::uint64_t layer_nodes = cuboid.nodes() / layers;
        const auto layers_for = [&](std::uint64_t nodes) {
            return static_cast<std::uint32_t>((nodes + layer_nodes - 1) / layer_nodes);
        };
        const auto proportional_layers = static_cast<std::uint32_t>(std::llround(double(layers) * low_ranks / ranks));
        const std::uint32_t max_layers = layers - std::max(1u, layers_for(ranks - low_ranks));
        return cuboid.first.at[axis] + std::clamp(proportional_layers, std::max(1u, layers_for(low_ranks)), max_layers);
    }

    void assign(const Cuboid& cuboid, std::uint32_t rank) {
        raya_place p{};
        for (p.at[2] = cuboid.first.at[2]; p.at[2] < cuboid.end.at[2]; ++p.at[2])
            for (p.at[1] = cuboid.first.at[1]; p.at[1] < cuboid.end.at[1]; ++p.at[1])
                for (p.at[0] = cuboid.first.at[0]; p.at[0] < cuboid.end.at[0]; ++p.at[0])
                    rank_of[raya_node_at(torus_, p)] = rank;
    }
};

}  // namespace

std::vector<std::uint32_t> ranks_of_nodes(const raya_torus& torus, std::uint32_t ranks) {
    if (ranks > raya_nodes(torus))
        throw UserError(
            fmt::format("{} ranks for {} nodes: a rank needs at least one node; start {} ranks or fewer, or use more "
                        "nodes (--nodes)",
                        ranks, raya_nodes(torus), raya_nodes(torus)));
    NodeDivider divider(torus);
    divider.divide({{{0, 0, 0}}, {{torus.sides[0], torus.sides[1], torus.sides[2]}}}, ranks, 0);
    return divider.rank_of;
}

NodeDistribution::NodeDistribution(const raya_torus& torus, Ranks& ranks)
    : Distribution(ranks_of_nodes(torus, ranks.count()), ranks), torus_(torus), remote_senders_(RAYA_LINKS) {
    std::vector<std::vector<std::uint32_t>> nodes_of_ranks(ranks.count());
    for (const bool inner : {true, false})
        for (std::uint32_t node = 0; node < all(); ++node) {
            if (is_inner(node) != inner) continue;
            nodes_of_ranks[rank_of(node)].push_back(node);
            inner_nodes_ += inner && has(node);
        }
    set_slots(std::move(nodes_of_ranks));
    for (std::uint32_t link = 0; link < RAYA_LINKS; ++link) {
        for (std::uint32_t node = 0; node < all(); ++node)
            if (!has(node) && has(raya_link_end(torus, node, link))) remote_senders_[link].push_back(node);
        inboxes_ = std::max(inboxes_, count() + static_cast<std::uint32_t>(remote_senders_[link].size()));
    }
}

bool NodeDistribution::is_inner(std::uint32_t node) const {
    for (std::uint32_t link = 0; link < RAYA_LINKS; ++link)
        if (rank_of(raya_link_end(torus_, node, link)) != rank_of(node)) return false;
    return true;
}

std::uint32_t NodeDistribution::inbox_from(std::uint32_t sender, std::uint32_t link) const {
    if (has(sender)) return slot_of(sender);
    const std::vector<std::uint32_t>& senders = remote_senders_[link];
    return count() +
           static_cast<std::uint32_t>(std::lower_bound(senders.begin(), senders.end(), sender) - senders.begin());
}

}  // namespace raya
