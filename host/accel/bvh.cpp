#include "host/accel/bvh.hpp"

#include <algorithm>
#include <cmath>
#include <deque>
#include <mutex>

#include "host/accel/bvh_split.hpp"
#include "host/accel/hit_regions.hpp"
#include "host/base/parallel.hpp"

namespace raya {
namespace {

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

// Chooses the reach: the maximum coordinate of ray origins for which the boxes are valid, in multiples of the scene's
// extent. Reflected rays can start anywhere on an infinite plane, so a scene with planes gets a larger reach: it is
// doubled up to kMax as long as regions stay bounded and grow by at most kFractionOfBox of their mean longest side.
double reach_for(const PackedJob& job, const NumberFormat& format) {
    constexpr double kMin = 2, kMax = 1024, kFractionOfBox = 1.0 / 64;
    const HitRegions regions(job, format, kMin);
    if (!regions.all_bounded() || regions.size() == 0 || job.header().objects.planes == 0) return kMin;
    double sides = 0;
    for (std::size_t i = 0; i < regions.size(); ++i) {
        const Vec3 size = regions.region(i).box.size();
        sides += std::max({size.x, size.y, size.z});
    }
    const double mean_side = sides / static_cast<double>(regions.size());
    double reach = kMin;
    while (reach < kMax && regions.slack(2 * reach) <= kFractionOfBox * mean_side &&
           HitRegions(job, format, 2 * reach).all_bounded())
        reach *= 2;
    return reach;
}

// Returns the kind of leaf (RAYA_LINK_*) in which an object is stored.
std::uint32_t kind_of(const PackedJob& job, const NumberFormat& format, std::uint32_t number) {
    // In a reduced format, polygons with more corners are stored in leaves for one polygon.
    constexpr std::uint32_t kMaxObjectCorners = 16;
    const raya_objects& objects = job.header().objects;
    const bool is_polygon = number >= objects.spheres && number < objects.spheres + objects.planes + objects.polygons;
    const std::uint32_t corners = is_polygon ? polygon_words(job, number)[RAYA_POLYGON_CORNERS] : 0;
    if (!format.is_fp32()) return corners > kMaxObjectCorners ? RAYA_LINK_POLYGON : RAYA_LINK_OBJECT;
    if (is_polygon) return corners <= RAYA_BVH_MAX_CORNERS ? RAYA_LINK_FACES : RAYA_LINK_POLYGON;
    return number < objects.spheres ? RAYA_LINK_SPHERES : RAYA_LINK_CONES;
}

// Large objects (the ground below a scene, walls around it) are listed separately. Nearly every ray reaches them, and
// testing such an object for V rays at once takes less time per ray than visiting a leaf. If there are more than
// kMaxSeparate large objects, none is listed separately.
constexpr std::size_t kMaxSeparate = 8;
// An object is large if the area of its box is more than this fraction of the area of the whole scene's box.
constexpr float kLargeArea = 1.0F / 8;

void separate_large_items(BvhItems& objects) {
    Bounds whole = kEmptyBounds;
    for (const BvhItem& item : objects.items) extend(whole, item.box);
    const auto is_large = [&](const BvhItem& item) { return half_area(item.box) > kLargeArea * half_area(whole); };
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

const std::uint32_t* polygon_words(const PackedJob& job, std::uint32_t number) {
    const raya_objects& objects = job.header().objects;
    const std::size_t polygon = number - objects.spheres - objects.planes;
    return job.words().data() + objects.polygons_at + polygon * RAYA_POLYGON_WORDS;
}

BvhItems bvh_items(const PackedJob& job, const NumberFormat& format, unsigned threads) {
    constexpr std::size_t kMinItems = 1 << 12;  // of a thread
    BvhItems objects;
    const HitRegions regions(job, format, reach_for(job, format));
    if (!regions.all_bounded()) return objects;
    objects.reach = regions.reach();
    objects.items.resize(regions.size());
    const std::size_t parts = std::min<std::size_t>(4 * threads, 1 + regions.size() / kMinItems);
    parallel_for(parts, threads, [&](std::size_t part) {
        const auto [begin, end] = part_of_range(part, parts, regions.size());
        for (std::size_t i = begin; i < end; ++i) {
            const std::uint32_t number = regions.number(i);
            objects.items[i] = {bounds_of(regions.region(i).box, objects.reach), number, kind_of(job, format, number)};
        }
    });
    separate_large_items(objects);
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
