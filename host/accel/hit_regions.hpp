// Hit regions: for each finite object of a job, bounds of all points at which a kernel can compute a hit of the object,
// including the rounding errors of the number format. Lengths are in the job's units.
#pragma once
#include <Imath/ImathBox.h>

#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "host/model/number_format.hpp"
#include "host/scene/packer.hpp"

namespace raya {

using Box = Imath::Box3d;

/// The intersection of a box, a spherical shell, a slab between two planes and a capsule around a segment.
struct HitRegion {
    static constexpr double kAll = std::numeric_limits<double>::infinity();
    Box box;
    Vec3 centre{0};                 // centre of the shell; start of the segment
    double ball = kAll, inner = 0;  // outer (`ball`) and inner radius of the shell
    Vec3 normal{0};                 // of the slab: points p with |dot(normal, p) - middle| <= half
    double middle = 0, half = kAll;
    Vec3 along{0};         // vector from the segment's start to its end
    double around = kAll;  // radius of the capsule

    /// Conservative intersection test: returns false only if the box `part` contains no point of the region.
    bool touches(const Box& part) const;
};

/// One region per finite object of a job, without the separate objects, in the order of object numbers.
/// Computed from the job's words, and so from the same numbers that the kernels use. The job must outlive this object.
class HitRegions {
  public:
    /// `reach`: maximum magnitude of the coordinates of ray origins, in multiples of the scene's extent
    /// (scene_extent()), at least 2. `separate`: numbers of the excluded objects, ascending.
    HitRegions(const PackedJob& job, const NumberFormat& format, double reach = 2,
               const std::vector<std::uint32_t>& separate = {});

    /// Returns true if every object has a bounded region. Otherwise a hit may be anywhere within far() of its ray's
    /// origin.
    bool known() const { return known_; }
    /// Maximum magnitude of the coordinates of ray origins. The regions are valid for rays from such origins whose
    /// direction has length 1 up to rounding (rays for which is_wide() in kernels/grid/traversal.clh is false).
    double reach() const { return reach_; }
    /// Radius margin: how much a sphere's region exceeds its radius at most, for ray origins with coordinates up to
    /// `reach` extents. Does not include the error of results flushed to 0.
    double slack(double reach) const;
    /// Maximum distance of a hit: RAYA_FAR of the format.
    double far() const { return far_; }

    std::size_t size() const { return numbers_.size(); }
    /// The number in the job of the object of region i.
    std::uint32_t number(std::size_t i) const { return numbers_[i]; }
    /// Region i. Requires known().
    HitRegion region(std::size_t i) const;

  private:
    // `at`: index of a word in the job; of an object's first word in sphere(), polygon() and cone...().
    double real(std::size_t at) const;
    Vec3 vector(std::size_t at) const;
    // Upper bound of the distance from `place` to the origin of a ray within reach.
    double farthest(const Vec3& place) const;
    HitRegion sphere(std::size_t at) const;
    HitRegion polygon(std::size_t at) const;
    HitRegion cone(std::size_t at) const;
    double cone_error(std::size_t at, double size) const;
    double cone_size(std::size_t at) const;
    bool cones_known() const;

    const std::vector<std::uint32_t>* words_;
    raya_objects objects_{};
    std::vector<std::uint32_t> numbers_;
    double unit_, smallest_, stretch_;            // u, f and s of hit_regions.cpp
    double extent_, reach_, far_, square_limit_;  // squares of numbers up to square_limit_ do not overflow
    bool known_;
};

}  // namespace raya
