// Voxel partition: divides a scene's bounding box into voxels. Each voxel has a list of the objects of which a kernel
// can compute a hit in the voxel.
#pragma once
#include <cstdint>
#include <vector>

#include "host/model/machine.hpp"
#include "host/model/number_format.hpp"
#include "host/scene/packer.hpp"
#include "kernels/shared/grid.h"

namespace raya {

inline constexpr std::uint64_t kMaxPartitionVoxels = std::uint64_t{1} << 24;

/// A uniform grid of voxels, each with a list of object numbers (the numbers of kernels/shared/job.h). Infinite planes
/// are in no list, because every ray is tested against them.
struct Partition {
    raya_grid grid{};
    std::vector<std::uint32_t> starts;    // [voxels + 1]: voxel v lists objects[starts[v] .. starts[v + 1] - 1]
    std::vector<std::uint32_t> objects;   // concatenated lists, each ascending
    std::vector<std::uint32_t> separate;  // numbers of the separate objects, ascending
    std::uint64_t listed_objects = 0;     // number of objects in the lists: the finite objects except `separate`
    /// Number of list entries beyond one for each object.
    std::uint64_t copies() const { return objects.size() - listed_objects; }
};

/// Divides the bounding box of all finite objects except the separate ones (`separate`: object numbers, ascending) into
/// voxels. If there are no such objects, the box is the unit cube around the origin. Uses the rounded numbers in the
/// job's words, as the kernels do.
///
/// The lists are conservative, so that hits do not depend on the voxels through which the traversal passes. Consider a
/// ray whose origin O has coordinates up to `grid.reach` in magnitude and whose direction D has length 1 up to
/// rounding, so that is_wide() in kernels/grid/traversal.clh is false. If a kernel in the format computes a hit of an
/// object at distance t, then the voxel in which the traversal is at distance t lists the object, in spite of the
/// traversal's rounding errors. If the hit regions are unbounded (HitRegions::all_bounded() is false: Y < 10, squares
/// of lengths that overflow the format, or cones too steep for the format), every object is in every list, the box
/// contains all points within RAYA_FAR, and the reach is RAYA_FAR.
///
/// Throws UserError if a division is 0, there are more than kMaxPartitionVoxels voxels, or the lists would have more
/// than 2^30 entries in total (4 GB).
Partition partition(const PackedJob& job, const NumberFormat& format, const Divisions& divisions,
                    const std::vector<std::uint32_t>& separate = {});

/// Returns the divisions of an acceleration grid along each axis, for about `voxels` (1..2^24) voxels that are nearly
/// cubes. Chooses fewer voxels if the lists would otherwise have, on average, more than 16 entries per voxel and more
/// than 16 per object. Returns 1x1x1 if the hit regions are unbounded.
Divisions divisions_for(const PackedJob& job, const NumberFormat& format, std::uint64_t voxels,
                        const std::vector<std::uint32_t>& separate = {});

/// Returns the partition of `--accel grid`. If the option gives the divisions, the partition covers all finite objects.
/// Otherwise large_objects() are listed separately, and the box of the other objects is divided into kVoxelsPerObject
/// voxels per object. Without the separate list, the ground or the walls of a room would enlarge the box so much that
/// all other objects would lie in few voxels.
Partition accel_partition(const PackedJob& job, const NumberFormat& format, const Accel& accel);

/// Returns the numbers of the large objects, ascending. In each pass, an object is large if its longest side exceeds
/// kLargeSide times the longest side of the box around all remaining objects; the pass removes the large objects. The
/// passes end when no object is large, or before a pass that would bring the number of removed objects above kMaxLarge.
std::vector<std::uint32_t> large_objects(const PackedJob& job, const NumberFormat& format);

/// Appends the partition to the job's words in the layout of kernels/shared/grid.h, and sets accel_at in the job's
/// header. Throws UserError if 32-bit indices cannot address all words.
AccelSummary append_grid(PackedJob& job, const Partition& partition);

}  // namespace raya
