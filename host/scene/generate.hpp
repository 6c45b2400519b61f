// Scenes that a program makes. Each is a pure function of its arguments, the same on every platform: coordinates are
// rounded to decimals, which also keeps the files short. Surfaces are shared (share_surfaces).
#pragma once
#include <array>
#include <cmath>
#include <cstdint>

#include "host/scene/scene.hpp"

namespace raya {

inline constexpr int kHighestBallsLevel = 6;      // 597,871 spheres
inline constexpr int kHighestLatticeSize = 64;    // 274,625 spheres, 811,200 cylinders
inline constexpr int kHighestGearsSize = 16;      // 598,017 polygons
inline constexpr int kMostSpheres = 1'000'000;    // of uniform and random
inline constexpr int kMostVoxelsAlongAxis = 256;  // of uniform
inline constexpr int kMostVoxels = 1'048'576;     // of uniform

/// Lengths that generators put into files, to nine decimals, three more than SPD's own files have, or to fewer: short,
/// and the same on every platform, whose sines and cosines differ in the last bits.
inline double rounded(double x, double parts = 1e9) { return std::round(x * parts) / parts + 0.0; }
inline Vec3 rounded(const Vec3& v, double parts = 1e9) {
    return {rounded(v.x, parts), rounded(v.y, parts), rounded(v.z, parts)};
}

/// SPD's `balls`, the sphereflake: every sphere carries nine of a third of its radius. 9^0 + ... + 9^level spheres
/// above one square polygon, three lights. Same spheres in the same order as SPD 3.9 writes (E. Haines). Throws
/// UserError unless 0 <= level <= 6.
Scene generate_balls(int level);

/// SPD's `lattice`: (size + 1)^3 mirroring spheres, joined by 3 size (size + 1)^2 matt cylinders along the axes to the
/// cube [0, 1]^3, six lights. Same objects in the same order as SPD writes for its size factor (A. Costa, E.
/// Haines). Throws UserError unless 1 <= size <= 64.
Scene generate_lattice(int size);

/// size^3 gear wheels in the cube [-1, 1]^3 above one square polygon, in layers whose wheels mesh with their
/// neighbours; brass, steel, glass and enamel, five lights. A wheel is two outlines of 144 vertices and 144
/// quadrilaterals, so that size 4 has as many polygons as SPD's `gears` (E. Haines), 9,345, or 36,610 triangles. The
/// wheels are our own. Throws UserError unless 1 <= size <= 16.
Scene generate_gears(int size);

/// `count` matt spheres in the cube [-1, 1]^3, spread evenly over x * y * z voxels: every voxel holds floor or ceil of
/// count / voxels, each sphere lies wholly inside its voxel, and no two touch or are alike. One light. Throws UserError
/// unless 1 <= count <= 1,000,000, 1 <= voxels along each axis <= 256 and there are at most 1,048,576 voxels.
Scene generate_uniform(int count, std::array<int, 3> voxels);

/// `count` spheres with centres anywhere in the cube [-1, 1]^3, radii from a half to one and a half of what would fill
/// a twentieth of it, at most 0.6; they may overlap. Twelve surfaces: matt, glossy and mirroring. Throws UserError
/// unless 1 <= count <= 1,000,000.
Scene generate_random(int count, std::uint64_t seed);

/// The project's main scene, of the kind on which static distribution does worst (Kohata & Ito, IPSJ Journal 1993):
/// glass and mirror spheres crowded about the centre of the image, above a checkered plane that costs little. 256 x
/// 256.
Scene generate_centre();

/// What a scene of generate_cluster() is drawn from; lengths in scene units. The figures were found by a search that
/// scenes/README.md describes.
struct ClusterShape {
    int glass = 3, mirrors = 1, matt = 3;  // spheres
    double radius = 1.6;                   // of the cylinder about the z axis in which the centres lie
    double height = 2.1;                   // of the highest place for a sphere above that of one that lies on the floor
    double smallest = 0.4, largest = 0.7;  // radii of spheres
    double checker = 2.35;                 // side of a square of the floor
    double angle_degrees = 20;             // of the view
    int spheres() const { return glass + mirrors + matt; }
};

/// A cluster of spheres that do not touch, where there is room, above a checkered floor under one light: scenes as
/// heavy and as uneven as Kohata & Ito's figures have it, by the mean of many seeds. 256 x 256.
Scene generate_cluster(std::uint64_t seed, const ClusterShape& shape = {});

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
