// Partitions (lists of objects per voxel) of random scenes, and access to their lists.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "host/accel/partition.hpp"
#include "tests/accel/aimed_rays.hpp"

namespace raya {

inline PackedJob job_in(const Scene& scene, const NumberFormat& format) {
    JobSettings settings;
    settings.image = {16, 16};
    settings.format = format;
    return pack_job(scene, settings);
}

/// Number formats of the tests. For e5m6 no error bounds are known, so every object is in every list.
inline const std::vector<std::string> kFormats = {"fp32", "e6m15", "e6m15t", "e8m12", "e5m10", "e7m20t", "e5m6"};

/// Returns true if the voxel's list contains the object.
inline bool lists_object(const Partition& p, std::uint32_t voxel, std::uint32_t object) {
    return std::binary_search(p.objects.begin() + p.starts[voxel], p.objects.begin() + p.starts[voxel + 1], object);
}

/// Returns the object numbers of the finite objects, ascending.
inline std::vector<std::uint32_t> finite_numbers(const PackedJob& job) {
    const raya_objects all = job.header().objects;
    std::vector<std::uint32_t> numbers;
    for (std::uint32_t i = 0; i < all.spheres + all.planes + all.polygons + all.cones; ++i)
        if (i < all.spheres || i >= all.spheres + all.planes) numbers.push_back(i);
    return numbers;
}

inline Partition partition_of(const Scene& scene, const std::string& format, const Divisions& divisions) {
    return partition(job_in(scene, parse_format(format)), parse_format(format), divisions);
}

/// Returns at most half of the traversal error, in scene units, that host/accel/partition.cpp allows for a ray with its
/// origin within the reach.
inline double half_traversal_error(const raya_grid& grid) {
    double max_coordinate = grid.reach;
    for (std::uint32_t axis = 0; axis < 3; ++axis)
        max_coordinate = std::max({max_coordinate, std::abs(double{grid.low[axis]})});
    return 8 * 0x1p-24 * max_coordinate;
}

inline Divisions random_divisions(SplitMix& random) {
    const auto random_count = [&] { return 1 + below(random, 20); };
    const std::uint32_t x = random_count(), y = random_count();
    return {x, y, random_count()};
}

/// Returns a random factor by which a scene is scaled; the format can represent the scaled scene.
inline double random_scale(SplitMix& random, const NumberFormat& format) {
    const double max_exponent = format.exponent_bits == 5 ? 2 : format.exponent_bits == 6 ? 8 : 16;
    return std::exp2(random.uniform(-max_exponent, max_exponent));
}

}  // namespace raya
