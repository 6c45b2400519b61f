// BVH with up to sixteen children per node, built top down by the surface area heuristic (Goldsmith & Salmon 1987;
// binned, Wald 2007; nodes with many children, Wald, Benthin & Boulos 2008).
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

/// An axis-aligned box in fp32.
struct Bounds {
    std::array<float, 3> low, high;
};
constexpr Bounds kEmptyBounds = {{kInfinity, kInfinity, kInfinity}, {-kInfinity, -kInfinity, -kInfinity}};

void extend(Bounds& box, const Bounds& by);
/// Half the surface area; 0 for kEmptyBounds.
float area(const Bounds& box);

/// An object in a BVH.
struct BvhItem {
    Bounds box;
    std::uint32_t number;  // of the object
    std::uint32_t kind;    // RAYA_LINK_SPHERES, _FACES, _POLYGON, _CONES or _OBJECT: equal within a leaf
};

struct BvhChild {
    Bounds box;
    std::uint32_t kind;   // RAYA_LINK_*
    std::uint32_t first;  // a node's number; a leaf's first item
    std::uint32_t items;  // of a leaf: number of items, 1..max_leaf_items(kind)
};

struct BvhNode {
    std::array<BvhChild, RAYA_BVH_WIDTH> children;
    std::uint32_t count;  // of children
};

struct Bvh {
    std::vector<BvhItem> items;  // in the order of the leaves, within a leaf by number
    std::vector<BvhNode> nodes;  // parents before their children
    BvhChild root{};             // meaningless if there are no items
    std::uint32_t depth = 0;     // nodes on the longest path from the root
};

/// The maximum number of items of a leaf of a kind: 16 or 1.
std::uint32_t max_leaf_items(std::uint32_t kind);

/// Builds a BVH: the same one for the same items on every machine.
Bvh build_bvh(std::vector<BvhItem> items);

/// Appends a BVH over the finite objects of a job to its words, in the layout of kernels/shared/bvh.h, and sets
/// accel_at. A box contains every point at which the kernels can compute a hit of its objects (hit_regions.hpp), with a
/// margin for the rounding of the traversal. UserError if it has too many rows.
AccelSummary append_bvh(PackedJob& job, const NumberFormat& format);

/// Returns true if a BVH is faster than testing every ray against all objects, as measured on a CPU with sixteen lanes.
bool bvh_pays(const Scene& scene, const NumberFormat& format);

}  // namespace raya
