#pragma once
#include "host/scene/scene.hpp"

namespace raya {

/// Returns the scene with all lengths (positions, radii, checker sizes) multiplied by `factor`; colours, directions and
/// angles do not change.
inline Scene scaled_scene(Scene scene, double factor) {
    scene.view.from *= factor;
    scene.view.at *= factor;
    scene.view.hither *= factor;
    for (Light& l : scene.lights) l.position *= factor;
    for (Surface& s : scene.surfaces)
        if (s.checker) s.checker->size *= factor;
    for (Sphere& s : scene.spheres) {
        s.centre *= factor;
        s.radius *= factor;
    }
    for (Plane& p : scene.planes) p.distance *= factor;
    for (Polygon& p : scene.polygons)
        for (Vec3& v : p.vertices) v *= factor;
    for (Cone& c : scene.cones) {
        c.base *= factor;
        c.apex *= factor;
        c.base_radius *= factor;
        c.apex_radius *= factor;
    }
    return scene;
}

}  // namespace raya
