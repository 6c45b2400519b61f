// Which nodes of the torus a rank has, and what each says of itself.
#pragma once
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "kernels/shared/torus.h"
#include "kernels/shared/traffic.h"

namespace raya {

/// [node]: its rank, of `ranks` in all; rank 0 has the root. Bricks are halved along their longest side, as nearly in
/// the ratio of the ranks that either half gets as whole layers of nodes allow. UserError for more ranks than nodes.
std::vector<std::uint32_t> ranks_of_nodes(const raya_torus& torus, std::uint32_t ranks);

/// What one rank knows of the division. Slots: first of the inner nodes, all of whose links end in the same rank, then
/// of those at the border; each in the order of their numbers. Of one rank all nodes are inner ones.
class NodeShare {
  public:
    explicit NodeShare(const raya_torus& torus, std::uint32_t ranks = 1, std::uint32_t rank = 0);

    const raya_torus& torus() const { return torus_; }
    std::uint32_t rank() const { return rank_; }
    std::uint32_t nodes() const { return static_cast<std::uint32_t>(own().size()); }  // of this rank
    std::uint32_t inner() const { return inner_; }                                    // of them
    std::uint32_t most_nodes() const;                                                 // of the rank that has most

    /// [slot]: the node there.
    const std::vector<std::uint32_t>& nodes_of(std::uint32_t rank) const { return nodes_of_[rank]; }
    const std::vector<std::uint32_t>& own() const { return nodes_of_[rank_]; }
    std::uint32_t rank_of(std::uint32_t node) const { return rank_of_[node]; }
    bool has(std::uint32_t node) const { return rank_of_[node] == rank_; }
    std::uint32_t slot_of(std::uint32_t node) const { return slot_of_[node]; }  // in its rank

    /// Inboxes of each link on this device: of the links that start in its nodes, by the slots of those; then, as many
    /// as the link with most needs, of those that come from other ranks.
    std::uint32_t inboxes() const { return inboxes_; }

    /// Of those, the one of the link that starts at `node`, which this rank has or which leads here.
    std::uint32_t inbox(std::uint32_t link, std::uint32_t node) const;

  private:
    bool is_inner(std::uint32_t node) const;

    raya_torus torus_;
    std::uint32_t rank_, inner_ = 0, inboxes_ = 0;
    std::vector<std::uint32_t> rank_of_, slot_of_;
    std::vector<std::vector<std::uint32_t>> nodes_of_;
    std::vector<std::vector<std::uint32_t>> from_elsewhere_;  // [link]: nodes of other ranks whose link leads here
};

/// What every node says of itself, as the host has read it: [node][RAYA_STATUS_WORDS].
class NodeStatus {
  public:
    explicit NodeStatus(std::uint32_t nodes) : words(std::size_t{nodes} * RAYA_STATUS_WORDS) {}
    explicit NodeStatus(std::vector<std::uint32_t> read) : words(std::move(read)) {}
    std::uint32_t at(std::uint32_t node, std::uint32_t word) const {
        return words[std::size_t{node} * RAYA_STATUS_WORDS + word];
    }
    std::vector<std::uint32_t> words;
};

}  // namespace raya
