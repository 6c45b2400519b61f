#include "host/scene/spread.hpp"

#include <algorithm>
#include <cmath>

#include "host/scene/generate.hpp"

namespace raya {

Scene scattered(const Scene& even, std::uint64_t seed) {
    const Scene random = generate_random(static_cast<int>(even.spheres.size()), seed);
    Scene scene = even;
    for (std::size_t i = 0; i < scene.spheres.size(); ++i) {
        Sphere& sphere = scene.spheres[i];
        for (int axis = 0; axis < 3; ++axis)
            sphere.centre[axis] = std::clamp(random.spheres[i].centre[axis], -1 + sphere.radius, 1 - sphere.radius);
    }
    return scene;
}

Scene moved_within(const Scene& scene) {
    constexpr double kVoxel = 2.0 / kObjectSides;
    constexpr double kGap = kVoxel / 16;  // the most by which registration takes a sphere for larger than it is
    Scene moved = scene;
    for (Sphere& sphere : moved.spheres)
        for (int axis = 0; axis < 3; ++axis) {
            double& at = sphere.centre[axis];
            const double low = -1 + kVoxel * std::clamp(std::floor((at + 1) / kVoxel), 0.0, kObjectSides - 1.0);
            const double room = std::min(sphere.radius + kGap, kVoxel / 2);
            at = std::clamp(at, low + room, low + kVoxel - room);
        }
    return moved;
}

Scene touching_walls(Scene scene) {
    for (int axis = 0; axis < 3; ++axis)
        for (const double side : {-1.0, 1.0}) {
            const auto reach = [&](const Sphere& sphere) { return side * sphere.centre[axis] + sphere.radius; };
            Sphere& outermost =
                *std::max_element(scene.spheres.begin(), scene.spheres.end(),
                                  [&](const Sphere& a, const Sphere& b) { return reach(a) < reach(b); });
            outermost.centre[axis] = side * (1 - outermost.radius);
        }
    return scene;
}

}  // namespace raya
