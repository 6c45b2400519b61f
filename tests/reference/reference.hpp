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

/// The points origin + t * direction, t > 0. The direction has length 1.
struct Ray {
    Vec3 origin, direction;
};

/// A hit of a ray with an object, with the data for shading.
struct Hit {
    double t = 0;             // scene units from the ray's origin
    int object = 0;           // object number: spheres, planes, polygons, cones, each kind in scene order
    Vec3 point;               // scene units
    Vec3 geometric, shading;  // normals of length 1, turned against the ray
    bool leaving = false;     // the ray leaves the object
    int surface = 0;          // index into Scene::surfaces
    bool odd_square = false;  // the hit is on an odd square of a checker
    Colour colour{0, 0, 0};   // colour of the surface at the hit, with the checker
};

/// Return the smallest t > 0 at which the ray hits the object, if any. Objects are visible from both sides; with a
/// negative radius only from inside.
std::optional<double> hit_sphere(const Sphere& sphere, const Ray& ray);
std::optional<double> hit_plane(const Plane& plane, const Ray& ray);
std::optional<double> hit_polygon(const Polygon& polygon, const Ray& ray);
std::optional<double> hit_cone(const Cone& cone, const Ray& ray);

/// Returns the hit with the smallest t, 0 < t < far, of all objects. On a tie the lowest object number wins.
std::optional<Hit> closest_hit(const Scene& scene, const Ray& ray, double far = kFar);

/// Returns R: the direction of the reflected ray. Direction and normal must have length 1.
Vec3 reflected_direction(const Vec3& direction, const Vec3& normal);

/// Returns Q: the direction of the refracted ray; empty under total reflection. `normal`: turned against `direction`;
/// `e`: ratio of the index of refraction in front of the surface to that behind it.
std::optional<Vec3> refracted_direction(const Vec3& direction, const Vec3& normal, double e);

struct Options {
    int width = 0;                   // pixels, >= 1
    int height = 0;                  // pixels, >= 1
    int bounces = 8;                 // reflections and refractions after the primary ray
    bool corners = false;            // rays go through pixel corners, as in SPD; else through pixel centres
    std::optional<double> margin{};  // offset of secondary rays, scene units; default: 1e-9 * scene_extent()
    int threads = 2;                 // threads of render(), >= 1; they do not change the image
};

/// Numbers of rays of each kind and of rays that hit something.
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

/// The events of a pixel's ray tree in the order of tracing, as codes: object hit (with the parity of the checker
/// square), miss, light that reaches a hit or does not, total reflection. Ray trees are equal if their histories are
/// equal.
using History = std::vector<int>;

/// Returns the primary ray through column `x` and row `y`, in pixels. Integers give the sample point of that pixel,
/// fractions give points between sample points.
Ray primary_ray(const Scene& scene, const Options& options, double x, double y);

/// Returns the radiance (linear, not clamped) along primary_ray(x, y). Adds the rays of its ray tree to `counts` and
/// their events to `history`, unless it is null.
Colour trace_pixel(const Scene& scene, const Options& options, double x, double y, Counts& counts,
                   History* history = nullptr);

/// Renders all pixels with options.threads threads. The result does not depend on the number of threads.
Image render(const Scene& scene, const Options& options);

/// Default distance for grazes_edge(), in pixels. It is about 1e-4 of the image's width, which is a few hundred fp32
/// rounding errors and far below what is visible.
inline constexpr double kReachPixels = 1.0 / 32;

/// Returns true if rounding may legitimately change pixel (x, y), because it is near an edge. Compares the pixel's
/// sample point with the 8 points around it at +-reach_pixels in x and y: the ray tree's history differs, or a channel,
/// clamped to 0..1, differs by more than 1/255.
bool grazes_edge(const Scene& scene, const Options& options, int x, int y, double reach_pixels = kReachPixels);

/// The difference between an image and the reference. Channels are clamped to 0..1. A value that is not finite counts
/// as an infinite difference.
struct Difference {
    double psnr_db = 0;   // PSNR over all channels and pixels, peak 1; infinite for equal images
    double largest = 0;   // maximum difference of any channel
    int above_limit = 0;  // pixels in which any channel differs by more than the limit
    int excused = 0;      // of these pixels, those for which grazes_edge() is true
};

/// Compares `rgb` (height * width * 3 values, row 0 at the top, linear) with `reference`, which must have been rendered
/// from `scene` with `options`. Throws std::invalid_argument if the sizes differ.
Difference compare(const Image& reference, const std::vector<float>& rgb, const Scene& scene, const Options& options,
                   double limit = 2.0 / 255, double reach_pixels = kReachPixels);

}  // namespace raya::reference
