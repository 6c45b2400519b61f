// A closed mesh of polygons has no cracks: rays aimed at its edges and corners hit it, in every number format.
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "tests/kernels/probe.hpp"
#include "tests/scene/random_below.hpp"
#include "tests/thorough.hpp"

namespace raya {
namespace {

/// Returns a polygon mesh of a sphere of radius 1 around (0.3, -0.2, 0.1): planar quadrangles between circles of
/// latitude, and triangles at the poles. The corners of every third polygon are in reversed order.
Scene ball() {
    constexpr int kMeridians = 24, kLatitudes = 12;
    const auto corner = [](int i, int j) {
        const double latitude = std::numbers::pi * j / kLatitudes,
                     longitude = 2 * std::numbers::pi * (i % kMeridians) / kMeridians;
        return Vec3(0.3, -0.2, 0.1) + Vec3(std::sin(latitude) * std::cos(longitude),
                                           std::sin(latitude) * std::sin(longitude), std::cos(latitude));
    };
    Scene scene;
    scene.name = "ball";
    scene.surfaces = {{}};
    for (int j = 0; j < kLatitudes; ++j)
        for (int i = 0; i < kMeridians; ++i) {
            Polygon face{{corner(i, j), corner(i, j + 1), corner(i + 1, j + 1), corner(i + 1, j)}, {}, 0};
            if (j == 0) face.vertices.pop_back();
            if (j == kLatitudes - 1) face.vertices.erase(face.vertices.begin() + 1);
            if ((i + 2 * j) % 3 == 0) std::reverse(face.vertices.begin(), face.vertices.end());
            scene.polygons.push_back(face);
        }
    return scene;
}

/// Returns rays from outside the mesh to points on its edges that are not near the silhouette. Some of the points are
/// corners. The rays are rounded to the format.
Rays rays_at_edges(const Scene& scene, const NumberFormat& format, unsigned count) {
    SplitMix random(2013);
    const auto rounded = [&](double x) {
        return format.is_fp32() ? static_cast<float>(x) : round_to_format(x, format);
    };
    Rays rays;
    for (unsigned made = 0; made < count;) {
        const Polygon& face = scene.polygons[random_below(random, scene.polygons.size())];
        const std::size_t i = random_below(random, face.vertices.size());
        const double fraction = random_below(random, 4) == 0 ? 0 : random.uniform(0, 1);
        const Vec3 target =
            face.vertices[i] + fraction * (face.vertices[(i + 1) % face.vertices.size()] - face.vertices[i]);
        std::array<float, 3> origin{}, direction{};
        Vec3 exact_origin, exact_direction;
        for (int axis = 0; axis < 3; ++axis) {
            origin[std::size_t(axis)] = rounded(random.uniform(-4, 4));
            exact_origin[axis] = origin[std::size_t(axis)];
        }
        const Vec3 middle(0.3, -0.2, 0.1);
        if ((exact_origin - middle).length() < 1.5) continue;
        for (int axis = 0; axis < 3; ++axis) {
            direction[std::size_t(axis)] = rounded((target - exact_origin).normalized()[axis]);
            exact_direction[axis] = direction[std::size_t(axis)];
        }
        const Vec3 arm = middle - exact_origin;
        if ((arm - arm.dot(exact_direction) * exact_direction).length() > 0.8) continue;
        rays.add(origin, direction, kDefaultRayLimit);
        ++made;
    }
    return rays;
}

std::size_t misses(const TestBuild& test_build, unsigned count) {
    const Scene scene = ball();
    JobSettings settings;
    settings.image = {16, 16};
    settings.format = test_build.format;
    const PackedJob job = pack_job(scene, settings);
    KernelRunner runner("kernels/checks/hits.cl", test_build);
    const Hits hits =
        find_hits(runner, "hits_without_accel", job.words(), rays_at_edges(scene, test_build.format, count));
    return static_cast<std::size_t>(std::count(hits.objects.begin(), hits.objects.end(), kNoObject));
}

}  // namespace

TEST_CASE("rays aimed at the edges of a closed mesh hit it, in every format", "[watertight]") {
    for (const char* name : quick(3, {"fp32", "spa22", "e5m10", "e6m15t", "e8m12", "e8m12t", "e6m10", "e5m6"}))
        for (const std::uint32_t lanes : quick(1, {4u, 16u, 1u})) {
            CAPTURE(name, lanes);
            CHECK(misses({.lanes = lanes, .format = parse_format(name)}, quick_cases(16'384, 262'144)) == 0);
        }
}

TEST_CASE("an edge test that depends on the edge's direction makes cracks", "[watertight]") {
    const SourcePatch fault{"geometry/polygon.clh", "(choose(rises, rising, falling)",
                            "(choose(rises, rising, num_mul(falling, num_const(0.9375f)))"};
    CHECK(misses({.lanes = 4, .format = parse_format("e5m10"), .patches = {fault}}, 16'384) > 0);
}

}  // namespace raya
