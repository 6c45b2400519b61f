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

/// The points origin + t * direction with t > 0. The direction has length 1.
struct Ray {
    Vec3 origin, direction;
};

/// A hit of a ray with an object, with the data for shading.
struct Hit {
    double t = 0;             // distance from the ray's origin, scene units
    int object = 0;           // object number: spheres, planes, polygons, cones, each kind in scene order
    Vec3 point;               // scene units
    Vec3 geometric, shading;  // geometric and shading normal, length 1, turned against the ray
    bool leaving = false;     // true if the ray leaves the object
    int surface = 0;          // index into Scene::surfaces
    bool odd_square = false;  // true if the hit is on an odd square of a checker
    Colour colour{0, 0, 0};   // colour of the surface at the hit, with the checker
};

/// Return the smallest t > 0 at which the ray hits the object; empty for a miss. Objects are visible from both sides;
/// spheres and cones with a negative radius only from inside.
std::optional<double> hit_sphere(const Sphere& sphere, const Ray& ray);
std::optional<double> hit_plane(const Plane& plane, const Ray& ray);
std::optional<double> hit_polygon(const Polygon& polygon, const Ray& ray);
std::optional<double> hit_cone(const Cone& cone, const Ray& ray);

/// Returns the hit of the ray with the smallest t in 0 < t < far; empty if there is none. If several objects have this
/// t, the ray hits the object with the lowest number.
std::optional<Hit> closest_hit(const Scene& scene, const Ray& ray, double far = kFar);

/// Returns the direction R of the reflected ray. Direction and normal must have length 1.
Vec3 reflected_direction(const Vec3& direction, const Vec3& normal);

/// Returns the direction Q of the refracted ray; empty under total reflection. `normal`: turned against `direction`;
/// `e`: index of refraction in front of the surface divided by the index behind the surface.
std::optional<Vec3> refracted_direction(const Vec3& direction, const Vec3& normal, double e);

struct Options {
    int width = 0;                   // pixels, >= 1
    int height = 0;                  // pixels, >= 1
    int bounces = 8;                 // maximum number of reflections and refractions on a path
    bool corners = false;            // true: rays through pixel corners, as in SPD; false: through pixel centres
    std::optional<double> margin{};  // offset of secondary rays, scene units; default: 1e-9 * scene_extent()
    int threads = 2;                 // number of threads of render(), >= 1; does not change the image
};

/// Numbers of rays of each kind, and numbers of primary and shadow rays that hit an object.
struct Counts {
    std::uint64_t primary = 0, primary_hits = 0;
    std::uint64_t reflected = 0, refracted = 0;
    std::uint64_t shadow = 0, shadow_hits = 0;
    bool operator==(const Counts&) const = default;
};

struct Image {
    int width = 0, height = 0;
    std::vector<Colour> pixels;  // [row][column], row 0 at the top; linear, not clamped
    Counts counts;
};

/// The events of a pixel's ray tree, as codes in the order of tracing: a hit of an object (with the parity of the
/// checker square), a miss, a light that reaches a hit, a light that does not, total reflection. Equal histories mean
/// that the rays of two ray trees meet the same objects and lights.
using History = std::vector<int>;

/// Returns the primary ray through column `x` and row `y`, in pixels. Integers are the sample point of a
/// pixel, fractions are points between sample points.
Ray primary_ray(const Scene& scene, const Options& options, double x, double y);

/// Returns the radiance (linear, not clamped) along primary_ray(x, y). Adds the numbers of the tree's rays to
/// `counts`, and the tree's events to `history` unless `history` is null.
Colour trace_pixel(const Scene& scene, const Options& options, double x, double y, Counts& counts,
                   History* history = nullptr);

/// Renders all pixels with options.threads threads. The result does not depend on the number of threads.
Image render(const Scene& scene, const Options& options);

/// Default distance for grazes_edge(), in pixels. The distance is about 1e-4 of the image's width, which is a few
/// hundred fp32 rounding errors and too small to be visible.
inline constexpr double kEdgeDistancePixels = 1.0 / 32;

/// Returns true if pixel (x, y) is near an edge, so that rounding may change it without an error. The pixel is near an
/// edge if one of the 8 points at +-edge_distance_pixels in x and y differs from the sample point: the history of the
/// ray tree differs, or a channel, clamped to 0..1, differs by more than 1/255.
bool grazes_edge(const Scene& scene, const Options& options, int x, int y,
                 double edge_distance_pixels = kEdgeDistancePixels);

/// The difference between an image and the reference. Channels are clamped to 0..1. A value that is not finite counts
/// as an infinite difference.
struct Difference {
    double psnr_db = 0;   // PSNR over all channels and pixels, peak 1; infinite for equal images
    double largest = 0;   // maximum difference of a channel
    int above_limit = 0;  // number of pixels with a channel that differs by more than the limit
    int excused = 0;      // number of pixels above the limit for which grazes_edge() is true
};

/// Compares `rgb` (height * width * 3 values, row 0 at the top, linear) with `reference`, which must have been rendered
/// from `scene` with `options`. Throws std::invalid_argument if the sizes differ.
Difference compare(const Image& reference, const std::vector<float>& rgb, const Scene& scene, const Options& options,
                   double limit = 2.0 / 255, double edge_distance_pixels = kEdgeDistancePixels);

}  // namespace raya::reference
