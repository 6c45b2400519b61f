// Scene generators. A generated scene depends only on the arguments, not on the platform, because coordinates are
// rounded to decimal digits. Equal surfaces are stored once (merge_equal_surfaces()).
#pragma once
#include <array>
#include <cstdint>

#include "host/scene/scene.hpp"

namespace raya {

// `count` of generate_uniform() and generate_random()
inline constexpr int kMaxObjects = 20'000'000;
inline constexpr int kMaxVoxelsPerAxis = 256;  // each element of `voxels` of generate_uniform()

/// SPD's `balls`, the sphereflake: every sphere is touched by nine spheres with a third of its radius, down to
/// recursion depth `level`. The scene has 9^0 + ... + 9^level spheres above one square polygon, and three lights. The
/// spheres are those of SPD 3.9 (E. Haines), in the same order. Throws UserError unless 0 <= level <= 6.
Scene generate_balls(int level);

/// SPD's `lattice` in the cube [0, 1]^3: (size + 1)^3 mirroring spheres, connected by 3 size (size + 1)^2 matt
/// cylinders parallel to the axes, and six lights. The objects are those of SPD (A. Costa, E. Haines) for the size
/// factor `size`, in the same order. Throws UserError unless 1 <= size <= 64.
Scene generate_lattice(int size);

/// size^3 gear wheels of brass, steel, glass and enamel in the cube [-1, 1]^3 above one square polygon, and five
/// lights. The wheels form horizontal layers. Within a layer, each wheel meshes with its neighbours. A wheel consists
/// of two outlines of 144 vertices and 144 quadrilaterals. Size 4 has as many polygons as SPD's `gears` (E. Haines):
/// 9,345, which consist of 36,610 triangles. SPD's wheels have a different shape. Throws UserError unless
/// 1 <= size <= 16.
Scene generate_gears(int size);

/// `count` matt spheres in the cube [-1, 1]^3, distributed evenly over v = voxels[0] * voxels[1] * voxels[2] voxels:
/// every voxel contains floor(count / v) or ceil(count / v) spheres. Each sphere lies inside its voxel, and no two
/// spheres touch. The scene has one light. Throws UserError unless 1 <= count <= 20,000,000, 1 <= voxels[axis] <= 256
/// and v <= 1,048,576.
Scene generate_uniform(int count, std::array<int, 3> voxels);

/// `count` spheres with uniformly random centres in the cube [-1, 1]^3. Radii are 0.5 to 1.5 times r, and at most 0.6;
/// r is the radius with which `count` equal spheres have a twentieth of the cube's volume. Spheres may overlap. Their
/// twelve surfaces are matt, glossy or mirroring. Throws UserError unless 1 <= count <= 20,000,000.
Scene generate_random(int count, std::uint64_t seed);

/// A cluster of three glass, one mirroring and three matt spheres above a checkered floor, with one light. While a
/// sphere touches another sphere, it gets a new random place and radius, at most 200 times. The means of load and
/// imbalance over many seeds match Kohata & Ito's figures. 256 x 256 pixels.
Scene generate_cluster(std::uint64_t seed);

/// Returns a copy of `scene`, which lies in the cube [-1, 1]^3, in which each sphere has a random centre, clamped so
/// that the sphere stays inside the cube. Radii and surfaces do not change.
Scene scattered(const Scene& scene, std::uint64_t seed);

/// Divides the cube [-1, 1]^3 into 4 x 4 x 4 voxels and moves each sphere so that it lies inside the voxel of its
/// centre, at least 1/16 of a voxel's side away from the voxel's faces. A sphere that is too large for this is centred
/// in the voxel. Along each axis, a sphere moves by at most its radius plus 1/16 of a voxel's side. Radii must be less
/// than half a voxel's side.
Scene moved_into_voxels(const Scene& scene);

/// For each face of the cube [-1, 1]^3, moves the sphere nearest to the face until the sphere touches the face, so that
/// the cube becomes the bounding box of the scene.
Scene touching_walls(Scene scene);

}  // namespace raya
