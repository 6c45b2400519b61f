// Hit regions: for each finite object of a job, a region that contains all points at which a kernel can compute a hit
// of the object, in spite of the rounding errors of the number format. Lengths are in the job's units.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <vector>

#include "host/model/number_format.hpp"
#include "host/scene/packer.hpp"

namespace raya {

/// The intersection of a box, a spherical shell, a slab and a capsule around a segment. The slab consists of the points
/// p with |dot(normal, p) - plane_distance| <= half_thickness.
struct HitRegion {
    static constexpr double kUnbounded = std::numeric_limits<double>::infinity();
    Box box;
    Vec3 centre{0};                                          // centre of the shell; start of the segment
    double outer_radius = kUnbounded, inner_radius = 0;      // radii of the shell
    Vec3 normal{0};                                          // normal of the slab
    double plane_distance = 0, half_thickness = kUnbounded;  // define the slab (see above)
    Vec3 segment{0};                                         // vector from the segment's start to its end
    double capsule_radius = kUnbounded;

    /// Conservative intersection test: returns false only if `other_box` contains no point of the region.
    bool touches(const Box& other_box) const;
};

/// The hit regions of a job's finite objects without the separate objects, in the order of object numbers. They are
/// computed from the job's words, which are the numbers that the kernels use. The job must outlive this object.
class HitRegions {
  public:
    /// `reach`: maximum magnitude of the coordinates of ray origins, in multiples of the scene's extent
    /// (scene_extent()), at least 2. `separate`: numbers of the excluded objects, ascending.
    HitRegions(const PackedJob& job, const NumberFormat& format, double reach = 2,
               const std::vector<std::uint32_t>& separate = {});

    /// Returns true if every object has a bounded region. Otherwise a hit may be anywhere within far() of its ray's
    /// origin.
    bool all_bounded() const { return all_bounded_; }
    /// Maximum magnitude of the coordinates of ray origins. The regions are valid for rays from such origins whose
    /// direction has length 1 up to rounding (rays for which is_wide() in kernels/grid/traversal.clh is false).
    double reach() const { return reach_; }
    /// Maximum length by which a sphere's region exceeds the sphere's radius, for ray origins with coordinates up to
    /// `reach` times the scene's extent. Does not include the error of results flushed to 0.
    double slack(double reach) const;
    /// Maximum distance of a hit: RAYA_FAR of the format.
    double far() const { return far_; }

    std::size_t size() const { return numbers_.size(); }
    /// Object number of region i.
    std::uint32_t number(std::size_t i) const { return numbers_[i]; }
    /// Region i. Requires all_bounded().
    HitRegion region(std::size_t i) const;
    /// A box that contains the hits of object i up to (1.1 | |D|^2 - 1 | + spread(kind)) t. Requires all_bounded().
    Box box(std::size_t i) const;
    /// See raya_bvh.spread; 0 for fp32. `kind`: of the objects.
    double spread(std::uint32_t kind) const { return is_fp32_ ? 0 : (kind == RAYA_POLYGON ? 48 : 12) * unit_; }

  private:
    // `at`: index of a word in the job; in sphere(), polygon() and cone...() the index of the object's first word.
    double real(std::size_t at) const;
    Vec3 vector(std::size_t at) const;
    // Upper bound of the distance from `point` to a ray origin whose coordinates are at most reach_ in magnitude.
    double max_distance(const Vec3& point) const;
    Box corner_box(std::size_t at, double& farthest_corner) const;
    double in_plane(double distance) const;
    double polygon_margin(double distance) const;
    HitRegion sphere(std::size_t at) const;
#define RAYA_REGION_OF_KIND(kind, kinds, KIND) HitRegion kind(std::size_t at) const;
    RAYA_SHAPE_LIST(RAYA_REGION_OF_KIND)
    double cone_error(std::size_t at, double size) const;
    double cone_size(std::size_t at) const;
    bool cones_bounded() const;

    const std::vector<std::uint32_t>* words_;
    raya_objects objects_{};
    std::vector<std::uint32_t> numbers_;
    double unit_, smallest_, stretch_;            // u, f and s of hit_regions.cpp
    double extent_, reach_, far_, square_limit_;  // squares of numbers up to square_limit_ do not overflow
    bool all_bounded_, is_fp32_;
};

/// Returns the reach of a structure: the maximum coordinate of ray origins for which it is valid, in multiples of the
/// scene's extent. Reflected rays can start anywhere on an infinite plane, so a scene with planes gets a larger reach:
/// it is doubled from 2 up to 1024 as long as regions stay bounded and grow by at most max_slack(regions). `separate`:
/// numbers of the excluded objects, ascending.
double reach_for(const PackedJob& job, const NumberFormat& format,
                 const std::function<double(const HitRegions&)>& max_slack,
                 const std::vector<std::uint32_t>& separate = {});

}  // namespace raya
