#include <fmt/core.h>

#include <array>
#include <cmath>

#include "host/error.hpp"
#include "host/scene/generate.hpp"
#include "host/scene/rounded.hpp"

namespace raya {
namespace {

// Shares of the distance between neighbouring spheres. A cylinder starts inside its sphere, half-way to its surface but
// for a hundredth, and ends so far inside the next one.
constexpr double kSphereRadius = 1.0 / 4, kCylinderRadius = 1.0 / 16, kCylinderStart = 0.99 / 8;

/// From above the middle of the far edge of the top, half a distance beside a column and below a layer of spheres, so
/// that the eye is in none of them; half-way down through the cube. Of SPD's view only that of 12 is known.
View view_of_lattice(int size) {
    const double x = (size / 2 + 0.5) / size, z = 1 - 0.5 / size;
    return {rounded({x, 1, z}), rounded({x, -1, z - 2}), {0.2, 1, 0}, 60, 0, 512, 512};
}

void add_node(Scene& scene, int size, const std::array<int, 3>& node) {
    const double distance = 1.0 / size;
    const Vec3 centre(node[0] * distance, node[1] * distance, node[2] * distance);
    scene.spheres.push_back({rounded(centre), rounded(kSphereRadius * distance), 0});
    for (int axis = 0; axis < 3; ++axis) {
        if (node[static_cast<std::size_t>(axis)] == size) continue;
        Vec3 from = centre, to = centre;
        from[axis] += kCylinderStart * distance;
        to[axis] += (1 - kCylinderStart) * distance;
        const double radius = rounded(kCylinderRadius * distance);
        scene.cones.push_back({rounded(from), radius, rounded(to), radius, 1 + axis});
    }
}

}  // namespace

Scene generate_lattice(int size) {
    if (size < 1 || size > kHighestLatticeSize)
        throw UserError(fmt::format("lattice: size {}: must lie in 1..{}", size, kHighestLatticeSize));
    Scene scene;
    scene.name = fmt::format("lattice{}.nff", size);
    scene.background = {0.078, 0.361, 0.753};
    scene.view = view_of_lattice(size);
    for (int axis = 0; axis < 3; ++axis)
        for (const double place : {2, -1}) {
            Vec3 position(0.5);
            position[axis] = place;
            scene.lights.push_back({position, {}});
        }
    scene.surfaces = {{{0.9, 0.9, 0.9}, 0.5, 0.5, 3.0827, 0, 0, {}}};
    for (const Colour& colour : {Colour(0.9, 0.1, 0.1), Colour(0.1, 0.9, 0.1), Colour(0.1, 0.1, 0.9)})
        scene.surfaces.push_back({colour, 0.99, 0, 100000, 0, 0, {}});
    for (int x = 0; x <= size; ++x)
        for (int y = 0; y <= size; ++y)
            for (int z = 0; z <= size; ++z) add_node(scene, size, {x, y, z});
    share_surfaces(scene);
    return scene;
}

}  // namespace raya
