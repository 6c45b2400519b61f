// Compares the numbers that a kernel finds along a ray with the reference's, and excuses differences due to rounding.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "tests/reference/reference.hpp"

namespace raya {

/// The result along a ray: first the object's number (-1: none), then any numbers.
using Found = std::vector<double>;

inline void append(Found& found, const Vec3& v) {
    for (int axis = 0; axis < 3; ++axis) found.push_back(v[axis]);
}

/// Counts of compared rays. A ray may differ by more than the limits only if a ray moved sideways by at most `reach`
/// does so in the reference as well: it grazes an edge, an outline or a shadow, or its distance is ill-conditioned.
struct Agreement {
    double reach = 0;  // scene units
    std::size_t rays = 0;
    std::size_t grazing = 0;  // beyond a limit, but excused
    double largest = 0;       // largest difference within the limits, as a fraction of its limit

    /// Returns true if `actual` is within `limits` (one for each number) of the reference, or excused. `find(ray)`
    /// returns the reference's result.
    template <class Find>
    bool accepts(const Find& find, const reference::Ray& ray, const Found& actual, const Found& limits) {
        ++rays;
        const Found expected = find(ray);
        if (within(expected, actual, limits)) return true;
        ++grazing;
        return moved_rays_reach(find, ray, expected, actual, limits);
    }

  private:
    bool within(const Found& expected, const Found& actual, const Found& limits) {
        if (expected.size() != actual.size()) return false;
        double share = 0;
        for (std::size_t i = 0; i < expected.size(); ++i) {
            if (!(std::abs(actual[i] - expected[i]) <= limits[i])) return false;  // NaN is never within
            if (limits[i] > 0) share = std::max(share, std::abs(actual[i] - expected[i]) / limits[i]);
        }
        largest = std::max(largest, share);
        return true;
    }

    template <class Find>
    bool moved_rays_reach(const Find& find, const reference::Ray& ray, const Found& expected, const Found& actual,
                          const Found& limits) const {
        const Vec3 axis = std::abs(ray.direction.x) < 0.5 ? Vec3(1, 0, 0) : Vec3(0, 1, 0);
        const Vec3 u = ray.direction.cross(axis).normalized(), v = ray.direction.cross(u);
        Found spread(expected.size(), 0);
        for (const double du : {-reach, 0.0, reach})
            for (const double dv : {-reach, 0.0, reach}) {
                const Found moved = find({ray.origin + du * u + dv * v, ray.direction});
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
