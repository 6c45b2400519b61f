// The reference for kernels/grid/traversal.clh: finds the voxels that a ray crosses, in double precision, by recursive
// bisection of the box.
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "kernels/shared/grid.h"
#include "tests/reference/reference.hpp"

namespace raya {

/// A cuboid of voxels: first .. end - 1 along each axis.
struct VoxelBlock {
    std::array<std::uint32_t, 3> first, end;
};

inline VoxelBlock all_voxels(const raya_grid& g) {
    return {{0, 0, 0}, {g.divisions[0], g.divisions[1], g.divisions[2]}};
}

inline VoxelBlock one_voxel(const raya_grid& g, std::uint32_t voxel) {
    VoxelBlock b;
    b.first = {voxel % g.divisions[0], voxel / g.divisions[0] % g.divisions[1],
               voxel / g.divisions[0] / g.divisions[1]};
    for (std::size_t axis = 0; axis < 3; ++axis) b.end[axis] = b.first[axis] + 1;
    return b;
}

/// The interval in <= t <= out in which a ray is in a block; empty if in > out.
struct Passage {
    double in = 0, out = std::numeric_limits<double>::infinity();
    bool empty() const { return in > out; }
};

/// Returns the interval of t >= 0 in which the ray is in the block, after the block's planes have been moved outward by
/// `slack` (inward if it is negative).
inline Passage passage(const raya_grid& g, const VoxelBlock& block, const reference::Ray& ray, double slack) {
    Passage p;
    for (std::uint32_t axis = 0; axis < 3; ++axis) {
        const int a = static_cast<int>(axis);
        const double low = raya_voxel_plane(g, axis, block.first[axis]) - slack - ray.origin[a];
        const double high = raya_voxel_plane(g, axis, block.end[axis]) + slack - ray.origin[a];
        if (ray.direction[a] == 0) {
            if (low > 0 || high < 0) p.out = -1;
            continue;
        }
        const double first = low / ray.direction[a], second = high / ray.direction[a];
        p.in = std::max(p.in, std::min(first, second));
        p.out = std::min(p.out, low > high ? -1 : std::max(first, second));
    }
    return p;
}

/// Adds, in no particular order, the voxels of the block that the ray still crosses if their planes are moved inward by
/// `slack`.
inline void add_crossed(const raya_grid& g, const VoxelBlock& block, const reference::Ray& ray, double slack,
                        std::vector<std::uint32_t>& voxels) {
    if (passage(g, block, ray, -slack).empty()) return;
    std::size_t longest = 0;
    for (std::size_t axis = 1; axis < 3; ++axis)
        if (block.end[axis] - block.first[axis] > block.end[longest] - block.first[longest]) longest = axis;
    const std::uint32_t middle = (block.first[longest] + block.end[longest]) / 2;
    if (middle == block.first[longest]) {
        voxels.push_back(raya_voxel(g, block.first[0], block.first[1], block.first[2]));
        return;
    }
    VoxelBlock lower = block, upper = block;
    lower.end[longest] = upper.first[longest] = middle;
    add_crossed(g, lower, ray, slack, voxels);
    add_crossed(g, upper, ray, slack, voxels);
}

}  // namespace raya
