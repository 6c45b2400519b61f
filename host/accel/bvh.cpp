#include "host/accel/bvh.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <deque>
#include <mutex>
#include <span>
#include <utility>

#include "host/accel/hit_regions.hpp"

namespace raya {
namespace {

/// Four floats that are computed at once: x, y, z and an unused one. gcc and clang compile operations on them to vector
/// instructions or, on processors without vectors of four floats, to scalar ones with the same results.
using Float4 = float __attribute__((vector_size(16)));

struct Box4 {
    Float4 low, high;
};

inline constexpr Box4 kEmptyBox4 = {{kInfinity, kInfinity, kInfinity, kInfinity},
                                    {-kInfinity, -kInfinity, -kInfinity, -kInfinity}};

/// Items that will become one child of a node.
struct Part {
    std::span<BvhItem> items;
    Box4 box = kEmptyBox4;      // of the items
    Box4 centres = kEmptyBox4;  // of the doubled centres of the items' boxes: low + high
    float half_area = 0;        // of `box`
    bool is_leaf = false;       // the items fit into one leaf
};

constexpr std::size_t kBins = 32;  // number of bins along each axis
// From this depth on, parts are split into equal halves, which bounds the depth of the tree.
constexpr std::uint32_t kMedianDepth = 24;
// Parts with fewer items are split on one thread, because starting threads would take longer than they save.
constexpr std::size_t kMinItemsOfThreads = 1 << 15;

using Int4 = std::int32_t __attribute__((vector_size(16)));

Float4 smaller(const Float4& a, const Float4& b) { return b < a ? b : a; }
Float4 larger(const Float4& a, const Float4& b) { return a < b ? b : a; }

void extend(Box4& box, const Box4& added) {
    box.low = smaller(box.low, added.low);
    box.high = larger(box.high, added.high);
}

// Returns half the surface area of a box that is not empty.
float half_area(const Box4& box) {
    const Float4 sides = box.high - box.low;
    return sides[0] * sides[1] + sides[1] * sides[2] + sides[2] * sides[0];
}

// An item as it is in memory: low x, y, z, high x; high y, z, number, kind.
struct Item4 {
    Float4 first, second;

    explicit Item4(const BvhItem& item) {
        static_assert(sizeof(BvhItem) == sizeof(Item4) && offsetof(BvhItem, box) == 0);
        std::memcpy(&first, item.box.low.data(), sizeof(Float4));
        std::memcpy(&second, item.box.high.data() + 1, sizeof(Float4));
    }
    void store(BvhItem& item) const {
        std::memcpy(item.box.low.data(), &first, sizeof(Float4));
        std::memcpy(item.box.high.data() + 1, &second, sizeof(Float4));
    }
    // The unused elements are high x.
    Box4 box() const { return {first, __builtin_shufflevector(first, second, 3, 4, 5, 3)}; }
};

Box4 box_of(const BvhItem& item) { return Item4(item).box(); }

// Returns the number of leaves that `items` items need. The surface area heuristic multiplies the area of the items'
// box by this number.
float leaf_count(std::size_t items) { return static_cast<float>((items + RAYA_BVH_WIDTH - 1) / RAYA_BVH_WIDTH); }

bool are_of_one_kind(std::span<const BvhItem> items) {
    return std::ranges::all_of(items, [&](const BvhItem& item) { return item.kind == items[0].kind; });
}

Part make_part(std::span<BvhItem> items, const Box4& box, const Box4& centres) {
    const bool fits_one_leaf = items.size() <= max_leaf_items(items[0].kind) && are_of_one_kind(items);
    return {items, box, centres, half_area(box), fits_one_leaf};
}

// The chunks of the items on which threads work.
struct Chunks {
    std::span<BvhItem> items;
    unsigned threads;
    std::size_t count;

    Chunks(std::span<BvhItem> all_items, unsigned max_threads)
        : items(all_items),
          threads(all_items.size() < kMinItemsOfThreads ? 1 : max_threads),
          count(threads == 1 ? 1 : std::size_t{4} * threads) {}

    IndexRange range(std::size_t chunk) const { return part_of_range(chunk, count, items.size()); }
    std::span<BvhItem> of(std::size_t chunk) const { return items.subspan(range(chunk).begin, range(chunk).size()); }

    // Calls work(chunk) for each chunk.
    template <class Work>
    void for_each(const Work& work) const {
        if (threads == 1) return work(0);
        parallel_for(count, threads, work);
    }
};

struct Bin {
    Box4 box = kEmptyBox4;
    std::size_t items = 0;

    void add(const Bin& bin) {
        extend(box, bin.box);
        items += bin.items;
    }
};

using Bins = std::array<Bin, kBins>;  // all bins along one axis

// The division of the range of the items' doubled centres along each axis into kBins equal bins.
struct Binning {
    Float4 low, bins_per_unit{};

    explicit Binning(const Box4& centres) : low(centres.low) {
        for (int axis = 0; axis < 3; ++axis) {
            const float range = centres.high[axis] - low[axis], quotient = static_cast<float>(kBins) / range;
            if (range > 0 && quotient < kInfinity) bins_per_unit[axis] = quotient;
        }
    }
    // Returns the bin along each axis; the fourth element is unused.
    Int4 bins(const Float4& doubled_centre) const {
        constexpr float kLast = kBins - 1;
        const Float4 bin = (doubled_centre - low) * bins_per_unit;
        return __builtin_convertvector(smaller(Float4{kLast, kLast, kLast, 0}, bin), Int4);
    }
};

std::array<Bins, 3> filled_bins(std::span<const BvhItem> items, const Binning& binning) {
    std::array<Bins, 3> axes;
    for (const BvhItem& item : items) {
        const Box4 box = box_of(item);
        const Int4 bins = binning.bins(box.low + box.high);
        for (int axis = 0; axis < 3; ++axis) {
            Bin& bin = axes[static_cast<std::size_t>(axis)][static_cast<std::size_t>(bins[axis])];
            extend(bin.box, box);
            ++bin.items;
        }
    }
    return axes;
}

std::array<Bins, 3> filled_bins(const Chunks& chunks, const Binning& binning) {
    if (chunks.count == 1) return filled_bins(chunks.items, binning);
    std::vector<std::array<Bins, 3>> of_chunks(chunks.count);
    chunks.for_each([&](std::size_t chunk) { of_chunks[chunk] = filled_bins(chunks.of(chunk), binning); });
    for (std::size_t chunk = 1; chunk < chunks.count; ++chunk)
        for (std::size_t axis = 0; axis < 3; ++axis)
            for (std::size_t b = 0; b < kBins; ++b) of_chunks[0][axis][b].add(of_chunks[chunk][axis][b]);
    return of_chunks[0];
}

// A split plane perpendicular to `axis`, below the bin `first_above`.
struct Split {
    float cost = kInfinity;
    std::size_t axis = 0, first_above = 0;
};

// Replaces `best` by the cheapest split along `axis` if that split is cheaper than `best`.
void improve_split(Split& best, std::size_t axis, const Bins& bins) {
    const auto cost_of = [](const Bin& sum) { return half_area(sum.box) * leaf_count(sum.items); };
    std::array<float, kBins> cost_from;  // cost_from[b]: cost of bin b and all bins above it
    Bin sum;
    for (std::size_t b = kBins; b-- > 0;) {
        if (bins[b].items == 0) continue;
        sum.add(bins[b]);
        cost_from[b] = cost_of(sum);
    }
    sum = {};
    for (std::size_t b = 0; b < kBins; ++b) {
        if (bins[b].items == 0) continue;
        const float cost = sum.items > 0 ? cost_of(sum) + cost_from[b] : kInfinity;
        if (cost < best.cost) best = {cost, axis, b};
        sum.add(bins[b]);
    }
}

// Returns the part that consists of `items`, at least one. Uses up to `threads` threads.
Part part_of(std::span<BvhItem> items, unsigned threads) {
    const Chunks chunks(items, threads);
    std::vector<std::array<Box4, 2>> of_chunks(chunks.count, {kEmptyBox4, kEmptyBox4});  // boxes; centres
    chunks.for_each([&](std::size_t chunk) {
        std::array<Box4, 2> boxes = of_chunks[chunk];
        for (const BvhItem& item : chunks.of(chunk)) {
            const Box4 box = box_of(item);
            extend(boxes[0], box);
            extend(boxes[1], {box.low + box.high, box.low + box.high});
        }
        of_chunks[chunk] = boxes;
    });
    for (std::size_t chunk = 1; chunk < chunks.count; ++chunk)
        for (std::size_t i = 0; i < 2; ++i) extend(of_chunks[0][i], of_chunks[chunk][i]);
    return make_part(items, of_chunks[0][0], of_chunks[0][1]);
}

using Parts = std::array<Part, 2>;

// Splits a part after its first `items` items.
Parts split_after(const Part& part, std::size_t items, unsigned threads) {
    return {part_of(part.items.first(items), threads), part_of(part.items.subspan(items), threads)};
}

// Splits the items into two equal halves by object number.
Parts split_by_number(const Part& part, unsigned threads) {
    const std::size_t half = part.items.size() / 2;
    std::ranges::nth_element(part.items, part.items.begin() + static_cast<std::ptrdiff_t>(half), {}, &BvhItem::number);
    return split_after(part, half, threads);
}

// Splits the items into those of the lowest kind and the others.
Parts split_by_kind(const Part& part) {
    const std::uint32_t lowest = std::ranges::min(part.items, {}, &BvhItem::kind).kind;
    const auto others =
        std::partition(part.items.begin(), part.items.end(), [&](const BvhItem& item) { return item.kind == lowest; });
    return split_after(part, static_cast<std::size_t>(others - part.items.begin()), 1);
}

// The items of a chunk below the split plane, which come first, and those above it.
struct Sides {
    std::size_t below = 0;                                   // number of items below the plane
    std::array<Box4, 2> centres = {kEmptyBox4, kEmptyBox4};  // doubled centres: below, above
};

Sides partition_at(std::span<BvhItem> items, const Split& plane, const Binning& binning) {
    Sides sides;
    for (BvhItem& slot : items) {
        const Item4 item(slot);
        const Box4 box = item.box();
        const Float4 centre = box.low + box.high;
        const bool above = static_cast<std::size_t>(binning.bins(centre)[plane.axis]) >= plane.first_above;
        // Without a branch, which the processor would often mispredict.
        BvhItem& first_above = items[sides.below];
        Item4(first_above).store(slot);
        item.store(first_above);
        sides.below += !above;
        extend(sides.centres[above], {centre, centre});
    }
    return sides;
}

// Exchanges items of partitioned chunks so that all items below the plane come first. `below`: their number.
void join_chunks(const Chunks& chunks, const std::vector<Sides>& sides, std::size_t below) {
    // Runs of items above the plane among the first `below` items, and the converse; both have the same number of
    // items.
    std::vector<std::span<BvhItem>> above_first, below_last;
    for (std::size_t chunk = 0; chunk < chunks.count; ++chunk) {
        const auto [begin, end] = chunks.range(chunk);
        const std::size_t middle = begin + sides[chunk].below;  // first item of the chunk above the plane
        if (middle < below) above_first.push_back(chunks.items.subspan(middle, std::min(end, below) - middle));
        const std::size_t first = std::max(begin, below);
        if (first < middle) below_last.push_back(chunks.items.subspan(first, middle - first));
    }
    for (std::size_t i = 0, j = 0; i < above_first.size() && j < below_last.size();) {
        std::span<BvhItem>&above = above_first[i], &last = below_last[j];
        const std::size_t items = std::min(above.size(), last.size());
        std::ranges::swap_ranges(above.first(items), last.first(items));
        above = above.subspan(items);
        last = last.subspan(items);
        i += above.empty();
        j += last.empty();
    }
}

// Splits the items into those in the bins below Split::first_above and the others. The boxes of the parts are the
// unions of the bins' boxes.
Parts split_at(const Part& part, const Split& plane, const Bins& bins, const Binning& binning, const Chunks& chunks) {
    std::vector<Sides> sides(chunks.count);
    chunks.for_each([&](std::size_t chunk) { sides[chunk] = partition_at(chunks.of(chunk), plane, binning); });
    std::array<Bin, 2> sums;
    for (std::size_t b = 0; b < kBins; ++b) sums[b >= plane.first_above].add(bins[b]);
    if (chunks.count > 1) join_chunks(chunks, sides, sums[0].items);
    std::array<Box4, 2> centres = {kEmptyBox4, kEmptyBox4};
    for (const Sides& of_chunk : sides)
        for (std::size_t side = 0; side < 2; ++side) extend(centres[side], of_chunk.centres[side]);
    return {make_part(part.items.first(sums[0].items), sums[0].box, centres[0]),
            make_part(part.items.subspan(sums[0].items), sums[1].box, centres[1])};
}

Bounds bounds_of(const Box4& box) {
    return {{box.low[0], box.low[1], box.low[2]}, {box.high[0], box.high[1], box.high[2]}};
}

// Splits a part that is not a leaf: by kind if it has few items of several kinds, by number if it is deep in the tree
// or no bin boundary separates its items, otherwise at the cheapest split plane. Reorders the part's items. Which item
// is in which part depends neither on their order nor on the number of threads. `depth`: depth of the node whose child
// the part is.
Parts split(const Part& part, std::uint32_t depth, unsigned threads) {
    if (part.items.size() <= RAYA_BVH_WIDTH && !are_of_one_kind(part.items)) return split_by_kind(part);
    if (depth >= kMedianDepth) return split_by_number(part, threads);
    const Chunks chunks(part.items, threads);
    const Binning binning(part.centres);
    const std::array<Bins, 3> bins = filled_bins(chunks, binning);
    Split best;
    for (std::size_t axis = 0; axis < 3; ++axis) improve_split(best, axis, bins[axis]);
    if (best.cost == kInfinity) return split_by_number(part, threads);
    return split_at(part, best, bins[best.axis], binning, chunks);
}

// Upper bound of the traversal's rounding error in the position of a box side, for ray origins with coordinates up to
// `reach`. Along each axis the kernel computes the distance t to a side as side * (1 / D) - O * (1 / D), with rounded
// results, so t has an error of at most 4 2^-24 (|side| + |O|) / |D|. The bound has a margin of a factor of 2.
double traversal_error(double side, double reach) { return 8 * 0x1p-24 * (std::abs(side) + reach); }

// below() and above() return x rounded to a float that is at most, or at least, x.
float below(double x) {
    const auto nearest = static_cast<float>(x);
    return nearest > x ? std::nextafter(nearest, -kInfinity) : nearest;
}
float above(double x) { return -below(-x); }

Bounds bounds_of(const Box& box, double reach) {
    Bounds bounds{};
    for (int axis = 0; axis < 3; ++axis) {
        const auto a = static_cast<std::size_t>(axis);
        bounds.low[a] = below(box.min[axis] - traversal_error(box.min[axis], reach));
        bounds.high[a] = above(box.max[axis] + traversal_error(box.max[axis], reach));
    }
    return bounds;
}

// Returns max_slack of reach_for(): boxes may grow by a fraction of their mean longest side. In reduced formats only
// the boxes of cones and the margin for the traversal grow with the reach.
double max_slack(const HitRegions& regions, const raya_objects& objects) {
    constexpr double kFractionOfBox = 1.0 / 64;
    if (regions.size() == 0) return -1;
    double sides = 0;
    for (std::size_t i = 0; i < regions.size(); ++i) sides += largest_coordinate(regions.box(i).size());
    const double growth = kFractionOfBox * (sides / static_cast<double>(regions.size()));
    if (regions.spread(RAYA_SPHERE) == 0 || objects.cones > 0) return growth;
    return growth * regions.slack(2) / traversal_error(0.5 * regions.reach(), regions.reach());
}

// Returns the kind of leaf (RAYA_LINK_*) in which an object is stored.
std::uint32_t kind_of(const PackedJob& job, const NumberFormat& format, std::uint32_t number) {
    // In a reduced format, polygons with more corners are stored in leaves for one polygon.
    constexpr std::uint32_t kMaxObjectCorners = 16;
    const std::uint32_t kind = kind_of_object(job.header().objects, number);
    const std::uint32_t corners = kind == RAYA_POLYGON ? job.object(number)[RAYA_POLYGON_CORNERS] : 0;
    if (!format.is_fp32()) return corners > kMaxObjectCorners ? RAYA_LINK_POLYGON : RAYA_LINK_OBJECT;
    if (kind == RAYA_POLYGON) return corners <= RAYA_BVH_MAX_CORNERS ? RAYA_LINK_FACES : RAYA_LINK_POLYGON;
    if (kind == RAYA_SPHERE) return RAYA_LINK_SPHERES;
    return RAYA_LINK_POLYGON + (kind - RAYA_POLYGON);  // both lists are in the order of RAYA_SHAPE_LIST
}

// Large objects (the ground below a scene, walls around it) are listed separately. Nearly every ray reaches them, and
// testing such an object for V rays at once takes less time per ray than visiting a leaf. If there are more than
// kMaxSeparate large objects, none is listed separately.
constexpr std::size_t kMaxSeparate = 8;
// An object is large if the area of its box is more than this fraction of the area of the whole scene's box.
constexpr float kLargeArea = 1.0F / 8;

void separate_large_items(BvhItems& objects) {
    Box4 whole = kEmptyBox4;
    for (const BvhItem& item : objects.items) extend(whole, box_of(item));
    const auto is_large = [&](const BvhItem& item) { return half_area(box_of(item)) > kLargeArea * half_area(whole); };
    std::vector<std::uint32_t> large;
    for (const BvhItem& item : objects.items) {
        if (is_large(item)) large.push_back(item.number);
        if (large.size() > kMaxSeparate) return;
    }
    if (large.empty()) return;
    objects.separate = std::move(large);
    std::erase_if(objects.items, is_large);
}

}  // namespace

BvhItems bvh_items(const PackedJob& job, const NumberFormat& format, unsigned threads) {
    BvhItems objects;
    const raya_objects& all = job.header().objects;
    const HitRegions regions(job, format, reach_for(job, format, [&](const auto& r) { return max_slack(r, all); }));
    if (!regions.all_bounded()) return objects;
    objects.reach = regions.reach();
    resize_in_huge_pages(objects.items, regions.size());
    parallel_for_items(regions.size(), threads, 1 << 12, [&](std::size_t i) {
        const std::uint32_t number = regions.number(i);
        objects.items[i] = {bounds_of(regions.box(i), objects.reach), number, kind_of(job, format, number)};
    });
    separate_large_items(objects);
    for (const BvhItem& item : objects.items)
        objects.spread = std::max(objects.spread, regions.spread(kind_of_object(all, item.number)));
    return objects;
}

bool bvh_pays(const Scene& scene, const NumberFormat& format) {
    constexpr double kMinCost = 160;  // minimum cost of testing a ray against all objects, in sphere tests
    double corners = 0;
    for (const Polygon& polygon : scene.polygons) corners += static_cast<double>(polygon.vertices.size());
    const auto spheres = static_cast<double>(scene.spheres.size()), cones = static_cast<double>(scene.cones.size());
    return kMinCost < (format.is_fp32() ? spheres + 1.25 * corners + 8 * cones : spheres + 3 * corners + 32 * cones);
}

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
            std::ranges::sort(part.items, {}, &BvhItem::number);
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
            const Parts pieces = split(*largest, depth, threads);
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
