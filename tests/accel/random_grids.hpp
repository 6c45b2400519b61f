// Random grids and rays for tests of the grid traversal: typical cases and edge cases.
#pragma once
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "host/accel/partition.hpp"
#include "host/scene/packer.hpp"
#include "host/scene/split_mix.hpp"
#include "kernels/shared/grid.h"
#include "tests/kernels/random_scene.hpp"
#include "tests/reference/reference.hpp"
#include "tests/scene/fp32.hpp"

namespace raya {

inline std::uint32_t below(SplitMix& random, std::uint32_t end) {
    return static_cast<std::uint32_t>(random.next() % end);
}

/// Returns the words of a grid's header, as kernels read it.
inline std::vector<std::uint32_t> grid_words(const raya_grid& grid) {
    std::vector<std::uint32_t> words(kWordsOf<raya_grid>);
    put_record(words, 0, grid);
    return words;
}

/// Returns a grid of random size, proportions and divisions, around the origin or far from it.
inline raya_grid random_grid(SplitMix& random) {
    static const std::vector<Divisions> all_divisions = {{1, 1, 1},   {1, 7, 3}, {64, 64, 64}, {2, 2, 2},   {4, 4, 4},
                                                         {16, 1, 16}, {5, 8, 3}, {1, 1, 200},  {30, 20, 10}};
    const Divisions divisions = all_divisions[below(random, static_cast<std::uint32_t>(all_divisions.size()))];
    const double scale = std::exp2(random.uniform(-20, 20));
    // The maximum absolute coordinate of the grid's low corner, in multiples of `scale`.
    const double max_distance = below(random, 3) == 0 ? random.uniform(0, 1000) : 1;
    raya_grid grid{};
    for (std::uint32_t axis = 0; axis < 3; ++axis) {
        const double side = scale * (below(random, 5) == 0 ? random.uniform(1e-3, 1) : 1);
        grid.low[axis] = static_cast<float>(random.uniform(-1, 1) * max_distance * scale);
        grid.cell[axis] = static_cast<float>(side / divisions[axis]);
        grid.divisions[axis] = divisions[axis];
    }
    grid.reach = static_cast<float>(4 * (max_distance + 1) * scale);
    return grid;
}

/// Returns the point with the grid coordinates `planes`: an integer is a plane between voxels, a fraction lies between
/// two planes.
inline Vec3 grid_point(const raya_grid& grid, const Vec3& planes) {
    Vec3 p;
    for (std::uint32_t axis = 0; axis < 3; ++axis) {
        const int a = static_cast<int>(axis);
        const double plane_number = std::floor(planes[a]);
        const double plane = raya_voxel_plane(grid, axis, static_cast<std::uint32_t>(plane_number));
        p[a] = planes[a] == plane_number ? plane : plane + (planes[a] - plane_number) * grid.cell[axis];
    }
    return p;
}

/// Returns a random point of the grid's box.
inline Vec3 random_inside(SplitMix& random, const raya_grid& grid) {
    Vec3 planes;
    for (std::uint32_t axis = 0; axis < 3; ++axis)
        planes[static_cast<int>(axis)] = random.uniform(0, grid.divisions[axis]);
    return grid_point(grid, planes);
}

inline Vec3 random_corner(SplitMix& random, const raya_grid& grid) {
    Vec3 planes;
    for (std::uint32_t axis = 0; axis < 3; ++axis)
        planes[static_cast<int>(axis)] = below(random, grid.divisions[axis] + 1);
    return grid_point(grid, planes);
}

inline Vec3 axis_direction(SplitMix& random) {
    Vec3 d(0);
    d[static_cast<int>(below(random, 3))] = below(random, 2) == 0 ? 1 : -1;
    return d;
}

/// Returns a normalised direction. Before normalisation, at least one component is +-1; the others are +-1, +-0 or
/// tiny.
inline Vec3 special_direction(SplitMix& random) {
    static constexpr std::array<double, 9> kSizes = {0, -0.0, 1, 1, 1e-4, 1e-10, 1e-19, 1e-21, 1e-30};
    Vec3 d = axis_direction(random);
    for (int axis = 0; axis < 3; ++axis)
        if (d[axis] == 0) d[axis] = kSizes[below(random, kSizes.size())] * (below(random, 2) == 0 ? 1 : -1);
    return d.normalized();
}

/// Returns a random ray of one of these kinds: with an origin in the box, outside it or far from it; parallel to an
/// axis; along edges or faces of voxels; through corners of voxels.
inline reference::Ray random_grid_ray(SplitMix& random, const raya_grid& grid) {
    const Vec3 inside = random_inside(random, grid), corner = random_corner(random, grid);
    const Vec3 second_point = below(random, 2) == 0 ? random_inside(random, grid) : random_corner(random, grid);
    const double size = std::sqrt(3.0) * (grid_point(grid, Vec3(0)) - inside).length() + grid.cell[0];
    const Vec3 outside = inside + random.uniform(0.5, 3) * size * random_direction(random);
    switch (below(random, 9)) {
        case 0:
            return {fp32(inside), fp32(random_direction(random))};
        case 1:
            return {fp32(outside), fp32((inside - outside).normalized())};
        case 2:
            return {fp32(outside), fp32((corner - fp32(outside)).normalized())};
        case 3: {
            const Vec3 far = fp32(inside + random.uniform(10, 1000) * size * random_direction(random));
            return {far, fp32((second_point - far).normalized())};
        }
        case 4:
            return {fp32(corner), fp32((second_point - corner + Vec3(1e-30)).normalized())};
        case 5:
            return {fp32(corner - random.uniform(-1, 2) * size * axis_direction(random)), axis_direction(random)};
        case 6: {
            const Vec3 d = axis_direction(random);
            return {fp32(corner - random.uniform(0, 2) * size * d), d};
        }
        case 7: {
            const Vec3 d = fp32(special_direction(random));
            return {fp32((below(random, 2) == 0 ? corner : inside) - random.uniform(0, 2) * size * d), d};
        }
        default: {  // nearly parallel to faces of voxels
            Vec3 d = random_direction(random);
            d[static_cast<int>(below(random, 3))] *= std::exp2(random.uniform(-30, -10));
            d = fp32(d.normalized());
            return {fp32(corner - random.uniform(-0.5, 2) * size * d), d};
        }
    }
}

/// Returns an upper bound of the number of voxels on a ray.
inline std::uint32_t max_voxels(const raya_grid& g) { return g.divisions[0] + g.divisions[1] + g.divisions[2] + 1; }

}  // namespace raya
