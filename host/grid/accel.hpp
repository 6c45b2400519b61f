// The grid that a PE of the ring machine walks its rays through: chosen for a scene, and packed behind its job.
#pragma once
#include <cstdint>
#include <optional>
#include <string>

#include "host/grid/partition.hpp"

namespace raya {

/// How rays find their nearest hit.
struct Accel {
    bool grid = false;                   // false: every ray is tested against all objects
    std::optional<Divisions> divisions;  // of the whole scene's box; empty: automatic, see accel_partition
};

/// What `--accel` takes: "none", "grid", "grid:4x4x4".
std::string accel_text(const Accel& accel);

/// A grid of given divisions cuts the box of the whole scene. The automatic one holds large objects apart (the ground
/// below everything else, the walls of a room), which would leave the rest in few of the voxels, and cuts the box of
/// the rest into kVoxelsPerObject voxels an object.
Partition accel_partition(const PackedJob& job, const NumberFormat& format, const Accel& accel);

/// Numbers of the large objects, ascending: those whose box is more than half as long as the box of all finite objects,
/// as long as there are few of them; then those of the rest likewise, until there are none. Every ray is tested against
/// each of them.
std::vector<std::uint32_t> large_objects(const PackedJob& job, const NumberFormat& format);

/// What was made of a grid, for reports.
struct AccelSummary {
    Divisions divisions{};
    std::uint64_t copies = 0;  // entries of lists beyond each object's first
    std::uint64_t words = 0;   // of the job that hold the grid
    std::uint32_t apart = 0;   // objects that every ray is tested against
};

/// Appends the partition to the job's words as kernels/shared/grid.h lays it out, and points grid_at to it.
/// UserError where 32-bit numbers of words do not reach.
AccelSummary append_grid(PackedJob& job, const Partition& partition);

}  // namespace raya
