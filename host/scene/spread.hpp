// Spheres spread over a cube in three ways: evenly, at random, and at random without lying astride voxels.
#pragma once
#include <cstdint>

#include "host/scene/scene.hpp"

namespace raya {

inline constexpr std::uint32_t kObjectSides = 4;  // voxels along each axis of the cube

/// The spheres of `even`, which lies in the cube [-1, 1]^3, about centres that are drawn from the cube and moved into
/// it as far as their spheres stick out; all else, radii and surfaces of each sphere, stays as it is.
Scene scattered(const Scene& even, std::uint64_t seed);

/// Each sphere moved, by its radius and a 16th of a voxel's side at most along each axis, until it lies within the
/// voxel of its centre and as far from its sides, or in the middle; the cube [-1, 1]^3 is cut into 4 x 4 x 4. Its
/// radius is less than half a voxel's side.
Scene moved_within(const Scene& scene);

/// The outermost sphere on each side moved outwards until it touches the side of the cube [-1, 1]^3: the scene's box is
/// that cube then.
Scene touching_walls(Scene scene);

}  // namespace raya
