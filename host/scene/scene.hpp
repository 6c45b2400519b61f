// A scene as structs of double precision numbers, independent of machines, number formats and OpenCL.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "host/model/number_format.hpp"
#include "host/scene/vector.hpp"
#include "kernels/shared/job.h"

namespace raya {

// Vec3 is also a point or a direction, in scene units.
using Colour = Vec3;  // linear red, green, blue; 1 = full intensity

/// Returns the largest magnitude of the coordinates.
inline double largest_coordinate(const Vec3& v) { return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)}); }

/// Rounds to a multiple of 1 / `parts`; by default to nine decimals (SPD's own files have six decimals). Rounding keeps
/// files short, and makes them equal on all platforms although the last bits of sines and cosines differ.
inline double rounded(double x, double parts = 1e9) { return std::round(x * parts) / parts + 0.0; }
inline Vec3 rounded(const Vec3& v, double parts = 1e9) {
    return {rounded(v.x, parts), rounded(v.y, parts), rounded(v.z, parts)};
}

/// The camera (`v` of NFF): the eye at `from` looks at `at`; `up` points upwards in the image. The image spans
/// `angle_degrees` from top to bottom. Pixels are square.
struct View {
    Vec3 from{0, 0, 0};
    Vec3 at{0, 0, 1};
    Vec3 up{0, 1, 0};
    double angle_degrees = 45;  // vertical angle of the image, in (0, 180)
    double hither = 0;          // distance of the near plane; unused, stored only for write_nff()
    int width = 256;            // pixels
    int height = 256;
    bool operator==(const View&) const = default;
};

/// A point light. An empty `colour` means white of intensity sqrt(n) / (2 n) in a scene of n lights.
struct Light {
    Vec3 position;
    std::optional<Colour> colour;
    bool operator==(const Light&) const = default;
};

/// Squares of side `size` in two alternating colours, instead of the surface's colour (kernels/README.md, Checker).
struct Checker {
    Colour even{1, 1, 1}, odd{0, 0, 0};
    double size = 1;  // scene units, > 0
    bool operator==(const Checker&) const = default;
};

/// Colour and shading parameters of a surface (`f` of NFF).
struct Surface {
    Colour colour{1, 1, 1};
    double diffuse = 1;           // Kd: weight of diffusely reflected light
    double specular = 0;          // Ks: weight of highlight and reflected ray
    double shine = 0;             // Phong exponent
    double transmittance = 0;     // T: weight of the refracted ray
    double refraction_index = 1;  // > 0 if transmittance > 0
    std::optional<Checker> checker{};
    bool operator==(const Surface&) const = default;
};

/// A sphere (`s` of NFF). The member `surface` of every object is an index into Scene::surfaces.
struct Sphere {
    Vec3 centre;
    double radius = 1;  // < 0: only the inside is visible
    int surface = 0;
    bool operator==(const Sphere&) const = default;
};

/// The infinite plane of the points p with dot(normal, p) = distance (`#raya plane`). The normal has length 1.
struct Plane {
    Vec3 normal{0, 0, 1};
    double distance = 0;  // from the origin, along the normal; scene units
    int surface = 0;
    bool operator==(const Plane&) const = default;
};

/// A planar polygon, convex or concave (`p`), or a patch with a normal at each vertex (`pp`).
struct Polygon {
    std::vector<Vec3> vertices;  // 3 or more, in order around the polygon, counter-clockwise seen from its front
    std::vector<Vec3> normals;   // empty, or a unit normal for each vertex
    int surface = 0;
    bool operator==(const Polygon&) const = default;
};

/// A cone or cylinder without caps (`c`). Both radii are >= 0, or both are <= 0. If a radius is < 0, only the inside is
/// visible.
struct Cone {
    Vec3 base;
    double base_radius = 1;
    Vec3 apex;
    double apex_radius = 0;
    int surface = 0;
    bool operator==(const Cone&) const = default;
};

/// The contents of a scene file. Objects are numbered by kind, then by their order in the file: all spheres, then
/// planes, polygons and cones. If a ray hits two objects at equal distance, the kernels use the hit of the object with
/// the lower number.
struct Scene {
    std::string name;  // name of the file without folder, or a name chosen by the generator
    Colour background{0, 0, 0};
    View view;
    std::vector<Light> lights;
    std::vector<Surface> surfaces;
    std::vector<Sphere> spheres;
    std::vector<Plane> planes;
    std::vector<Polygon> polygons;
    std::vector<Cone> cones;

    std::size_t object_count() const {
#define RAYA_ADD_COUNT(kind, kinds, KIND) +kinds.size()
        return 0 RAYA_OBJECT_LIST(RAYA_ADD_COUNT);
    }
    bool operator==(const Scene&) const = default;
};

/// Merges equal surfaces and removes unused surfaces, so that equivalent scenes compare equal. Sorts the surfaces by
/// the number of the first object that uses them.
void merge_equal_surfaces(Scene& scene);

/// Removes all objects and returns their memory to the system. A large scene's objects take more memory than its job.
void drop_objects(Scene& scene);

/// Returns the colour of a light of this scene: Light::colour, or if it is empty, white of intensity sqrt(n) / (2 n)
/// for n lights (SPD, E. Haines).
Colour light_colour(const Scene& scene, const Light& light);

/// Returns the intensity of ambient light: sqrt(n) / (2 n) for n lights (SPD), or 1 without lights, so that the image
/// is not black.
double ambient_intensity(const Scene& scene);

/// Returns half the side, in scene units, of the smallest cube centred at the origin that contains the eye and all
/// finite objects.
double scene_extent(const Scene& scene);

// Rotation of the eye around the point that it looks at, random views, and the bounding box of a scene.

/// Rotates the eye by `degrees` around the axis through `at` along `up`, counter-clockwise when `up` points towards the
/// observer. The eye keeps its height and distance. Full turns change no bit; quarter turns use exact sines and
/// cosines.
View turned(View view, double degrees);

/// Limits of the elevation of the eye in random_view().
inline constexpr double kMinElevationDegrees = 5, kMaxElevationDegrees = 75;

/// Returns the scene with a random eye at the old eye's distance from `at`. The new eye is uniformly distributed on the
/// zone of the sphere around `at` between the elevations kMinElevationDegrees and kMaxElevationDegrees above the plane
/// perpendicular to `up`. The result depends only on the arguments, not on the platform: directions are rounded to six
/// decimals.
Scene random_view(Scene scene, std::uint64_t seed);

/// Extends `box` so that it contains a disk perpendicular to `axis`, which has length 1.
void extend_by_disk(Box& box, const Vec3& centre, double radius, const Vec3& axis);

/// Returns the axis-aligned bounding box of all spheres, polygons and cones, in scene units; the box is empty
/// (is_empty()) if the scene has only planes.
Box scene_box(const Scene& scene);

// Chooses the power of two by which a scene's lengths are multiplied so that they fit the range of a number format. The
// multiplication is exact, so the scale changes no bit of the image unless numbers come close to the format's limits.

struct LengthScale {
    int exponent = 0;  // lengths are multiplied by 2^exponent when the scene is packed
    // Maximum magnitude of the coordinates of eye, lights and finite objects, and of planes' distances; scene units.
    double largest_length = 0;
    double smallest_length = 0;  // scene units; minimum of radii, heights of cones, and sides of checkers' squares
    double min_visible = 0;      // scene units; smallest length that is visible at this scale
    std::uint64_t vanishing_count = 0;  // number of spheres, cones and checkers smaller than min_visible
};

/// Chooses the scale of a scene. L is LengthScale::largest_length. S is LengthScale::smallest_length, or L if the scene
/// has no radius, cone or checker. F is the maximum distance of a hit in the number format, N the format's smallest
/// positive number, and u = 2^-(Y+1) its relative rounding error. The scaled lengths should satisfy three conditions:
///   - 4 L <= F: distances within the scene are at most 2 sqrt(3) L, so every hit is found.
///   - S >= sqrt(N): the squares of radii are representable.
///   - u L >= N: the rounding error of the largest length is representable.
/// The scale is 1 if the unscaled scene satisfies the first condition, and the other two with a margin of a factor
/// of 4. Otherwise the scale is the power of two with equal margins to the upper and the lower limits, but at most the
/// largest one with 4 L <= F, or with 64 * 4 L <= F if there are planes, which extend to the horizon. Near the lower
/// limits, squares of small differences are flushed to 0, so images have fewer correct digits than images of the same
/// scene in larger units. Throws UserError, with L and S in the message, if no object would be large enough to be
/// visible.
LengthScale length_scale(const Scene& scene, const NumberFormat& format);

}  // namespace raya
