#include "host/scene/scene_box.hpp"

#include <algorithm>
#include <cmath>

#include "host/scene/outline.hpp"

namespace raya {
namespace {

/// A disk at right angles to `axis`, which has length 1: along each coordinate it reaches as far as its radius times
/// the sine of the angle between the two.
void extend_by_disk(Imath::Box3d& box, const Vec3& centre, double radius, const Vec3& axis) {
    Vec3 reach;
    for (int i = 0; i < 3; ++i) reach[i] = std::abs(radius) * std::sqrt(std::max(0.0, 1 - axis[i] * axis[i]));
    box.extendBy(centre - reach);
    box.extendBy(centre + reach);
}

}  // namespace

Imath::Box3d scene_box(const Scene& scene) {
    Imath::Box3d box;
    for (const Sphere& s : scene.spheres) {
        box.extendBy(s.centre - Vec3(std::abs(s.radius)));
        box.extendBy(s.centre + Vec3(std::abs(s.radius)));
    }
    for (const Polygon& p : scene.polygons)
        for (const Vec3& v : p.vertices) box.extendBy(v);
    for (const Cone& c : scene.cones) {
        const Vec3 axis = unit_vector(c.apex - c.base);
        extend_by_disk(box, c.base, c.base_radius, axis);
        extend_by_disk(box, c.apex, c.apex_radius, axis);
    }
    return box;
}

}  // namespace raya
