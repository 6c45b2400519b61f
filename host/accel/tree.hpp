// A tree of boxes, up to sixteen children a node: built top down by the surface area heuristic (Goldsmith & Salmon
// 1987; binned, Wald 2007; nodes with many children, Wald, Benthin & Boulos 2008).
#pragma once
#include <array>
#include <cstdint>
#include <limits>
#include <vector>

#include "host/model/machine.hpp"
#include "host/model/number_format.hpp"
#include "host/scene/packer.hpp"
#include "kernels/shared/bvh.h"

namespace raya {

inline constexpr float kInfinity = std::numeric_limits<float>::infinity();

/// A box in fp32.
struct Bounds {
    std::array<float, 3> low, high;
};
constexpr Bounds kNowhere = {{kInfinity, kInfinity, kInfinity}, {-kInfinity, -kInfinity, -kInfinity}};

void extend(Bounds& box, const Bounds& by);
/// Half the surface; 0 of nowhere.
float area(const Bounds& box);

/// What a tree is built over.
struct TreeItem {
    Bounds box;
    std::uint32_t number;  // of the object
    std::uint32_t kind;    // RAYA_LINK_SPHERES, _FACES, _POLYGON, _CONES or _OBJECT: a leaf has one
};

struct TreeChild {
    Bounds box;
    std::uint32_t kind;   // RAYA_LINK_*
    std::uint32_t first;  // of a node: its number; of a leaf: its first item
    std::uint32_t items;  // of a leaf: how many, 1..most_in_leaf(kind)
};

struct TreeNode {
    std::array<TreeChild, RAYA_BVH_WIDTH> children;
    std::uint32_t count;  // of them
};

struct Tree {
    std::vector<TreeItem> items;  // in the order of the leaves, in each by number
    std::vector<TreeNode> nodes;  // children behind their parents
    TreeChild root{};             // of no meaning where there are no items
    std::uint32_t depth = 0;      // nodes on the longest way down
};

/// How many items a leaf of a kind holds at most: 16, or the one that fills it.
std::uint32_t most_in_leaf(std::uint32_t kind);

/// The same tree for the same items on every machine.
Tree build_tree(std::vector<TreeItem> items);

/// Appends a tree over the finite objects of a job to its words, as kernels/shared/bvh.h lays it out, and points
/// accel_at to it. Boxes hold every point at which the kernels can compute a hit of what is in them (hit_regions.hpp),
/// and room for the walk's rounding. UserError where its rows are too many.
AccelSummary append_tree(PackedJob& job, const NumberFormat& format);

/// Whether a tree is sooner than testing every ray against all objects, as measured on a CPU of sixteen lanes.
bool tree_pays(const Scene& scene, const NumberFormat& format);

}  // namespace raya
