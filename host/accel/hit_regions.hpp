// Where in space the kernels can find hits of each finite object, the rounding of the number format included.
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

/// The points of a box that also lie in a ball, but not in a hollow about its centre, between two planes, and about a
/// segment.
struct HitRegion {
    static constexpr double kAll = std::numeric_limits<double>::infinity();
    Box box;
    Vec3 centre{0};                 // of the ball; where the segment starts
    double ball = kAll, inner = 0;  // radii of the ball and of its hollow
    Vec3 normal{0};                 // of the planes: |normal.x - middle| <= half
    double middle = 0, half = kAll;
    Vec3 along{0};         // from the segment's start to its end
    double around = kAll;  // distance from the segment

    /// Has `part` points of the region? In doubt it has.
    bool touches(const Box& part) const;
};

/// The finite objects of a job (which must outlive this) but for those held apart, in the order of their numbers.
/// Everything is computed from the job's words, the numbers that the kernels see.
class HitRegions {
  public:
    /// `reach` in units of the scene's extent, 2 or more. `apart`: numbers of objects, ascending.
    HitRegions(const PackedJob& job, const NumberFormat& format, double reach = 2,
               const std::vector<std::uint32_t>& apart = {});

    /// Is there a region for every object? If not, hits may come out anywhere within far() of a ray's origin.
    bool known() const { return known_; }
    /// Largest coordinate of the origins of the rays that the regions are good for; which are not wide
    /// (kernels/grid/walk.clh).
    double reach() const { return reach_; }
    /// By how much a sphere's region is larger than the sphere where rays reach so many extents.
    double slack(double reach) const;
    /// Farthest distance of a hit: RAYA_FAR of the format.
    double far() const { return far_; }

    std::size_t size() const { return numbers_.size(); }
    /// The number that finite object i has in the job.
    std::uint32_t number(std::size_t i) const { return numbers_[i]; }
    /// Of finite object i. Only where known().
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
    double unit_, smallest_, stretch_;           // of the format: u, f and s of hit_regions.cpp
    double extent_, reach_, far_, square_room_;  // square_room_: numbers below it have squares in the format
    bool known_;
};

}  // namespace raya
