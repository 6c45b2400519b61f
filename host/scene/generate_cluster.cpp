#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "host/scene/generate.hpp"
#include "host/scene/rounded.hpp"
#include "host/scene/split_mix.hpp"

namespace raya {
namespace {

Sphere draw_sphere(SplitMix& random, const ClusterShape& shape) {
    const double radius = random.uniform(shape.smallest, shape.largest);
    const double azimuth = random.uniform(0, 2 * std::numbers::pi);
    const double distance = shape.radius * std::sqrt(random.uniform(0, 1));
    const double height = radius + random.uniform(0, shape.height);
    return {rounded({distance * std::cos(azimuth), distance * std::sin(azimuth), height}), rounded(radius), 0};
}

bool touches(const Sphere& sphere, const std::vector<Sphere>& others) {
    return std::ranges::any_of(others, [&](const Sphere& other) {
        return (sphere.centre - other.centre).length() < sphere.radius + other.radius;
    });
}

}  // namespace

Scene generate_cluster(std::uint64_t seed, const ClusterShape& shape) {
    constexpr int kTries = 200;  // for a place where the sphere touches no other
    enum { kGlass, kMirror, kMatt, kFloor };
    Scene scene;
    scene.name = fmt::format("cluster{}.nff", seed);
    scene.background = {0.3, 0.5, 0.85};
    scene.view = {{0, -11, 4.4}, {0, 0, 1.1}, {0, 0, 1}, shape.angle_degrees, 0, 256, 256};
    scene.lights = {{{-7, -8, 11}, Colour(0.7, 0.7, 0.7)}};
    scene.surfaces = {
        {{1, 1, 1}, 0.02, 0.12, 200, 0.85, 1.5, {}},
        {{1, 1, 1}, 0.1, 0.8, 200, 0, 1, {}},
        {{0.9, 0.3, 0.1}, 0.85, 0, 0, 0, 1, {}},
        {{0.9, 0.9, 0.9}, 0.85, 0, 0, 0, 1, Checker{{0.9, 0.87, 0.8}, {0.2, 0.3, 0.34}, shape.checker}},
    };
    SplitMix random(seed);
    for (int i = 0; i < shape.spheres(); ++i) {
        Sphere sphere = draw_sphere(random, shape);
        for (int tries = 0; tries < kTries && touches(sphere, scene.spheres); ++tries)
            sphere = draw_sphere(random, shape);
        sphere.surface = i < shape.glass ? kGlass : i < shape.glass + shape.mirrors ? kMirror : kMatt;
        scene.spheres.push_back(sphere);
    }
    scene.planes.push_back({{0, 0, 1}, 0, kFloor});
    share_surfaces(scene);
    return scene;
}

}  // namespace raya
