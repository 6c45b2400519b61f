#include "host/torus/node_share.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "host/error.hpp"

namespace raya {
namespace {

struct Brick {
    raya_place first, end;

    std::uint32_t side(std::uint32_t axis) const { return end.at[axis] - first.at[axis]; }
    std::uint64_t nodes() const { return std::uint64_t{side(0)} * side(1) * side(2); }
};

class NodeDivider {
  public:
    explicit NodeDivider(const raya_torus& torus) : torus_(torus), rank_of(raya_nodes(torus)) {}

    // Divides a cuboid among the ranks `first` to `first` + `ranks` - 1; `ranks` must not exceed its number of nodes.
    void divide(const Brick& brick, std::uint32_t ranks, std::uint32_t first) {
        if (ranks == 1) return assign(brick, first);
        std::uint32_t axis = 0;
        for (std::uint32_t other : {1, 2})
            if (brick.side(other) > brick.side(axis)) axis = other;
        const std::uint64_t layers = brick.side(axis), layer_nodes = brick.nodes() / layers;
        const std::uint64_t low_layers = layers / 2;
        const std::uint64_t low_nodes = low_layers * layer_nodes, high_nodes = brick.nodes() - low_nodes;
        const auto share =
            static_cast<std::uint64_t>(std::llround(double(ranks) * double(low_layers) / double(layers)));
        const std::uint64_t min_low = ranks > high_nodes ? ranks - high_nodes : 1;
        const auto low = static_cast<std::uint32_t>(
            std::clamp<std::uint64_t>(share, min_low, std::min<std::uint64_t>(low_nodes, ranks - 1)));
        const std::uint32_t middle = cut_layer(brick, axis, low, ranks);
        Brick below = brick, above = brick;
        below.end.at[axis] = above.first.at[axis] = middle;
        divide(below, low, first);
        divide(above, ranks - low, first + low);
    }

    const raya_torus torus_;
    std::vector<std::uint32_t> rank_of;

  private:
    // Returns the layer at which to cut the cuboid: the lower part gets about low / ranks of the nodes, and both parts
    // have at least one node for each of their ranks.
    std::uint32_t cut_layer(const Brick& brick, std::uint32_t axis, std::uint32_t low, std::uint32_t ranks) const {
        const std::uint32_t layers = brick.side(axis);
        const std::uint64_t layer_nodes = brick.nodes() / layers;
        const auto layers_of = [&](std::uint64_t nodes) {
            return static_cast<std::uint32_t>((nodes + layer_nodes - 1) / layer_nodes);
        };
        const auto wanted = static_cast<std::uint32_t>(std::llround(double(layers) * low / ranks));
        const std::uint32_t max_layers = layers - std::max(1u, layers_of(ranks - low));
        return brick.first.at[axis] + std::clamp(wanted, std::max(1u, layers_of(low)), max_layers);
    }

    void assign(const Brick& brick, std::uint32_t rank) {
        raya_place p{};
        for (p.at[2] = brick.first.at[2]; p.at[2] < brick.end.at[2]; ++p.at[2])
            for (p.at[1] = brick.first.at[1]; p.at[1] < brick.end.at[1]; ++p.at[1])
                for (p.at[0] = brick.first.at[0]; p.at[0] < brick.end.at[0]; ++p.at[0])
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

NodeShare::NodeShare(const raya_torus& torus, std::uint32_t ranks, std::uint32_t rank)
    : torus_(torus),
      rank_(rank),
      rank_of_(ranks_of_nodes(torus, ranks)),
      slot_of_(rank_of_.size()),
      nodes_of_(ranks),
      remote_starts_(RAYA_LINKS) {
    for (const bool inner : {true, false})
        for (std::uint32_t node = 0; node < rank_of_.size(); ++node) {
            if (is_inner(node) != inner) continue;
            std::vector<std::uint32_t>& nodes = nodes_of_[rank_of_[node]];
            slot_of_[node] = static_cast<std::uint32_t>(nodes.size());
            nodes.push_back(node);
            inner_ += inner && has(node);
        }
    for (std::uint32_t link = 0; link < RAYA_LINKS; ++link) {
        for (std::uint32_t node = 0; node < rank_of_.size(); ++node)
            if (!has(node) && has(raya_link_end(torus, node, link))) remote_starts_[link].push_back(node);
        inboxes_ = std::max(inboxes_, nodes() + static_cast<std::uint32_t>(remote_starts_[link].size()));
    }
}

bool NodeShare::is_inner(std::uint32_t node) const {
    for (std::uint32_t link = 0; link < RAYA_LINKS; ++link)
        if (rank_of_[raya_link_end(torus_, node, link)] != rank_of_[node]) return false;
    return true;
}

std::uint32_t NodeShare::max_nodes_of_rank() const {
    std::size_t max_nodes = 0;
    for (const std::vector<std::uint32_t>& nodes : nodes_of_) max_nodes = std::max(max_nodes, nodes.size());
    return static_cast<std::uint32_t>(max_nodes);
}

std::uint32_t NodeShare::inbox(std::uint32_t link, std::uint32_t node) const {
    if (has(node)) return slot_of_[node];
    const std::vector<std::uint32_t>& from = remote_starts_[link];
    return nodes() + static_cast<std::uint32_t>(std::lower_bound(from.begin(), from.end(), node) - from.begin());
}

}  // namespace raya
