// Generated scenes. Each is a pure function of its arguments and the same on every platform: coordinates are rounded to
// decimals, which also keeps the files short. Surfaces are shared (share_surfaces()).
#pragma once
#include <array>
#include <cmath>
#include <cstdint>

#include "host/scene/scene.hpp"

namespace raya {

inline constexpr int kHighestBallsLevel = 6;    // 597,871 spheres
inline constexpr int kHighestLatticeSize = 64;  // 274,625 spheres, 811,200 cylinders
inline constexpr int kHighestGearsSize = 16;    // 598,017 polygons
inline constexpr int kMaxSpheres = 1'000'000;   // of uniform and random
inline constexpr int kMaxVoxelsPerAxis = 256;   // of uniform
inline constexpr int kMaxVoxels = 1'048'576;    // of uniform

/// Rounds to nine decimals (SPD's own files have six), or to `parts` per unit. Makes files short and independent of the
/// platform, whose sines and cosines differ in the last bits.
inline double rounded(double x, double parts = 1e9) { return std::round(x * parts) / parts + 0.0; }
inline Vec3 rounded(const Vec3& v, double parts = 1e9) {
    return {rounded(v.x, parts), rounded(v.y, parts), rounded(v.z, parts)};
}

/// SPD's `balls`, the sphereflake: every sphere carries nine spheres of a third of its radius. 9^0 + ... + 9^level
/// spheres above one square polygon, three lights. Same spheres in the same order as the output of SPD 3.9 (E. Haines).
/// UserError unless 0 <= level <= 6.
Scene generate_balls(int level);

/// SPD's `lattice` in the cube [0, 1]^3: (size + 1)^3 mirroring spheres, connected by 3 size (size + 1)^2 matt
/// cylinders along the axes, six lights. Same objects in the same order as the output of SPD for its size factor (A.
/// Costa, E. Haines). UserError unless 1 <= size <= 64.
Scene generate_lattice(int size);

/// size^3 gear wheels in the cube [-1, 1]^3 above one square polygon, in layers whose wheels mesh with their
/// neighbours; brass, steel, glass and enamel, five lights. A wheel consists of two outlines of 144 vertices and 144
/// quadrilaterals. Size 4 has as many polygons as SPD's `gears` (E. Haines): 9,345, or 36,610 triangles; the shape of
/// the wheels is different. UserError unless 1 <= size <= 16.
Scene generate_gears(int size);

/// `count` matt spheres in the cube [-1, 1]^3, distributed evenly over x * y * z voxels: every voxel contains floor or
/// ceil of count / voxels spheres. Each sphere is inside its voxel, and no two touch or are equal. One light. UserError
/// unless 1 <= count <= 1,000,000, 1 <= voxels along each axis <= 256 and there are at most 1,048,576 voxels.
Scene generate_uniform(int count, std::array<int, 3> voxels);

/// `count` spheres with uniformly random centres in the cube [-1, 1]^3. Radii are 0.5 to 1.5 times the radius at which
/// equal spheres would fill a twentieth of the cube, and at most 0.6; spheres may overlap. Twelve surfaces: matt,
/// glossy and mirroring. UserError unless 1 <= count <= 1,000,000.
Scene generate_random(int count, std::uint64_t seed);

/// The project's main scene, of the kind that is worst for static distribution (Kohata & Ito, IPSJ Journal 1993): glass
/// and mirror spheres concentrated in the centre of the image, above a checkered plane that costs little. 256 x 256.
Scene generate_centre();

/// Parameters of generate_cluster(); lengths in scene units. The defaults were found by a search, see scenes/README.md.
struct ClusterShape {
    int glass = 3, mirrors = 1, matt = 3;  // spheres
    double radius = 1.6;                   // of the cylinder around the z axis that contains the centres
    double height = 2.1;                   // maximum height of a sphere above the floor
    double smallest = 0.4, largest = 0.7;  // radii of spheres
    double checker = 2.35;                 // side of a square of the floor
    double angle_degrees = 20;             // of the view
    int spheres() const { return glass + mirrors + matt; }
};

/// A cluster of spheres, which do not touch if there is space, above a checkered floor, one light. Averaged over many
/// seeds, load and imbalance match Kohata & Ito's figures. 256 x 256.
Scene generate_cluster(std::uint64_t seed, const ClusterShape& shape = {});

inline constexpr std::uint32_t kObjectSides = 4;  // voxels along each axis of the cube

/// Returns `even`, a scene in the cube [-1, 1]^3, with the spheres at random centres in the cube, clamped so that the
/// spheres stay inside it. Radii and surfaces do not change.
Scene scattered(const Scene& even, std::uint64_t seed);

/// Moves each sphere into the voxel of its centre; the cube [-1, 1]^3 is cut into 4 x 4 x 4 voxels. A sphere keeps a
/// distance of 1/16 of a voxel's side from the sides of its voxel, or is centred in it. It moves along each axis by at
/// most its radius and this distance. Radii must be less than half a voxel's side.
Scene moved_within(const Scene& scene);

/// Moves the outermost sphere on each side outwards until it touches the side of the cube [-1, 1]^3, so that this cube
/// is the bounding box of the scene.
Scene touching_walls(Scene scene);

}  // namespace raya
