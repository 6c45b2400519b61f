// The tree that a PE of the ring machine walks its rays through: built over a job's objects, and packed behind it.
#pragma once
#include "host/accel/accel.hpp"
#include "host/accel/tree.hpp"
#include "host/machine/number_format.hpp"
#include "host/scene/packer.hpp"

namespace raya {

/// The finite objects of a job in boxes that hold every point at which the kernels can compute a hit of them
/// (hit_regions.hpp), and room for the rounding of the walk.
struct TreeItems {
    std::vector<TreeItem> items;  // none where no such boxes are known
    double reach = -1;            // largest coordinate of the origins of rays that they are good for
};
TreeItems tree_items(const PackedJob& job, const NumberFormat& format);

/// Appends a tree to the job's words as kernels/shared/bvh.h lays it out, and points accel_at to it. UserError where
/// its rows are too many.
AccelSummary append_tree(PackedJob& job, const NumberFormat& format);

}  // namespace raya
