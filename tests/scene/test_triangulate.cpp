// Newell's normal, the dropped axis of the projection, and ear clipping of concave, degenerate and self-touching
// outlines.
#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <random>
#include <vector>

#include "host/scene/polygon.hpp"

namespace raya {
namespace {

using Outline = std::vector<Vec3>;

Vec3 corner(const Outline& outline, int i) { return outline[static_cast<std::size_t>(i)]; }

Vec3 doubled_area(const Outline& outline, const std::array<int, 3>& t) {
    return (corner(outline, t[1]) - corner(outline, t[0])).cross(corner(outline, t[2]) - corner(outline, t[0]));
}

/// Checks that an outline of n vertices gives n - 2 triangles that have its orientation and use every vertex. Their
/// areas must add up to the outline's area, so that they cover the outline once.
void check_triangulation(const Outline& outline) {
    const Vec3 normal = newell_normal(outline);
    const auto triangles = triangulate(outline, normal);
    REQUIRE(triangles.size() == outline.size() - 2);
    std::vector<int> used(outline.size(), 0);
    double area = 0;
    for (const auto& t : triangles) {
        const double triangle_area = doubled_area(outline, t).dot(normal.normalized());
        CHECK(triangle_area > 0);
        area += triangle_area;
        for (const int i : t) ++used[static_cast<std::size_t>(i)];
    }
    CHECK(area == Approx(normal.length()).epsilon(1e-12));
    for (const int uses : used) CHECK(uses > 0);
}

/// Returns the outline, moved to a plane whose normal has no zero component.
Outline tilted(const Outline& flat) {
    const Vec3 normal = Vec3(0.3, -0.9, 0.4).normalized();
    const Vec3 u = normal.cross(Vec3(0, 0, 1)).normalized();
    const Vec3 v = normal.cross(u);
    Outline result;
    for (const Vec3& p : flat) result.push_back(Vec3(5, -3, 2) + p.x * u + p.y * v);
    return result;
}

const Outline kU{{0, 0, 0}, {3, 0, 0}, {3, 3, 0}, {2, 3, 0}, {2, 1, 0}, {1, 1, 0}, {1, 3, 0}, {0, 3, 0}};
const Outline kSquareWithMidpoints{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {2, 1, 0}, {2, 2, 0}, {1, 2, 0}, {0, 2, 0}};
const Outline kSquareHole{{0, 0, 0}, {4, 0, 0}, {4, 4, 0}, {0, 4, 0}, {0, 0, 0},
                          {1, 1, 0}, {1, 3, 0}, {3, 3, 0}, {3, 1, 0}, {1, 1, 0}};

TEST_CASE("Newell's normal points to the counter-clockwise side, and its length is twice the area") {
    CHECK(newell_normal({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}) == Vec3(0, 0, 1));
    CHECK(newell_normal({{0, 0, 0}, {0, 1, 0}, {1, 0, 0}}) == Vec3(0, 0, -1));
    CHECK(newell_normal(kU) == Vec3(0, 0, 2 * 7));
    CHECK(newell_normal(kSquareHole) == Vec3(0, 0, 2 * 12));
    CHECK(newell_normal({{0, 0, 0}, {1, 1, 1}, {2, 2, 2}}) == Vec3(0, 0, 0));
    CHECK(newell_normal({{1e9, 0, 0}, {1e9 + 1, 0, 0}, {1e9, 1, 0}}) == Vec3(0, 0, 1));
}

TEST_CASE("clean_outline: vertices on a line have no area, also if rounding far from the origin gives them some") {
    Polygon polygon{{{1e6 + 0.1, 0.1, 0}, {1e6 + 0.2, 0.2, 0}, {1e6 + 0.7, 0.7, 0}}, {}, 0};
    CHECK(newell_normal(polygon.vertices) != Vec3(0));
    CHECK(clean_outline(polygon).fault == OutlineFault::kNoArea);
    polygon.vertices.back().y = 0.7001;
    CHECK(clean_outline(polygon).fault == OutlineFault::kNone);
}

TEST_CASE("the dropped axis is that of the largest component, the first such axis in a tie") {
    CHECK(dropped_axis({1, 0, 0}) == 0);
    CHECK(dropped_axis({0.1, -0.9, 0.5}) == 1);
    CHECK(dropped_axis({0.1, 0.2, -0.3}) == 2);
    CHECK(dropped_axis({1, -1, 1}) == 0);
    CHECK(dropped_axis({0.5, -1, 1}) == 1);
}

TEST_CASE("the triangles of a simple outline cover it once") {
    for (const Outline& flat : {Outline{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, kU, kSquareWithMidpoints, kSquareHole}) {
        CAPTURE(flat.size());
        check_triangulation(flat);
        check_triangulation(Outline(flat.rbegin(), flat.rend()));
        check_triangulation(tilted(flat));
    }
}

TEST_CASE("the triangles of a random star-shaped outline cover it once") {
    constexpr std::uint64_t kSeed = 4;
    std::mt19937_64 random(kSeed);
    const auto uniform = [&] { return static_cast<double>(random() >> 11) * 0x1p-53; };
    for (int run = 0; run < 200; ++run) {
        CAPTURE(kSeed, run);
        const int n = 3 + static_cast<int>(uniform() * 30);
        Outline outline;
        for (int i = 0; i < n; ++i) {
            const double angle = 2 * std::numbers::pi * (i + 0.8 * uniform()) / n;
            const double radius = 0.1 + uniform();
            outline.emplace_back(radius * std::cos(angle), radius * std::sin(angle), 0);
        }
        check_triangulation(outline);
        check_triangulation(tilted(outline));
    }
}

TEST_CASE("triangulate() ends for outlines without area and for self-crossing outlines") {
    CHECK(triangulate({}, {0, 0, 1}).empty());
    CHECK(triangulate({{0, 0, 0}, {1, 0, 0}}, {0, 0, 1}).empty());
    const Outline bow_tie{{0, 0, 0}, {1, 1, 0}, {1, 0, 0}, {0, 1, 0}};
    CHECK(triangulate(bow_tie, {0, 0, 1}).size() == 2);
    CHECK(triangulate({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}}, {0, 0, 1}).size() == 2);
}

}  // namespace
}  // namespace raya
