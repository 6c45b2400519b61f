// BVH with up to sixteen children per node, built top down by the surface area heuristic (Goldsmith & Salmon 1987;
// binned, Wald 2007; nodes with many children, Wald, Benthin & Boulos 2008).
#pragma once
#include <array>
#include <cstdint>
#include <limits>
#include <vector>

#include "host/base/parallel.hpp"
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

/// An object in a BVH.
struct BvhItem {
    Bounds box;
    std::uint32_t number;  // object number
    // Kind of leaf: RAYA_LINK_SPHERES, _FACES, _POLYGON, _CONES or _OBJECT. All items of a leaf have the same kind.
    std::uint32_t kind;
};

/// A child of a node: a leaf or another node.
struct BvhChild {
    Bounds box;
    std::uint32_t kind;   // RAYA_LINK_*
    std::uint32_t first;  // of a node: its index in Bvh::nodes; of a leaf: index of its first item in Bvh::items
    std::uint32_t items;  // number of items of a leaf, 1..max_leaf_items(kind); 0 for a node
};

struct BvhNode {
    std::array<BvhChild, RAYA_BVH_WIDTH> children;
    std::uint32_t count;  // number of children
};

struct Bvh {
    std::vector<BvhItem> items;  // in the order of the leaves; within a leaf, by object number
    std::vector<BvhNode> nodes;  // parents before their children
    BvhChild root{};             // unused if there are no items
    std::uint32_t depth = 0;     // maximum number of nodes on a path from the root to a leaf
};

/// Maximum number of items in a leaf of this kind (RAYA_LINK_*): 16 or 1.
std::uint32_t max_leaf_items(std::uint32_t kind);

/// Builds a BVH on up to `threads` threads. The result depends only on the items, neither on their order nor on the
/// machine or the number of threads.
Bvh build_bvh(std::vector<BvhItem> items, unsigned threads = core_count());

/// Builds a BVH over the finite objects of a packed scene (job), appends it to the job's words in the layout of
/// kernels/shared/bvh.h, and sets accel_at in the job's header. The box of an object contains every point at which a
/// kernel can compute a hit of the object (hit_regions.hpp), with a margin for rounding errors of the traversal. Throws
/// UserError if the BVH has more 64-byte rows than a link can address. The words do not depend on the number of
/// threads.
AccelSummary append_bvh(PackedJob& job, const NumberFormat& format, unsigned threads = core_count());

/// Returns true if rendering this scene with a BVH is expected to be faster than testing every ray against all objects.
/// The threshold was measured on a CPU with sixteen lanes.
bool bvh_pays(const Scene& scene, const NumberFormat& format);

/// The finite objects of a job.
struct BvhItems {
    std::vector<BvhItem> items;           // empty if the hit regions are unbounded
    std::vector<std::uint32_t> separate;  // numbers of the separate objects, ascending
    double reach = -1;  // maximum coordinate of ray origins for which the boxes are valid; -1: no boxes
    double spread = 0;  // see raya_bvh
};

/// Returns the objects of a job with boxes that contain every point at which a kernel can compute a hit, with a margin
/// for rounding errors of the traversal. Uses up to `threads` threads.
BvhItems bvh_items(const PackedJob& job, const NumberFormat& format, unsigned threads);

}  // namespace raya
