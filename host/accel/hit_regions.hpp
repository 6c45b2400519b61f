// The regions in which kernels can find hits of each finite object, including the rounding of the number format.
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
    Vec3 centre{0};                 // of the shell; start of the segment
    double ball = kAll, inner = 0;  // outer and inner radius of the shell
    Vec3 normal{0};                 // of the slab: |normal.x - middle| <= half
    double middle = 0, half = kAll;
    Vec3 along{0};         // from the segment's start to its end
    double around = kAll;  // radius of the capsule

    /// Returns true if `part` may contain points of the region (conservative).
    bool touches(const Box& part) const;
};

/// The regions of the finite objects of a job, which must outlive this object, except `apart`, in the order of their
/// numbers. Computed from the job's words, the same numbers that the kernels use.
class HitRegions {
  public:
    /// `reach`: in extents of the scene, at least 2. `apart`: numbers of excluded objects, ascending.
    HitRegions(const PackedJob& job, const NumberFormat& format, double reach = 2,
               const std::vector<std::uint32_t>& apart = {});

    /// Returns true if every object has a region. Otherwise hits may be anywhere within far() of a ray's origin.
    bool known() const { return known_; }
    /// The regions are valid for rays whose origins have coordinates up to reach() in magnitude and that are not wide
    /// (is_wide() in kernels/grid/walk.clh).
    double reach() const { return reach_; }
    /// The difference between the radii of a sphere's region and of the sphere if rays reach `reach` extents.
    double slack(double reach) const;
    /// Maximum distance of a hit: RAYA_FAR of the format.
    double far() const { return far_; }

    std::size_t size() const { return numbers_.size(); }
    /// The number of finite object i in the job.
    std::uint32_t number(std::size_t i) const { return numbers_[i]; }
    /// The region of finite object i. Requires known().
    HitRegion region(std::size_t i) const;

  private:
    double real(std::size_t at) const;
    Vec3 vector(std::size_t at) const;
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
    double unit_, smallest_, stretch_;            // u, f and s in hit_regions.cpp
    double extent_, reach_, far_, square_limit_;  // square_limit_: squares of smaller numbers do not overflow
    bool known_;
};

}  // namespace raya
