// The grid that a PE of the ring machine walks its rays through: chosen for a scene, and packed behind its job.
#pragma once
#include <cstdint>
#include <vector>

#include "host/accel/partition.hpp"
#include "host/model/accel.hpp"

namespace raya {

/// A grid of given divisions cuts the box of the whole scene. The automatic one holds large objects apart (the ground
/// below everything else, the walls of a room), which would leave the rest in few of the voxels, and cuts the box of
/// the rest into kVoxelsPerObject voxels an object.
Partition accel_partition(const PackedJob& job, const NumberFormat& format, const Accel& accel);

/// Numbers of the large objects, ascending: those whose box is more than half as long as the box of all finite objects,
/// as long as there are few of them; then those of the rest likewise, until there are none. Every ray is tested against
/// each of them.
std::vector<std::uint32_t> large_objects(const PackedJob& job, const NumberFormat& format);

/// Appends the partition to the job's words as kernels/shared/grid.h lays it out, and points accel_at to it.
/// UserError where 32-bit numbers of words do not reach.
AccelSummary append_grid(PackedJob& job, const Partition& partition);

}  // namespace raya
