#include "host/scene/generate.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "host/error.hpp"
#include "host/scene/split_mix.hpp"

namespace raya {
namespace {

constexpr double kMillionths = 1e6, kTenThousandths = 1e4;  // values of the parameter `parts` of rounded()

void check_count(const char* kind, int count) {
    if (count < 1 || count > kMaxObjects)
        throw UserError(fmt::format("{}: {} spheres: must be 1..{}", kind, count, kMaxObjects));
}

/// Returns a view of the cube [-1, 1]^3 from outside one of its corners. The cube fills most of the image.
View view_of_cube() { return {{2.6, 3.4, 1.9}, {0, 0, -0.1}, {0, 0, 1}, 36, 0, 512, 512}; }

/// Adds `count` spheres in the box with the lower corner `low_corner` and the given sides. Divides the box into k^3
/// cells; each sphere lies in a different cell.
void fill_box(Scene& scene, const Vec3& low_corner, const Vec3& sides, std::int64_t count, SplitMix& random) {
    std::int64_t k = 1;
    while (k * k * k < count) ++k;
    const Vec3 cell = sides / static_cast<double>(k);
    const double max_radius = std::min({cell.x, cell.y, cell.z}) / 2;
    for (std::int64_t i = 0; i < count; ++i) {
        const std::int64_t cell_index = i * k * k * k / count;
        const Vec3 corner =
            low_corner + Vec3(static_cast<double>(cell_index % k), static_cast<double>(cell_index / k % k),
                              static_cast<double>(cell_index / k / k)) *
                             cell;
        const double radius = max_radius * random.uniform(0.5, 0.9);
        // Maximum distance of the sphere's centre from the middle of a cubic cell along an axis, divided by
        // `max_radius`.
        const double max_shift = 0.98 * (1 - radius / max_radius);
        const auto random_coordinate = [&](double side) {
            return side / 2 + (side / 2 - max_radius + max_radius * max_shift) * random.uniform(-1, 1);
        };
        const double x = random_coordinate(cell.x), y = random_coordinate(cell.y), z = random_coordinate(cell.z);
        scene.spheres.push_back({rounded(corner + Vec3(x, y, z), kMillionths), rounded(radius, kMillionths),
                                 static_cast<int>(scene.spheres.size() % 4)});
    }
}

/// A ring of equal spheres around the z axis.
struct SphereRing {
    int count;             // number of spheres
    double distance;       // distance of the centres from the z axis
    double height;         // z of the centres
    double radius;         // radius of each sphere
    double first_azimuth;  // azimuth of the first sphere, in full turns
    int first_surface;
    int surface_count;  // number of surfaces, which are assigned to the spheres cyclically
};

void add_ring(Scene& scene, const SphereRing& ring) {
    for (int i = 0; i < ring.count; ++i) {
        const double azimuth = 2 * std::numbers::pi * (ring.first_azimuth + static_cast<double>(i) / ring.count);
        const Vec3 centre(rounded(ring.distance * std::cos(azimuth), kTenThousandths),
                          rounded(ring.distance * std::sin(azimuth), kTenThousandths), ring.height);
        scene.spheres.push_back({centre, ring.radius, ring.first_surface + i % ring.surface_count});
    }
}

Sphere draw_sphere(SplitMix& random, const ClusterShape& shape) {
    const double radius = random.uniform(shape.min_sphere_radius, shape.max_sphere_radius);
    const double azimuth = random.uniform(0, 2 * std::numbers::pi);
    const double distance = shape.radius * std::sqrt(random.uniform(0, 1));
    const double height = radius + random.uniform(0, shape.height);
    return {rounded({distance * std::cos(azimuth), distance * std::sin(azimuth), height}), rounded(radius), 0};
}

bool touches(const Sphere& sphere, const std::vector<Sphere>& spheres) {
    return std::ranges::any_of(
        spheres, [&](const Sphere& s) { return (sphere.centre - s.centre).length() < sphere.radius + s.radius; });
}

}  // namespace

Scene generate_uniform(int count, std::array<int, 3> voxels) {
    check_count("uniform", count);
    std::int64_t voxel_count = 1;
    for (const int axis_voxels : voxels) {
        if (axis_voxels < 1 || axis_voxels > kMaxVoxelsPerAxis)
            throw UserError(
                fmt::format("uniform: {} voxels along an axis: must be 1..{}", axis_voxels, kMaxVoxelsPerAxis));
        voxel_count *= axis_voxels;
    }
    if (voxel_count > kMaxVoxels)
        throw UserError(fmt::format("uniform: {} voxels: at most {}", voxel_count, kMaxVoxels));

    Scene scene;
    scene.name = fmt::format("uniform{}_{}x{}x{}.nff", count, voxels[0], voxels[1], voxels[2]);
    scene.background = {0.15, 0.2, 0.3};
    scene.view = view_of_cube();
    scene.lights = {{{5, 4, 8}, {}}};
    for (const Colour& colour :
         {Colour(0.9, 0.5, 0.3), Colour(0.4, 0.7, 0.9), Colour(0.9, 0.8, 0.4), Colour(0.5, 0.8, 0.5)})
        scene.surfaces.push_back({colour, 0.9, 0, 0, 0, 1, {}});
    const Vec3 sides(2.0 / voxels[0], 2.0 / voxels[1], 2.0 / voxels[2]);
    scene.spheres.reserve(static_cast<std::size_t>(count));
    SplitMix random(static_cast<std::uint64_t>(count));
    for (std::int64_t voxel = 0; voxel < voxel_count; ++voxel) {
        const std::int64_t spheres = (voxel + 1) * count / voxel_count - voxel * count / voxel_count;
        const Vec3 position(static_cast<double>(voxel % voxels[0]), static_cast<double>(voxel / voxels[0] % voxels[1]),
                            static_cast<double>(voxel / voxels[0] / voxels[1]));
        fill_box(scene, Vec3(-1) + position * sides, sides, spheres, random);
    }
    merge_equal_surfaces(scene);
    return scene;
}

Scene generate_random(int count, std::uint64_t seed) {
    check_count("random", count);
    Scene scene;
    scene.name = fmt::format("random{}_{}.nff", count, seed);
    scene.background = {0.2, 0.3, 0.45};
    scene.view = view_of_cube();
    scene.lights = {{{5, 4, 8}, {}}, {{-4, 6, 5}, {}}};
    SplitMix random(seed);
    constexpr int kSurfaces = 12;
    for (int i = 0; i < kSurfaces; ++i) {
        const double red = random.uniform(0.25, 1), green = random.uniform(0.25, 1), blue = random.uniform(0.25, 1);
        const double specular = i % 3 == 0 ? 0 : i % 3 == 1 ? 0.2 : 0.5;
        scene.surfaces.push_back(
            {rounded({red, green, blue}, kMillionths), 0.9 - specular, specular, i % 3 == 0 ? 0.0 : 30.0, 0, 1, {}});
    }
    scene.spheres.reserve(static_cast<std::size_t>(count));
    const double mean_radius = std::cbrt(0.05 * 8 / (count * 4 / 3.0 * std::numbers::pi));
    for (int i = 0; i < count; ++i) {
        const double x = random.uniform(-1, 1), y = random.uniform(-1, 1), z = random.uniform(-1, 1);
        const double radius = std::min(0.6, mean_radius * random.uniform(0.5, 1.5));
        const int surface = static_cast<int>(random.next() % kSurfaces);
        scene.spheres.push_back({rounded({x, y, z}, kMillionths), rounded(radius, kMillionths), surface});
    }
    merge_equal_surfaces(scene);
    return scene;
}

Scene generate_centre() {
    Scene scene;
    scene.name = "centre.nff";
    scene.background = {0.3, 0.5, 0.85};
    scene.view = {{0, -11, 4.4}, {0, 0, 1.35}, {0, 0, 1}, 28, 0, 256, 256};
    scene.lights = {{{-7, -8, 11}, Colour(0.62, 0.6, 0.55)}, {{8, -5, 7}, Colour(0.22, 0.24, 0.3)}};
    scene.surfaces = {
        {{1, 1, 1}, 0.02, 0.12, 200, 0.85, 1.5, {}},     // glass
        {{1, 1, 1}, 0.08, 0.85, 200, 0, 1, {}},          // mirror
        {{0.9, 0.1, 0.08}, 0.75, 0.25, 60, 0, 1, {}},    // glossy red
        {{0.95, 0.65, 0.08}, 0.75, 0.25, 60, 0, 1, {}},  // glossy yellow
        {{0.1, 0.25, 0.85}, 0.75, 0.25, 60, 0, 1, {}},   // glossy blue
        {{0.9, 0.9, 0.9}, 0.85, 0, 0, 0, 1, Checker{{0.9, 0.87, 0.8}, {0.2, 0.3, 0.34}, 2}},
    };
    scene.spheres.push_back({{0, 0, 1.3}, 1.3, 0});
    scene.spheres.push_back({{0, 0, 3.05}, 0.45, 1});
    add_ring(scene, {12, 1.85, 0.4, 0.4, 0.02, 1, 4});
    add_ring(scene, {8, 1.35, 2.45, 0.28, 0.04, 0, 2});
    scene.planes.push_back({{0, 0, 1}, 0, 5});
    merge_equal_surfaces(scene);
    return scene;
}

Scene generate_cluster(std::uint64_t seed, const ClusterShape& shape) {
    constexpr int kMaxRedraws = 200;  // maximum number of new places and radii of a sphere that touches another one
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
        {{0.9, 0.9, 0.9}, 0.85, 0, 0, 0, 1, Checker{{0.9, 0.87, 0.8}, {0.2, 0.3, 0.34}, shape.checker_size}},
    };
    SplitMix random(seed);
    for (int i = 0; i < shape.spheres(); ++i) {
        Sphere sphere = draw_sphere(random, shape);
        for (int tries = 0; tries < kMaxRedraws && touches(sphere, scene.spheres); ++tries)
            sphere = draw_sphere(random, shape);
        sphere.surface = i < shape.glass ? kGlass : i < shape.glass + shape.mirrors ? kMirror : kMatt;
        scene.spheres.push_back(sphere);
    }
    scene.planes.push_back({{0, 0, 1}, 0, kFloor});
    merge_equal_surfaces(scene);
    return scene;
}

Scene scattered(const Scene& scene, std::uint64_t seed) {
    const Scene random_scene = generate_random(static_cast<int>(scene.spheres.size()), seed);
    Scene moved = scene;
    for (std::size_t i = 0; i < moved.spheres.size(); ++i) {
        Sphere& sphere = moved.spheres[i];
        for (int axis = 0; axis < 3; ++axis)
            sphere.centre[axis] =
                std::clamp(random_scene.spheres[i].centre[axis], -1 + sphere.radius, 1 - sphere.radius);
    }
    return moved;
}

Scene moved_into_voxels(const Scene& scene) {
    constexpr double kVoxel = 2.0 / kVoxelsPerCubeSide;  // side of a voxel
    // Upper bound of the distance by which a hit region (host/accel) exceeds its sphere.
    constexpr double kGap = kVoxel / 16;
    Scene moved = scene;
    for (Sphere& sphere : moved.spheres)
        for (int axis = 0; axis < 3; ++axis) {
            double& coordinate = sphere.centre[axis];
            const double voxel_low =
                -1 + kVoxel * std::clamp(std::floor((coordinate + 1) / kVoxel), 0.0, kVoxelsPerCubeSide - 1.0);
            const double margin = std::min(sphere.radius + kGap, kVoxel / 2);
            coordinate = std::clamp(coordinate, voxel_low + margin, voxel_low + kVoxel - margin);
        }
    return moved;
}

Scene touching_walls(Scene scene) {
    for (int axis = 0; axis < 3; ++axis)
        for (const double sign : {-1.0, 1.0}) {
            const auto extent = [&](const Sphere& sphere) { return sign * sphere.centre[axis] + sphere.radius; };
            Sphere& outermost_sphere =
                *std::max_element(scene.spheres.begin(), scene.spheres.end(),
                                  [&](const Sphere& a, const Sphere& b) { return extent(a) < extent(b); });
            outermost_sphere.centre[axis] = sign * (1 - outermost_sphere.radius);
        }
    return scene;
}

}  // namespace raya
