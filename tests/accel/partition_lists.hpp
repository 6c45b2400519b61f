// Partitions (grid registrations) of random scenes, and access to their object lists.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "host/accel/partition.hpp"
#include "tests/accel/hits_of_one.hpp"
#include "tests/accel/random_grids.hpp"

namespace raya {

/// Number formats of the tests. For the last one no error bounds are known, so every object is in every list.
inline const std::vector<std::string> kFormats = {"fp32", "e6m15", "e6m15t", "e8m12", "e5m10", "e7m20t", "e5m6"};

inline bool lists(const Partition& p, std::uint32_t voxel, std::uint32_t object) {
    return std::binary_search(p.objects.begin() + p.starts[voxel], p.objects.begin() + p.starts[voxel + 1], object);
}

inline std::size_t lists_with(const Partition& p, std::uint32_t object) {
    return static_cast<std::size_t>(std::count(p.objects.begin(), p.objects.end(), object));
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

/// Returns half of the error that the partition allows for a ray whose origin is at `reach`. (The tests of the
/// traversal allow a quarter.)
inline double traversal_error(const raya_grid& grid) {
    double largest = grid.reach;
    for (std::uint32_t axis = 0; axis < 3; ++axis) largest = std::max({largest, std::abs(double{grid.low[axis]})});
    return 8 * 0x1p-24 * largest;
}

inline Divisions random_divisions(SplitMix& random) {
    const auto along = [&] { return 1 + below(random, 20); };
    const std::uint32_t x = along(), y = along();
    return {x, y, along()};
}

/// Returns a random scale of a scene, up to the largest and down to the smallest sizes that the format can represent.
inline double random_scale(SplitMix& random, const NumberFormat& format) {
    const double max_exponent = format.exponent_bits == 5 ? 2 : format.exponent_bits == 6 ? 8 : 16;
    return std::exp2(random.uniform(-max_exponent, max_exponent));
}

}  // namespace raya
