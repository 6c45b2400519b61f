// Distribution of the torus nodes over ranks, and the status words of nodes.
#pragma once
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "kernels/shared/torus.h"
#include "kernels/shared/traffic.h"

namespace raya {

/// Returns [node]: rank of the node, 0..ranks - 1; rank 0 has the root. Each rank gets a cuboid of nodes. Recursive
/// bisection cuts each cuboid across its longest side, between two layers of nodes, so that the numbers of nodes of
/// both parts are as nearly proportional to their numbers of ranks as possible. Throws UserError for more ranks than
/// nodes.
std::vector<std::uint32_t> ranks_of_nodes(const raya_torus& torus, std::uint32_t ranks);

/// Distribution of the nodes over the ranks. The constructor's `rank` is "this rank". A slot is the index of a node
/// within its rank. The first slots are those of the inner nodes, whose links all end in the same rank. The slots of
/// the border nodes follow. Inner nodes and border nodes are each in ascending order.
class NodeDistribution {
  public:
    explicit NodeDistribution(const raya_torus& torus, std::uint32_t ranks = 1, std::uint32_t rank = 0);

    const raya_torus& torus() const { return torus_; }
    std::uint32_t rank() const { return rank_; }
    /// Number of nodes of this rank.
    std::uint32_t nodes() const { return static_cast<std::uint32_t>(own_nodes().size()); }
    /// Number of inner nodes of this rank.
    std::uint32_t inner_nodes() const { return inner_nodes_; }
    /// Maximum number of nodes of a rank.
    std::uint32_t max_nodes_of_rank() const;

    /// Return the nodes of a rank, and of this rank, indexed by slot.
    const std::vector<std::uint32_t>& nodes_of(std::uint32_t rank) const { return nodes_of_[rank]; }
    const std::vector<std::uint32_t>& own_nodes() const { return nodes_of_[rank_]; }
    std::uint32_t rank_of(std::uint32_t node) const { return rank_of_[node]; }
    bool has(std::uint32_t node) const { return rank_of_[node] == rank_; }
    std::uint32_t slot_of(std::uint32_t node) const { return slot_of_[node]; }

    /// Returns [rank]: `elements_per_node` times the number of nodes of the rank.
    std::vector<std::size_t> sizes_of_ranks(std::size_t elements_per_node) const;

    /// Reorders [rank][slot][elements_per_node] to [node][elements_per_node].
    template <class T>
    std::vector<T> in_order_of_nodes(const std::vector<T>& by_rank, std::size_t elements_per_node) const {
        if (nodes_of_.size() == 1) return by_rank;
        std::vector<T> by_node(by_rank.size());
        auto source = by_rank.begin();
        for (const std::vector<std::uint32_t>& nodes : nodes_of_)
            for (const std::uint32_t node : nodes) {
                std::copy_n(source, elements_per_node,
                            by_node.begin() + static_cast<std::ptrdiff_t>(elements_per_node * node));
                source += static_cast<std::ptrdiff_t>(elements_per_node);
            }
        return by_node;
    }

    /// Number of inboxes that this rank has for each link direction. The first inboxes belong to links that start at
    /// nodes of this rank, and are indexed by the slot of the start. Inboxes of links from other ranks follow. All
    /// directions have the same number of inboxes: the maximum that a direction needs.
    std::uint32_t inboxes() const { return inboxes_; }

    /// Returns the index of the inbox for packets that `sender` sends over its link `link`. The sender or the node at
    /// the end of the link must be in this rank.
    std::uint32_t inbox_from(std::uint32_t sender, std::uint32_t link) const;

  private:
    bool is_inner(std::uint32_t node) const;

    raya_torus torus_;
    std::uint32_t rank_, inner_nodes_ = 0, inboxes_ = 0;
    std::vector<std::uint32_t> rank_of_, slot_of_;
    std::vector<std::vector<std::uint32_t>> nodes_of_;
    // [link]: nodes of other ranks whose link in that direction ends in this rank, ascending
    std::vector<std::vector<std::uint32_t>> remote_senders_;
};

/// Host copy of the nodes' status words: [node][RAYA_STATUS_WORDS].
class NodeStatus {
  public:
    explicit NodeStatus(std::uint32_t nodes) : words(std::size_t{nodes} * RAYA_STATUS_WORDS) {}
    explicit NodeStatus(std::vector<std::uint32_t> status_words) : words(std::move(status_words)) {}
    std::uint32_t at(std::uint32_t node, std::uint32_t word) const {
        return words[std::size_t{node} * RAYA_STATUS_WORDS + word];
    }
    std::vector<std::uint32_t> words;
};

}  // namespace raya
