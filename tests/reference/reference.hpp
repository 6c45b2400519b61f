// The oracle of the tests: a simple double-precision renderer that implements kernels/README.md. It tests every object
// for every ray and uses no machine model and no OpenCL.
#pragma once
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "host/scene/scene.hpp"

namespace raya::reference {

inline constexpr double kFar = std::numeric_limits<double>::infinity();

/// Points origin + t * direction, t > 0; the direction has length 1.
struct Ray {
    Vec3 origin, direction;
};

/// Where a ray meets an object, ready to be shaded.
struct Hit {
    double t = 0;             // scene units from the ray's origin
    int object = 0;           // number: spheres, planes, polygons, cones, each in the order of the scene
    Vec3 point;               // scene units
    Vec3 geometric, shading;  // normals of length 1, turned against the ray
    bool leaving = false;     // the ray leaves the object
    int surface = 0;          // index into Scene::surfaces
    bool odd_square = false;  // of the checker, where there is one
    Colour colour{0, 0, 0};   // of the surface, checker applied
};

/// The smallest t > 0 at which the ray meets the object, if any. Two-sided, except for negative radii.
std::optional<double> hit_sphere(const Sphere& sphere, const Ray& ray);
std::optional<double> hit_plane(const Plane& plane, const Ray& ray);
std::optional<double> hit_polygon(const Polygon& polygon, const Ray& ray);
std::optional<double> hit_cone(const Cone& cone, const Ray& ray);

/// The hit of smallest t in 0 < t < far over all objects; on a tie the object with the lowest number.
std::optional<Hit> closest_hit(const Scene& scene, const Ray& ray, double far = kFar);

/// R: the direction mirrored at a surface of this normal; both of length 1.
Vec3 reflected_direction(const Vec3& direction, const Vec3& normal);

/// Q: the direction refracted at a surface whose normal is turned against it; `e` is the index of refraction in front
/// of the surface over that behind it. Empty under total reflection.
std::optional<Vec3> refracted_direction(const Vec3& direction, const Vec3& normal, double e);

struct Options {
    int width = 0;                   // pixels, >= 1
    int height = 0;                  // pixels, >= 1
    int bounces = 8;                 // reflections and refractions after the primary ray
    bool corners = false;            // sampling: through pixel corners as SPD does, else through centres
    std::optional<double> margin{};  // scene units; 1e-9 * scene_extent if empty
    int threads = 2;                 // of render(), >= 1; does not affect the image
};

/// Rays by kind, and how many of them hit something.
struct Counts {
    std::uint64_t primary = 0, primary_hits = 0;
    std::uint64_t reflected = 0, refracted = 0;
    std::uint64_t shadow = 0, shadow_hits = 0;
    bool operator==(const Counts&) const = default;
};

struct Image {
    int width = 0, height = 0;
    std::vector<Colour> pixels;  // height rows of width, row 0 on top; linear, not clamped
    Counts counts;
};

/// The events of a pixel's ray tree in the order of tracing: object numbers (with a mark for an odd checker square),
/// misses, lit and unlit results, total reflections. Equal histories mean equal trees; the codes have no other meaning.
using History = std::vector<int>;

/// The ray through column `x` and row `y`, in pixels; whole numbers are the pixel's own sample, fractions points next
/// to it.
Ray primary_ray(const Scene& scene, const Options& options, double x, double y);

/// The colour (linear, not clamped) seen along primary_ray(x, y). Adds its rays to `counts`, and their events to
/// `history` if given.
Colour trace_pixel(const Scene& scene, const Options& options, double x, double y, Counts& counts,
                   History* history = nullptr);

/// Renders all pixels, on options.threads threads; the result does not depend on their number.
Image render(const Scene& scene, const Options& options);

/// A 32nd of a pixel is about 1e-4 of the image's side: a few hundred roundings of fp32, and far below what is visible.
inline constexpr double kReachPixels = 1.0 / 32;

/// Returns true if fp32 and double may correctly differ: between the sample of pixel (x, y) and the 8 points around it
/// at +-reach_pixels in x and y the ray tree's history changes, or a channel, clamped to 0..1, by more than 1/255.
bool grazes_edge(const Scene& scene, const Options& options, int x, int y, double reach_pixels = kReachPixels);

/// The difference of an image from the reference, on values clamped to 0..1. A value that is not finite is infinitely
/// far.
struct Difference {
    double psnr_db = 0;  // over all channels of all pixels, peak 1; infinite for equal images
    double largest = 0;  // of any channel
    int over = 0;        // pixels with any channel off by more than the limit
    int excused = 0;     // of those, pixels that graze an edge
};

/// Compares `rgb` (height * width * 3, row 0 on top, linear) with a reference rendered from `scene` with `options`.
/// Throws std::invalid_argument if the sizes differ.
Difference compare(const Image& reference, const std::vector<float>& rgb, const Scene& scene, const Options& options,
                   double limit = 2.0 / 255, double reach_pixels = kReachPixels);

}  // namespace raya::reference
