// Splitting of the items of a BVH by the surface area heuristic: the binned search for the cheapest split plane.
#pragma once
#include <array>
#include <cstdint>
#include <span>

#include "host/accel/bvh.hpp"

namespace raya {

/// Four floats that are computed at once: x, y, z and an unused one. gcc and clang compile operations on them to vector
/// instructions or, on processors without vectors of four floats, to scalar ones with the same results.
using Float4 = float __attribute__((vector_size(16)));

struct Box4 {
    Float4 low, high;
};
inline constexpr Box4 kEmptyBox4 = {{kInfinity, kInfinity, kInfinity, kInfinity},
                                    {-kInfinity, -kInfinity, -kInfinity, -kInfinity}};

Bounds bounds_of(const Box4& box);

/// Items that will become one child of a node.
struct Part {
    std::span<BvhItem> items;
    Box4 box = kEmptyBox4;      // of the items
    Box4 centres = kEmptyBox4;  // of the doubled centres of the items' boxes: low + high
    float half_area = 0;        // of `box`
    bool is_leaf = false;       // the items fit into one leaf
};

/// Returns the part that consists of `items`, at least one. Uses up to `threads` threads.
Part part_of(std::span<BvhItem> items, unsigned threads);

/// Splits a part that is not a leaf: by kind if it has few items of several kinds, by number if it is deep in the tree
/// or no bin boundary separates its items, otherwise at the cheapest split plane. Reorders the part's items. Which item
/// is in which part depends neither on their order nor on the number of threads. `depth`: depth of the node whose child
/// the part is.
std::array<Part, 2> split(const Part& part, std::uint32_t depth, unsigned threads);

}  // namespace raya
