// Voxel partition: cuts a scene's bounding box into voxels and registers each object in every voxel in which a kernel
// could find a hit of it.
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "host/error.hpp"
#include "host/model/machine.hpp"
#include "host/model/number_format.hpp"
#include "host/scene/packer.hpp"
#include "kernels/shared/grid.h"

namespace raya {

inline constexpr std::uint64_t kMaxPartitionVoxels = std::uint64_t{1} << 24;

/// The lists would have more than 2^30 entries, 4 GB of words.
struct TooManyEntries : UserError {
    using UserError::UserError;
};

/// Voxels and their lists of objects, which are numbered as in the job (kernels/shared/job.h). Infinite planes are in
/// no list: every ray is tested against them.
struct Partition {
    raya_grid grid{};
    std::vector<std::uint32_t> starts;   // [voxels + 1]: starts of the voxels' lists in `objects`
    std::vector<std::uint32_t> objects;  // concatenated lists, each ascending
    std::vector<std::uint32_t> apart;    // finite objects in no list, ascending; every ray is tested against them
    std::uint64_t distinct = 0;          // objects in at least one list: all finite ones except `apart`
    std::uint64_t copies() const { return objects.size() - distinct; }
};

/// Partitions the bounding box of all finite objects except `apart` (numbers, ascending), which are in no list; the box
/// of a scene without finite objects is around the origin. Uses the numbers of the job's words, as the kernels do.
///
/// Registration is conservative, so that hits do not depend on the route of a ray through the voxels. Consider a ray
/// with an origin within `grid.reach` and a direction of length 1 (not is_wide() in kernels/grid/walk.clh). If a kernel
/// with that format computes a hit at distance t, the point O + t D is in a voxel with the object in its list, even
/// with the rounding of the walk. If no bound is known (Y < 10, scenes whose squares overflow the format, cones too
/// steep for it), every object is in every list, the box contains all points within RAYA_FAR, and the reach is
/// RAYA_FAR.
///
/// UserError if a division is 0 or there are more than kMaxPartitionVoxels voxels; TooManyEntries.
Partition partition(const PackedJob& job, const NumberFormat& format, const Divisions& divisions,
                    const std::vector<std::uint32_t>& apart = {});

/// Divisions of an acceleration grid: about `voxels` voxels, 1 to 2^24, as close to cubes as possible. Fewer if the
/// format's rounding would register each object in many voxels; 1x1x1 if no bound is known.
Divisions divisions_for(const PackedJob& job, const NumberFormat& format, std::uint64_t voxels,
                        const std::vector<std::uint32_t>& apart = {});

/// The partition of `--accel grid`. With given divisions it covers the whole scene. Otherwise large objects (the ground
/// below everything else, the walls of a room), which would leave all others in few voxels, are listed separately, and
/// the box of the others is cut into kVoxelsPerObject voxels per object.
Partition accel_partition(const PackedJob& job, const NumberFormat& format, const Accel& accel);

/// Numbers of the large objects, ascending: those whose box is longer than kLargeSide of the box of all finite objects,
/// if there are few of them; then repeatedly those of the remaining objects, until there are none. Every ray is tested
/// against all of them.
std::vector<std::uint32_t> large_objects(const PackedJob& job, const NumberFormat& format);

/// Appends the partition to the job's words in the layout of kernels/shared/grid.h, and sets accel_at. UserError if it
/// exceeds 32-bit indices.
AccelSummary append_grid(PackedJob& job, const Partition& partition);

}  // namespace raya
