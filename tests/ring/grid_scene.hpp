// A small test scene with a camera whose primary rays are exact in every number format.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>

#include "host/scene/packer.hpp"
#include "host/scene/scene.hpp"

namespace raya {

/// Returns two shiny spheres above a checkered floor. Edges cross the middle of the image, and some colour values
/// exceed 1.
inline Scene grid_objects() {
    Scene scene;
    scene.name = "grid";
    scene.background = {0.3, 0.5, 0.8};
    scene.lights = {{{-3, 6, -4}, Colour{1.5, 1.4, 1.1}}};
    scene.surfaces = {{.diffuse = 0.8, .checker = Checker{{0.9, 0.8, 0.7}, {0.3, 0.25, 0.2}, 0.5}},
                      {.colour = {0.9, 0.2, 0.1}, .diffuse = 0.7, .specular = 0.6, .shine = 20},
                      {.colour = {0.2, 0.2, 0.9}, .diffuse = 0.5, .specular = 0.3, .shine = 50}};
    scene.spheres = {{{0.62, 0.1, 5}, 0.6, 1}, {{-0.7, 0.2, 4}, 0.65, 2}};
    scene.planes = {{{0, 1, 0}, -0.15, 0}};
    return scene;
}

/// Returns grid_objects(), seen along an axis, for an image of `rows` rows. At distance 1 from the eye, the distance
/// between pixels is 1 / `pixels_per_unit`. If this spacing is a power of two, the image's corner and the steps between
/// pixels have few significant bits. So the primary rays are exact, and images with different spacings send the same
/// ray through the same point of the image plane.
inline Scene grid_scene(std::uint32_t rows, Sampling sampling, double pixels_per_unit) {
    Scene scene = grid_objects();
    const double spacings = sampling == Sampling::kCorners ? std::max(1.0, rows - 1.0) : rows;
    scene.view.angle_degrees = 2 * std::atan(spacings / 2 / pixels_per_unit) * 180 / std::numbers::pi;
    return scene;
}

}  // namespace raya
