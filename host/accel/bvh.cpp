#include "host/accel/bvh.hpp"

#include <algorithm>
#include <deque>
#include <mutex>

#include "host/accel/bvh_split.hpp"

namespace raya {
namespace {

// Builds the nodes of a tree, top down. Nodes with many items are built one after the other, each split by all threads;
// then every thread builds whole subtrees. The nodes are in the order in which the threads start them until
// number_nodes() numbers them.
class BvhBuilder {
  public:
    BvhBuilder(Bvh& tree, unsigned threads)
        : tree_(tree), threads_(threads), subtree_items_(std::max(kMinSubtree, tree.items.size() / (8 * threads))) {}

    void build() {
        make_child(tree_.root, part_of(tree_.items, threads_), 0, threads_);
        parallel_for(subtrees_.size(), threads_, [&](std::size_t i) {
            subtrees_[i].child->first = add_node(subtrees_[i].part, subtrees_[i].depth, 1);
        });
        tree_.nodes.reserve(nodes_.size());
        if (!nodes_.empty()) number_nodes(tree_.root, 1);
    }

  private:
    static constexpr std::size_t kMinSubtree = 1 << 12;  // smaller subtrees are not worth a task of their own

    // A subtree that one thread builds.
    struct Subtree {
        BvhChild* child;
        Part part;
        std::uint32_t depth;
    };

    // Makes `child` from a part. `threads`: maximum number of threads; 1 within a subtree that one thread builds.
    void make_child(BvhChild& child, const Part& part, std::uint32_t depth, unsigned threads) {
        child = {bounds_of(part.box), RAYA_LINK_NODE, 0, 0};
        if (part.is_leaf) {
            std::sort(part.items.begin(), part.items.end(),
                      [](const BvhItem& a, const BvhItem& b) { return a.number < b.number; });
            child.kind = part.items[0].kind;
            child.first = static_cast<std::uint32_t>(part.items.data() - tree_.items.data());
            child.items = static_cast<std::uint32_t>(part.items.size());
        } else if (threads > 1 && part.items.size() <= subtree_items_) {
            subtrees_.push_back({&child, part, depth});
        } else {
            child.first = add_node(part, depth, threads);
        }
    }

    // Returns the children of the node made from `part`. Repeatedly splits the part with the largest surface area that
    // is not a leaf, until there are RAYA_BVH_WIDTH parts or only leaves.
    static std::vector<Part> children_of(const Part& part, std::uint32_t depth, unsigned threads) {
        std::vector<Part> parts;
        parts.reserve(RAYA_BVH_WIDTH);
        parts.push_back(part);
        while (parts.size() < RAYA_BVH_WIDTH) {
            Part* largest = nullptr;
            for (Part& p : parts)
                if (!p.is_leaf && (!largest || p.half_area > largest->half_area)) largest = &p;
            if (!largest) break;
            const std::array<Part, 2> pieces = split(*largest, depth, threads);
            *largest = pieces[0];
            parts.push_back(pieces[1]);
        }
        return parts;
    }

    std::uint32_t add_node(const Part& part, std::uint32_t depth, unsigned threads) {
        const std::vector<Part> parts = children_of(part, depth, threads);
        std::unique_lock lock(mutex_);
        const auto index = static_cast<std::uint32_t>(nodes_.size());
        BvhNode& node = nodes_.emplace_back();
        lock.unlock();
        for (const Part& p : parts) make_child(node.children[node.count++], p, depth + 1, threads);
        return index;
    }

    // Copies a node and the nodes below it to the tree, parents before their children. `depth`: number of nodes from
    // the root to this node.
    void number_nodes(BvhChild& child, std::uint32_t depth) {
        const auto number = static_cast<std::uint32_t>(tree_.nodes.size());
        tree_.nodes.push_back(nodes_[child.first]);
        tree_.depth = std::max(tree_.depth, depth);
        child.first = number;
        for (std::uint32_t i = 0; i < tree_.nodes[number].count; ++i)
            if (tree_.nodes[number].children[i].kind == RAYA_LINK_NODE)
                number_nodes(tree_.nodes[number].children[i], depth + 1);  // nodes are reserved, so none moves
    }

    Bvh& tree_;
    unsigned threads_;
    std::size_t subtree_items_;  // maximum number of items of a subtree that one thread builds
    std::vector<Subtree> subtrees_;
    std::mutex mutex_;           // guards nodes_.emplace_back()
    std::deque<BvhNode> nodes_;  // whose elements do not move when nodes are added
};

}  // namespace

void extend(Bounds& box, const Bounds& added) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
        box.low[axis] = std::min(box.low[axis], added.low[axis]);
        box.high[axis] = std::max(box.high[axis], added.high[axis]);
    }
}

std::uint32_t max_leaf_items(std::uint32_t kind) {
    return kind == RAYA_LINK_POLYGON || kind == RAYA_LINK_OBJECT ? 1 : RAYA_BVH_WIDTH;
}

Bvh build_bvh(std::vector<BvhItem> items, unsigned threads) {
    Bvh tree;
    tree.items = std::move(items);
    if (!tree.items.empty()) BvhBuilder(tree, threads).build();
    return tree;
}

}  // namespace raya
