// Compares the numbers that a kernel computes for a ray with those of the reference. Rounding explains differences up
// to given limits. Larger differences are excused only for rays that graze an edge.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "tests/reference/reference.hpp"

namespace raya {

/// The result for a ray: the number of the object hit (-1: none), then other numbers.
using RayResult = std::vector<double>;

/// Limit of the error of a hit point, relative to the scene's extent.
inline constexpr double kPlaceLimit = 1e-6;

inline void append(RayResult& found, const Vec3& v) {
    for (int axis = 0; axis < 3; ++axis) found.push_back(v[axis]);
}

/// Compares rays and counts them. A ray's result may differ from the reference by more than the limits only if moving
/// the ray sideways by `shift` changes the reference's result as much: such a ray grazes an edge, an outline or a
/// shadow, or the distance of its hit is ill-conditioned.
struct Agreement {
    double shift = 0;         // distance by which rays are moved sideways, in scene units
    std::size_t rays = 0;     // number of rays compared
    std::size_t grazing = 0;  // number of rays whose results differ by more than a limit
    double max_fraction = 0;  // largest difference within the limits, as a fraction of its limit

    /// Returns true if `actual` differs from the reference by at most `limits` (one per number), or if a larger
    /// difference is excused. `find(ray)` returns the reference's result.
    template <class Find>
    bool accepts(const Find& find, const reference::Ray& ray, const RayResult& actual, const RayResult& limits) {
        ++rays;
        const RayResult expected = find(ray);
        if (within(expected, actual, limits)) return true;
        ++grazing;
        return shifts_explain(find, ray, expected, actual, limits);
    }

  private:
    bool within(const RayResult& expected, const RayResult& actual, const RayResult& limits) {
        if (expected.size() != actual.size()) return false;
        double fraction = 0;
        for (std::size_t i = 0; i < expected.size(); ++i) {
            if (!(std::abs(actual[i] - expected[i]) <= limits[i])) return false;  // false for NaN
            if (limits[i] > 0) fraction = std::max(fraction, std::abs(actual[i] - expected[i]) / limits[i]);
        }
        max_fraction = std::max(max_fraction, fraction);
        return true;
    }

    // Returns true if moving the ray by `shift` changes the reference's result at least as much as `actual` differs.
    template <class Find>
    bool shifts_explain(const Find& find, const reference::Ray& ray, const RayResult& expected, const RayResult& actual,
                        const RayResult& limits) const {
        const Vec3 axis = std::abs(ray.direction.x) < 0.5 ? Vec3(1, 0, 0) : Vec3(0, 1, 0);
        const Vec3 u = ray.direction.cross(axis).normalized(), v = ray.direction.cross(u);
        RayResult spread(expected.size(), 0);
        for (const double du : {-shift, 0.0, shift})
            for (const double dv : {-shift, 0.0, shift}) {
                const RayResult moved = find({ray.origin + du * u + dv * v, ray.direction});
                if (moved.size() != expected.size() || moved[0] != expected[0]) return true;
                for (std::size_t i = 0; i < spread.size(); ++i)
                    spread[i] = std::max(spread[i], std::abs(moved[i] - expected[i]));
            }
        if (actual.size() != expected.size()) return false;
        for (std::size_t i = 0; i < spread.size(); ++i)
            if (!(std::abs(actual[i] - expected[i]) <= limits[i] + spread[i])) return false;
        return true;
    }
};

}  // namespace raya
