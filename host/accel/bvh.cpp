#include "host/accel/bvh.hpp"

#include <algorithm>
#include <limits>
#include <span>

namespace raya {
namespace {

constexpr std::size_t kBins = 32;  // number of bins along each axis
// From this depth on, parts are split into equal halves, which bounds the depth of the tree.
constexpr std::uint32_t kMedianDepth = 24;

// Twice the centre of an item's box along an axis.
float doubled_centre(const BvhItem& item, std::size_t axis) { return item.box.low[axis] + item.box.high[axis]; }

// Returns the number of leaves that `items` items need. The surface area heuristic multiplies the area of the items'
// box by this number.
float leaf_count(std::size_t items) { return static_cast<float>((items + RAYA_BVH_WIDTH - 1) / RAYA_BVH_WIDTH); }

// Items that will become one child of a node, and their bounding box.
struct Part {
    std::span<BvhItem> items;
    Bounds box;

    bool is_of_one_kind() const {
        return std::all_of(items.begin(), items.end(), [&](const BvhItem& i) { return i.kind == items[0].kind; });
    }
    bool is_leaf() const { return items.size() <= max_leaf_items(items[0].kind) && is_of_one_kind(); }
};

Part part_of(std::span<BvhItem> items) {
    Part part{items, kEmptyBounds};
    for (const BvhItem& item : items) extend(part.box, item.box);
    return part;
}

struct Bin {
    Bounds box = kEmptyBounds;
    std::size_t items = 0;
};

// The range of the items' centres (doubled, see doubled_centre()) along an axis, and its division into kBins equal
// bins.
struct Binning {
    float low = kInfinity, high = -kInfinity;
    float bins_per_unit = 0;

    std::size_t bin(float doubled_centre) const {
        return std::min(kBins - 1, static_cast<std::size_t>((doubled_centre - low) * bins_per_unit));
    }
};

using Bins = std::array<Bin, kBins>;  // all bins along one axis

std::array<Binning, 3> binnings_of(std::span<const BvhItem> items) {
    std::array<Binning, 3> binnings;
    for (const BvhItem& item : items)
        for (std::size_t axis = 0; axis < 3; ++axis) {
            binnings[axis].low = std::min(binnings[axis].low, doubled_centre(item, axis));
            binnings[axis].high = std::max(binnings[axis].high, doubled_centre(item, axis));
        }
    for (Binning& binning : binnings) {
        const float range = binning.high - binning.low;
        const float bins_per_unit = static_cast<float>(kBins) / range;
        binning.bins_per_unit = range > 0 && bins_per_unit < kInfinity ? bins_per_unit : 0;
    }
    return binnings;
}

// A split plane perpendicular to `axis`, between the bins `last_bin` and `last_bin` + 1.
struct Split {
    float cost = kInfinity;
    std::size_t axis = 0, last_bin = 0;
};

// Replaces `best` by the cheapest split along `axis` if that split is cheaper than `best`.
void improve_split(Split& best, std::size_t axis, const Bins& bins) {
    std::array<float, kBins> cost_above{};  // cost_above[b]: cost of all bins above bin b
    Bin sum;
    for (std::size_t b = kBins - 1; b > 0; --b) {
        extend(sum.box, bins[b].box);
        sum.items += bins[b].items;
        cost_above[b - 1] = half_area(sum.box) * leaf_count(sum.items);
    }
    const std::size_t total_items = sum.items + bins[0].items;
    sum = {};
    for (std::size_t b = 0; b + 1 < kBins; ++b) {
        extend(sum.box, bins[b].box);
        sum.items += bins[b].items;
        const float cost = half_area(sum.box) * leaf_count(sum.items) + cost_above[b];
        if (sum.items > 0 && sum.items < total_items && cost < best.cost) best = {cost, axis, b};
    }
}

using Parts = std::array<Part, 2>;

// Splits a part after its first `items` items.
Parts split_after(const Part& part, std::size_t items) {
    return {part_of(part.items.first(items)), part_of(part.items.subspan(items))};
}

// Splits the items into two equal halves by object number, for items that no bin boundary separates, and for parts so
// deep in the tree that its depth must be limited.
Parts split_by_number(const Part& part) {
    std::sort(part.items.begin(), part.items.end(),
              [](const BvhItem& a, const BvhItem& b) { return a.number < b.number; });
    return split_after(part, part.items.size() / 2);
}

// Splits the items into those of the lowest kind and the others.
Parts split_by_kind(const Part& part) {
    std::uint32_t kind = RAYA_LINK_OBJECT;  // lowest kind
    for (const BvhItem& item : part.items) kind = std::min(kind, item.kind);
    const auto second_part =
        std::partition(part.items.begin(), part.items.end(), [&](const BvhItem& item) { return item.kind == kind; });
    return split_after(part, static_cast<std::size_t>(second_part - part.items.begin()));
}

// Splits the items into those in the bins up to Split::last_bin and the others. The boxes of the parts are the unions
// of the bins' boxes.
Parts split_at(const Part& part, const Split& plane, const Bins& bins, const Binning& binning) {
    const auto second_part = std::partition(part.items.begin(), part.items.end(), [&](const BvhItem& item) {
        return binning.bin(doubled_centre(item, plane.axis)) <= plane.last_bin;
    });
    const auto items = static_cast<std::size_t>(second_part - part.items.begin());
    Parts parts{{{part.items.first(items), kEmptyBounds}, {part.items.subspan(items), kEmptyBounds}}};
    for (std::size_t b = 0; b < kBins; ++b) extend(parts[b <= plane.last_bin ? 0 : 1].box, bins[b].box);
    return parts;
}

// Splits a part: by kind if it has few items of several kinds, otherwise at the cheapest split plane.
Parts split(const Part& part, std::uint32_t depth) {
    if (part.items.size() <= RAYA_BVH_WIDTH && !part.is_of_one_kind()) return split_by_kind(part);
    if (depth >= kMedianDepth) return split_by_number(part);
    const std::array<Binning, 3> binnings = binnings_of(part.items);
    std::array<Bins, 3> bins;
    for (const BvhItem& item : part.items)
        for (std::size_t axis = 0; axis < 3; ++axis) {
            Bin& bin = bins[axis][binnings[axis].bin(doubled_centre(item, axis))];
            extend(bin.box, item.box);
            ++bin.items;
        }
    Split best;
    for (std::size_t axis = 0; axis < 3; ++axis) improve_split(best, axis, bins[axis]);
    if (best.cost == kInfinity) return split_by_number(part);
    return split_at(part, best, bins[best.axis], binnings[best.axis]);
}

class BvhBuilder {
  public:
    explicit BvhBuilder(Bvh& tree) : tree_(tree), first_item_(tree.items.data()) {}

    BvhChild make_child(const Part& part, std::uint32_t depth) {
        if (!part.is_leaf()) return {part.box, RAYA_LINK_NODE, add_node(part, depth), 0};
        std::sort(part.items.begin(), part.items.end(),
                  [](const BvhItem& a, const BvhItem& b) { return a.number < b.number; });
        return {part.box, part.items[0].kind, static_cast<std::uint32_t>(part.items.data() - first_item_),
                static_cast<std::uint32_t>(part.items.size())};
    }

  private:
    // Returns the children of the node made from `part`. Repeatedly splits the part with the largest surface area that
    // is not a leaf, until there are RAYA_BVH_WIDTH parts or only leaves.
    std::vector<Part> children_of(const Part& part, std::uint32_t depth) const {
        std::vector<Part> parts = {part};
        while (parts.size() < RAYA_BVH_WIDTH) {
            Part* largest = nullptr;
            for (Part& p : parts)
                if (!p.is_leaf() && (!largest || half_area(p.box) > half_area(largest->box))) largest = &p;
            if (!largest) break;
            const Parts pieces = split(*largest, depth);
            *largest = pieces[0];
            parts.push_back(pieces[1]);
        }
        return parts;
    }

    std::uint32_t add_node(const Part& part, std::uint32_t depth) {
        const auto number = static_cast<std::uint32_t>(tree_.nodes.size());
        tree_.nodes.emplace_back();
        tree_.depth = std::max(tree_.depth, depth + 1);
        const std::vector<Part> parts = children_of(part, depth);
        BvhNode new_node{};
        for (const Part& p : parts) new_node.children[new_node.count++] = make_child(p, depth + 1);
        tree_.nodes[number] = new_node;
        return number;
    }

    Bvh& tree_;
    const BvhItem* first_item_;
};

}  // namespace

void extend(Bounds& box, const Bounds& added) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
        box.low[axis] = std::min(box.low[axis], added.low[axis]);
        box.high[axis] = std::max(box.high[axis], added.high[axis]);
    }
}

float half_area(const Bounds& box) {
    if (box.low[0] > box.high[0]) return 0;
    const float x = box.high[0] - box.low[0], y = box.high[1] - box.low[1], z = box.high[2] - box.low[2];
    return x * y + y * z + z * x;
}

std::uint32_t max_leaf_items(std::uint32_t kind) {
    return kind == RAYA_LINK_POLYGON || kind == RAYA_LINK_OBJECT ? 1 : RAYA_BVH_WIDTH;
}

Bvh build_bvh(std::vector<BvhItem> items) {
    Bvh tree;
    tree.items = std::move(items);
    if (!tree.items.empty()) tree.root = BvhBuilder(tree).make_child(part_of(tree.items), 0);
    return tree;
}

}  // namespace raya
