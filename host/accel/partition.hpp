// Cuts a scene's box into voxels and registers each object in every voxel in which a kernel could find a hit of it.
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

inline constexpr std::uint64_t kMostCutVoxels = std::uint64_t{1} << 24;  // of one partition

/// Lists that would have more than 2^30 entries: 4 GB of words.
struct TooManyEntries : UserError {
    using UserError::UserError;
};

/// Which objects touch which voxel. Objects are numbered as in the job (kernels/shared/job.h). Planes are infinite:
/// they are in no list, and are tested for every ray.
struct Partition {
    raya_grid grid{};
    std::vector<std::uint32_t> starts;   // [voxels + 1]: where the lists of the voxels start in `objects`
    std::vector<std::uint32_t> objects;  // lists one after another, each ascending
    std::vector<std::uint32_t> apart;    // finite objects in no list, ascending: tested for every ray, as planes are
    std::uint64_t distinct = 0;          // objects in at least one list: all that are finite and not apart
    std::uint64_t copies() const { return objects.size() - distinct; }
};

/// The box holds all finite objects; a scene without any gets a box about its origin. Objects are seen as the kernels
/// see them, from the job's words.
///
/// Registration is conservative, so that hits do not depend on the way by which a ray came: wherever a kernel of that
/// format, for a ray from an origin within `grid.reach` and of a direction of length 1 (not is_wide() in
/// kernels/grid/walk.clh), computes a hit at distance t, the point O + t D lies in a voxel that has the object in its
/// list, even where the walk is off by its own rounding. Where no bound is known (Y < 10; scenes whose squares leave
/// the format; cones too steep for it) every object is in every list, the box holds all points within RAYA_FAR, and
/// reach is RAYA_FAR.
/// UserError for 0 divisions or more than kMostCutVoxels, TooManyEntries.
/// Objects `apart` (numbers, ascending) are in no list, and the box need not hold them.
Partition partition(const PackedJob& job, const NumberFormat& format, const Divisions& divisions,
                    const std::vector<std::uint32_t>& apart = {});

/// Divisions for an accelerating grid: about `voxels` in all, 1 to 2^24, their sides as equal as the box allows. Fewer
/// where lists would grow without use, as the format's rounding puts each object into many voxels; 1x1x1 where no bound
/// is known.
Divisions divisions_for(const PackedJob& job, const NumberFormat& format, std::uint64_t voxels,
                        const std::vector<std::uint32_t>& apart = {});

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
