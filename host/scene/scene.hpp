// A scene as plain data in double precision, independent of machines, number formats and OpenCL.
#pragma once
#include <Imath/ImathVec.h>

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace raya {

using Vec3 = Imath::V3d;    // points and directions, scene units
using Colour = Imath::V3d;  // linear red, green, blue; 1 = full intensity

/// The viewpoint (`v` of NFF). The image spans `angle_degrees` from top to bottom; pixels are square.
struct View {
    Vec3 from{0, 0, 0};
    Vec3 at{0, 0, 1};
    Vec3 up{0, 1, 0};
    double angle_degrees = 45;  // of the whole height, in (0, 180)
    double hither = 0;          // stored for writing only: a ray tracer has no hither plane
    int width = 256;            // pixels
    int height = 256;
    bool operator==(const View&) const = default;
};

/// A positional light. An empty `colour` means white of sqrt(n) / (2 n) for n lights.
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

/// The fill colour and shading parameters (`f` of NFF).
struct Surface {
    Colour colour{1, 1, 1};
    double diffuse = 1;        // Kd
    double specular = 0;       // Ks: highlight and share of the reflected ray
    double shine = 0;          // Phong exponent
    double transmittance = 0;  // T: share of the refracted ray
    double refraction = 1;     // index of refraction, > 0 if transmittance > 0
    std::optional<Checker> checker{};
    bool operator==(const Surface&) const = default;
};

/// `surface` is an index into Scene::surfaces in every object.
struct Sphere {
    Vec3 centre;
    double radius = 1;  // < 0: only the inside is visible
    int surface = 0;
    bool operator==(const Sphere&) const = default;
};

/// The infinite plane n.x = d (`#raya plane`); the normal has length 1.
struct Plane {
    Vec3 normal{0, 0, 1};
    double distance = 0;  // d
    int surface = 0;
    bool operator==(const Plane&) const = default;
};

/// A planar polygon, convex or concave (`p`), or a patch with a normal at each vertex (`pp`).
struct Polygon {
    std::vector<Vec3> vertices;  // 3 or more, in order around the polygon, counter-clockwise seen from its front
    std::vector<Vec3> normals;   // empty, or one of length 1 for each vertex
    int surface = 0;
    bool operator==(const Polygon&) const = default;
};

/// A cone or cylinder without caps (`c`). Radii are both >= 0, or both <= 0: only the inside is visible.
struct Cone {
    Vec3 base;
    double base_radius = 1;
    Vec3 apex;
    double apex_radius = 0;
    int surface = 0;
    bool operator==(const Cone&) const = default;
};

/// The contents of a scene file. Objects are numbered by kind, then by their order in the file: all spheres, then
/// planes, polygons and cones. Of two hits at equal distance the lower number wins.
struct Scene {
    std::string name;  // the file's name without folder, or what generated it
    Colour background{0, 0, 0};
    View view;
    std::vector<Light> lights;
    std::vector<Surface> surfaces;
    std::vector<Sphere> spheres;
    std::vector<Plane> planes;
    std::vector<Polygon> polygons;
    std::vector<Cone> cones;

    std::size_t object_count() const { return spheres.size() + planes.size() + polygons.size() + cones.size(); }
    bool operator==(const Scene&) const = default;
};

/// Stores equal surfaces once, in the order in which the objects (by number) first use them, and removes unused ones,
/// so that equivalent scenes compare equal.
void share_surfaces(Scene& scene);

/// The colour of a light of this scene: its own, or white of sqrt(n) / (2 n) (SPD, E. Haines).
Colour light_colour(const Scene& scene, const Light& light);

/// The ambient intensity: sqrt(n) / (2 n) for n lights (SPD); 1 without lights, so that the image is not black.
double ambient_intensity(const Scene& scene);

/// Half the side of the smallest cube around the origin that contains the eye and all finite objects, scene units.
double scene_extent(const Scene& scene);

}  // namespace raya
