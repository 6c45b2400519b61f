// Compares the reference's hits with implicit equations, sampling and known answers.
#include <catch2/catch.hpp>
#include <cmath>
#include <cstdint>
#include <functional>
#include <random>

#include "host/scene/polygon.hpp"
#include "tests/reference/reference.hpp"

namespace raya::reference {
namespace {

constexpr int kRays = 10'000;

/// A seeded random number generator with the same results on every platform.
class Random {
  public:
    explicit Random(std::uint64_t seed) : engine_(seed) {}
    double uniform(double low, double high) {
        return low + (high - low) * (static_cast<double>(engine_() >> 11) * 0x1p-53);
    }
    Vec3 point(double magnitude) {
        const double x = uniform(-magnitude, magnitude), y = uniform(-magnitude, magnitude),
                     z = uniform(-magnitude, magnitude);
        return {x, y, z};
    }
    Ray ray(double magnitude) {
        const Vec3 origin = point(magnitude);
        return {origin, (point(1) - origin).normalized()};
    }

  private:
    std::mt19937_64 engine_;
};

Vec3 at(const Ray& ray, double t) { return ray.origin + t * ray.direction; }

/// A random ray and object, and the hit that the reference finds.
struct SampledRay {
    std::optional<double> t;
    /// Returns the distance of the ray's point at t from the object's surface: positive outside, NaN beyond its ends.
    std::function<double(double)> signed_distance;
    bool inside_only = false;  // the object is visible only from inside
    double tolerance = 1e-12;  // of signed_distance(hit)
};

/// Returns the smallest sampled t at which the signed distance changes its sign, to positive if the object is visible
/// only from inside; empty if there is none.
std::optional<double> first_crossing(const SampledRay& ray) {
    constexpr int kSteps = 500;
    constexpr double kEnd = 12;
    double before = ray.signed_distance(0);
    for (int i = 1; i <= kSteps; ++i) {
        const double t = kEnd * i / kSteps, now = ray.signed_distance(t);
        if ((before < 0 && now > 0) || (!ray.inside_only && before > 0 && now < 0)) return t;
        before = now;
    }
    return {};
}

/// Checks, for kRays rays and objects that `make(random, i)` returns, that the hit is the first zero of the signed
/// distance.
template <class Make>
void check_first_zeros(std::uint64_t seed, const Make& make) {
    Random random(seed);
    int hits = 0;
    for (int i = 0; i < kRays; ++i) {
        CAPTURE(seed, i);
        const SampledRay ray = make(random, i);
        const std::optional<double> sampled = first_crossing(ray);
        if (sampled) REQUIRE(ray.t);
        if (!ray.t) continue;
        ++hits;
        const double t = *ray.t;
        REQUIRE(t > 0);
        REQUIRE(std::abs(ray.signed_distance(t)) < ray.tolerance);
        constexpr double kBeside = 1e-7;
        if (ray.inside_only)
            REQUIRE_FALSE(ray.signed_distance(t + kBeside) < ray.signed_distance(t - kBeside));  // it leaves the object
        if (sampled) REQUIRE(t <= *sampled);
    }
    CHECK(hits > kRays / 5);
}

TEST_CASE("the hit is the first zero of the implicit equation of the sphere, plane or cone") {
    check_first_zeros(1, [](Random& random, int i) {
        const double sign = i % 3 == 0 ? -1 : 1;
        const Sphere sphere{random.point(1), sign * random.uniform(0.1, 1), 0};
        const Ray ray = random.ray(3);
        return SampledRay{hit_sphere(sphere, ray),
                          [=](double t) { return (at(ray, t) - sphere.centre).length() - std::abs(sphere.radius); },
                          sign < 0};
    });
    check_first_zeros(2, [](Random& random, int) {
        const Plane plane{random.point(1).normalized(), random.uniform(-2, 2), 0};
        const Ray ray = random.ray(3);
        const std::optional<double> t = hit_plane(plane, ray);
        return SampledRay{t, [=](double at_t) { return plane.normal.dot(at(ray, at_t)) - plane.distance; }, false,
                          1e-13 * (1 + t.value_or(0))};
    });
    check_first_zeros(3, [](Random& random, int i) {
        const bool inside_only = i % 3 == 0;
        const double sign = inside_only ? -1 : 1;
        const double top = i % 4 == 0 ? 0 : random.uniform(0.1, 1);
        const double bottom = i % 5 == 0 ? top + 0.05 : random.uniform(0.1, 1);
        const Cone cone{random.point(1), sign * bottom, random.point(1), sign * top, 0};
        const Ray ray = random.ray(3);
        const double height = (cone.apex - cone.base).length();
        const Vec3 axis = (cone.apex - cone.base) / height;
        const auto signed_distance = [=](double t) {
            const Vec3 x = at(ray, t) - cone.base;
            const double z = x.dot(axis);
            if (z < 0 || z > height) return std::nan("");
            return (x - z * axis).length() - (bottom + (top - bottom) * z / height);
        };
        // Rounding moves the hit point off the surface. On flat cones the slope magnifies this error.
        return SampledRay{hit_cone(cone, ray), signed_distance, inside_only,
                          1e-11 * (1 + std::abs(top - bottom) / height)};
    });
    CHECK_FALSE(hit_plane({{0, 0, 1}, 1, 0}, {{0, 0, 0}, {1, 0, 0}}));
}

TEST_CASE("a cylinder has no caps, and its normal is radial") {
    Scene scene;
    scene.surfaces.resize(1);
    scene.cones.push_back({{0, 0, 0}, 1, {0, 0, 2}, 1, 0});
    CHECK_FALSE(closest_hit(scene, {{0.5, 0, 5}, {0, 0, -1}}));
    const auto outside = closest_hit(scene, {{3, 0, 1}, {-1, 0, 0}});
    REQUIRE(outside);
    CHECK(outside->t == Approx(2));
    CHECK((outside->geometric - Vec3(1, 0, 0)).length() < 1e-15);
    CHECK_FALSE(outside->leaving);
    scene.cones[0] = {{0, 0, 0}, -1, {0, 0, 2}, -1, 0};
    const auto inside = closest_hit(scene, {{3, 0, 1}, {-1, 0, 0}});
    REQUIRE(inside);
    CHECK(inside->t == Approx(4));
    CHECK(inside->leaving);
    CHECK((inside->geometric - Vec3(1, 0, 0)).length() < 1e-15);
}

/// Returns true if the outline winds around the point. In this case, the angles at which the point sees the edges add
/// up to +-2 pi, otherwise to 0. All points have z = 0.
bool winds_around(const std::vector<Vec3>& outline, const Vec3& p) {
    double sum = 0;
    for (std::size_t i = 0; i < outline.size(); ++i) {
        const Vec3 a = outline[i] - p, b = outline[(i + 1) % outline.size()] - p;
        sum += std::atan2(a.x * b.y - a.y * b.x, a.x * b.x + a.y * b.y);
    }
    return std::abs(sum) > 3;
}

TEST_CASE("concave polygons and polygons with a hole are hit only inside their outline") {
    constexpr std::uint64_t kSeed = 5;
    Random random(kSeed);
    const Polygon notched{
        {{0, 0, 0}, {3, 0, 0}, {3, 3, 0}, {2, 3, 0}, {2, 1, 0}, {1, 1, 0}, {1, 3, 0}, {0, 3, 0}}, {}, 0};
    const Polygon holed{
        {{0, 0, 0}, {3, 0, 0}, {3, 3, 0}, {0, 3, 0}, {0, 0, 0}, {1, 1, 0}, {1, 2, 0}, {2, 2, 0}, {2, 1, 0}, {1, 1, 0}},
        {},
        0};
    for (const Polygon& polygon : {notched, holed}) {
        CHECK(hit_polygon(polygon, {{0.5, 0.6, 1}, {0, 0, -1}}));
        CHECK_FALSE(hit_polygon(polygon, {{1.5, 1.5, 1}, {0, 0, -1}}));  // in the notch or the hole
        for (int i = 0; i < kRays; ++i) {
            CAPTURE(kSeed, i);
            const Vec3 target(random.uniform(-0.5, 3.5), random.uniform(-0.5, 3.5), 0);
            const Vec3 origin = random.point(2) + Vec3(0, 0, i % 2 ? 3 : -3);
            const auto t = hit_polygon(polygon, {origin, (target - origin).normalized()});
            REQUIRE(t.has_value() == winds_around(polygon.vertices, target));
            if (t) REQUIRE(*t == Approx((target - origin).length()).epsilon(1e-13));
        }
    }
}

TEST_CASE("a triangle's normals are interpolated linearly and normalised") {
    Scene scene;
    scene.surfaces.resize(1);
    const std::vector<Vec3> corners{{0, 0, 0}, {2, 0, 0}, {0, 2, 0}};
    const std::vector<Vec3> normals{{0, 0, 1}, Vec3(1, 0, 1).normalized(), Vec3(0, 1, 2).normalized()};
    scene.polygons.push_back({corners, normals, 0});
    const auto check_normal = [&](const Vec3& point, const Vec3& expected) {
        const auto above = closest_hit(scene, {point + Vec3(0, 0, 1), {0, 0, -1}});
        const auto below = closest_hit(scene, {point - Vec3(0, 0, 1), {0, 0, 1}});
        REQUIRE((above && below));
        CHECK((above->shading - expected.normalized()).length() < 1e-8);
        CHECK(above->geometric == Vec3(0, 0, 1));
        CHECK((below->shading + expected.normalized()).length() < 1e-8);
        CHECK((below->leaving && !above->leaving));
    };
    constexpr double kInward =
        1e-9;  // moves points inwards, because not every point of the border is inside the triangle
    const Vec3 middle(2.0 / 3, 2.0 / 3, 0);
    for (std::size_t i = 0; i < 3; ++i) {
        const std::size_t next = (i + 1) % 3;
        check_normal(corners[i] + kInward * (middle - corners[i]), normals[i]);
        const Vec3 midpoint = (corners[i] + corners[next]) / 2;
        check_normal(midpoint + kInward * (middle - midpoint), normals[i] + normals[next]);
    }
    check_normal(middle, normals[0] + normals[1] + normals[2]);
}

TEST_CASE("the normals of a patch with five vertices reproduce a linear field, and are turned against the ray") {
    // The normals have different lengths. The interpolated normal is a linear function of the point only before it is
    // normalised.
    constexpr std::uint64_t kSeed = 6;
    Random random(kSeed);
    Scene scene;
    scene.surfaces.resize(1);
    Polygon patch{{{0, 0, 0}, {3, 0, 0}, {3, 3, 0}, {1, 1, 0}, {0, 3, 0}}, {}, 0};
    const auto field = [](const Vec3& p) { return Vec3(0.1 * p.x, 0.2 * p.y, 1); };
    for (const Vec3& v : patch.vertices) patch.normals.push_back(field(v));
    scene.polygons.push_back(patch);
    int hits = 0;
    for (int i = 0; i < 1000; ++i) {
        CAPTURE(kSeed, i);
        const Vec3 target(random.uniform(0, 3), random.uniform(0, 3), 0);
        const auto hit = closest_hit(scene, {target + Vec3(0, 0, 2), {0, 0, -1}});
        if (!hit) continue;
        ++hits;
        REQUIRE((hit->shading - field(target).normalized()).length() < 1e-14);
    }
    CHECK(hits > 500);

    // With two changed normals, no linear field fits all vertices. Near a vertex the hit must have the vertex's normal,
    // not an extrapolation from another triangle.
    scene.polygons[0].normals[0] = Vec3(1, 0, 1).normalized();
    scene.polygons[0].normals[3] = Vec3(0, 1, 1).normalized();
    for (std::size_t i = 0; i < patch.vertices.size(); ++i) {
        CAPTURE(i);
        const Vec3 target = patch.vertices[i] + 1e-9 * (Vec3(1, 0.5, 0) - patch.vertices[i]);
        const auto hit = closest_hit(scene, {target + Vec3(0, 0, 2), {0, 0, -1}});
        REQUIRE(hit);
        CHECK((hit->shading - scene.polygons[0].normals[i].normalized()).length() < 1e-8);
    }
    scene.polygons[0] = patch;
    for (Vec3& n : scene.polygons[0].normals) n = -n;
    const auto hit = closest_hit(scene, {{1, 0.5, 2}, {0, 0, -1}});
    REQUIRE(hit);
    CHECK((hit->shading - field({1, 0.5, 0}).normalized()).length() < 1e-14);
}

TEST_CASE("of objects with equal t, a ray hits the object with the lowest number; hits with t >= far do not count") {
    Scene scene;
    scene.surfaces.resize(4);
    scene.spheres.push_back({{0, 0, 0}, 1, 0});
    scene.spheres.push_back({{0, 0, 0}, 1, 1});
    scene.planes.push_back({{0, 0, 1}, 1, 2});
    scene.polygons.push_back({{{-1, -1, 1}, {1, -1, 1}, {0, 1, 1}}, {}, 3});
    const Ray ray{{0, 0, 3}, {0, 0, -1}};
    CHECK(closest_hit(scene, ray)->object == 0);
    scene.spheres.clear();
    CHECK(closest_hit(scene, ray)->object == 0);
    CHECK(closest_hit(scene, ray)->surface == 2);
    scene.planes.clear();
    CHECK(closest_hit(scene, ray)->surface == 3);
    CHECK_FALSE(closest_hit(scene, ray, 2));
    CHECK(closest_hit(scene, ray, 2.0000001));
}

}  // namespace
}  // namespace raya::reference
