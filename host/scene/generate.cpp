#include "host/scene/generate.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "host/error.hpp"
#include "host/scene/split_mix.hpp"

namespace raya {
namespace {

double rounded(double x) { return std::round(x * 1e6) / 1e6 + 0.0; }

Vec3 rounded(const Vec3& v) { return {rounded(v.x), rounded(v.y), rounded(v.z)}; }

void check_count(const char* kind, int count) {
    if (count < 1 || count > kMostSpheres)
        throw UserError(fmt::format("{}: {} spheres: must lie in 1..{}", kind, count, kMostSpheres));
}

/// The cube [-1, 1]^3 from a corner, filling most of the image.
View view_of_cube() { return {{2.6, 3.4, 1.9}, {0, 0, -0.1}, {0, 0, 1}, 36, 0, 512, 512}; }

/// `count` spheres in the box from `low` of the given sides, each in a cell of its own of a k^3 grid.
void fill_box(Scene& scene, const Vec3& low, const Vec3& sides, std::int64_t count, SplitMix& random) {
    std::int64_t k = 1;
    while (k * k * k < count) ++k;
    const Vec3 cell = sides / static_cast<double>(k);
    const double half = std::min({cell.x, cell.y, cell.z}) / 2;
    for (std::int64_t i = 0; i < count; ++i) {
        const std::int64_t at = i * k * k * k / count;
        const Vec3 corner =
            low +
            Vec3(static_cast<double>(at % k), static_cast<double>(at / k % k), static_cast<double>(at / k / k)) * cell;
        const double radius = half * random.uniform(0.5, 0.9);
        const double room = 0.98 * (1 - radius / half);  // of the way from the cell's middle to touching its side
        const auto place = [&](double side) {
            return side / 2 + (side / 2 - half + half * room) * random.uniform(-1, 1);
        };
        const double x = place(cell.x), y = place(cell.y), z = place(cell.z);
        scene.spheres.push_back(
            {rounded(corner + Vec3(x, y, z)), rounded(radius), static_cast<int>(scene.spheres.size() % 4)});
    }
}

}  // namespace

Scene generate_uniform(int count, std::array<int, 3> voxels) {
    check_count("uniform", count);
    std::int64_t total = 1;
    for (const int along : voxels) {
        if (along < 1 || along > kMostVoxelsAlongAxis)
            throw UserError(
                fmt::format("uniform: {} voxels along an axis: must lie in 1..{}", along, kMostVoxelsAlongAxis));
        total *= along;
    }
    if (total > kMostVoxels) throw UserError(fmt::format("uniform: {} voxels: at most {}", total, kMostVoxels));

    Scene scene;
    scene.name = fmt::format("uniform{}_{}x{}x{}.nff", count, voxels[0], voxels[1], voxels[2]);
    scene.background = {0.15, 0.2, 0.3};
    scene.view = view_of_cube();
    scene.lights = {{{5, 4, 8}, {}}};
    for (const Colour& colour :
         {Colour(0.9, 0.5, 0.3), Colour(0.4, 0.7, 0.9), Colour(0.9, 0.8, 0.4), Colour(0.5, 0.8, 0.5)})
        scene.surfaces.push_back({colour, 0.9, 0, 0, 0, 1, {}});
    const Vec3 sides(2.0 / voxels[0], 2.0 / voxels[1], 2.0 / voxels[2]);
    SplitMix random(static_cast<std::uint64_t>(count));
    for (std::int64_t voxel = 0; voxel < total; ++voxel) {
        const std::int64_t share = (voxel + 1) * count / total - voxel * count / total;
        const Vec3 place(static_cast<double>(voxel % voxels[0]), static_cast<double>(voxel / voxels[0] % voxels[1]),
                         static_cast<double>(voxel / voxels[0] / voxels[1]));
        fill_box(scene, Vec3(-1) + place * sides, sides, share, random);
    }
    share_surfaces(scene);
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
            {rounded({red, green, blue}), 0.9 - specular, specular, i % 3 == 0 ? 0.0 : 30.0, 0, 1, {}});
    }
    const double filling = std::cbrt(0.05 * 8 / (count * 4 / 3.0 * std::numbers::pi));
    for (int i = 0; i < count; ++i) {
        const double x = random.uniform(-1, 1), y = random.uniform(-1, 1), z = random.uniform(-1, 1);
        const double radius = std::min(0.6, filling * random.uniform(0.5, 1.5));
        const int surface = static_cast<int>(random.next() % kSurfaces);
        scene.spheres.push_back({rounded({x, y, z}), rounded(radius), surface});
    }
    share_surfaces(scene);
    return scene;
}

}  // namespace raya
