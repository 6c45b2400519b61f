#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <set>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "host/error.hpp"
#include "host/scene/generate.hpp"
#include "host/scene/nff.hpp"
#include "host/scene/polygon.hpp"
#include "host/scene/split_mix.hpp"
#include "tests/paths.h"
#include "tests/scene/spd_folder.hpp"

using namespace raya;

namespace {

/// Returns the distance between two spheres; < 0 if they overlap.
double gap(const Sphere& a, const Sphere& b) { return (a.centre - b.centre).length() - a.radius - b.radius; }

using Point = std::tuple<double, double, double>;

Point point(const Vec3& v) { return {v.x, v.y, v.z}; }

std::size_t triangles_of(const Scene& scene) {
    std::size_t triangles = 0;
    for (const Polygon& polygon : scene.polygons) triangles += polygon.vertices.size() - 2;
    return triangles;
}

/// Returns twice the signed area of a triangle as seen from above; > 0 if the triangle is counter-clockwise.
double orientation_of(const Vec3& a, const Vec3& b, const Vec3& c) {
    return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

/// Returns true if edges of the two outlines cross, seen from above.
bool edges_cross(const Polygon& first, const Polygon& second) {
    const auto ends = [](const Polygon& polygon, std::size_t i) {
        return std::pair{polygon.vertices[i], polygon.vertices[(i + 1) % polygon.vertices.size()]};
    };
    for (std::size_t i = 0; i < first.vertices.size(); ++i)
        for (std::size_t j = 0; j < second.vertices.size(); ++j) {
            const auto [a, b] = ends(first, i);
            const auto [c, d] = ends(second, j);
            if (orientation_of(a, b, c) * orientation_of(a, b, d) <= 0 &&
                orientation_of(c, d, a) * orientation_of(c, d, b) <= 0)
                return true;
        }
    return false;
}

Vec3 middle_of(const Polygon& polygon) {
    Vec3 sum(0);
    for (const Vec3& v : polygon.vertices) sum += v;
    return sum / static_cast<double>(polygon.vertices.size());
}

/// Returns the index of the voxel that contains the whole sphere, or -1 if no voxel does.
int voxel_of(const Sphere& sphere, const std::array<int, 3>& voxels) {
    int index = 0;
    for (int axis = 2; axis >= 0; --axis) {
        const int axis_voxels = voxels[static_cast<std::size_t>(axis)];
        const double low = (sphere.centre[axis] - sphere.radius + 1) / 2 * axis_voxels;
        const double high = (sphere.centre[axis] + sphere.radius + 1) / 2 * axis_voxels;
        if (std::floor(low) != std::floor(high) || low < 0 || high > axis_voxels) return -1;
        index = index * axis_voxels + static_cast<int>(low);
    }
    return index;
}

}  // namespace

TEST_CASE("SplitMix64 generates the published numbers", "[generate]") {
    SplitMix random(1234567);
    CHECK(random.next() == 6457827717110365317u);
    CHECK(random.next() == 3203168211198807973u);
}

TEST_CASE("balls: level n has 1 + 9 + ... + 9^n spheres, and every sphere touches its parent", "[generate]") {
    std::size_t expected = 0, power = 1;
    for (int level = 0; level <= 5; ++level, power *= 9) {
        expected += power;
        CHECK(generate_balls(level).spheres.size() == expected);
    }
    const Scene s = generate_balls(2);
    for (std::size_t child = 0; child < 9; ++child) {
        const Sphere& child_sphere = s.spheres[1 + 10 * child];
        CHECK(std::abs(gap(s.spheres[0], child_sphere)) < 1e-8);
        CHECK(child_sphere.radius == Approx(0.5 / 3));
        for (std::size_t i = 1; i <= 9; ++i) CHECK(std::abs(gap(child_sphere, s.spheres[1 + 10 * child + i])) < 1e-8);
    }
}

TEST_CASE("balls: scenes equal those of SPD's files, with spheres in the same order", "[generate]") {
    for (const int level : {2, 4}) {
        const auto path = spd_folder() / ("balls" + std::to_string(level) + ".nff");
        if (!std::filesystem::exists(path)) {
            WARN("file missing, skipped: " << path);
            continue;
        }
        const Scene spd_scene = read_nff(path), generated = generate_balls(level);
        REQUIRE(generated.spheres.size() == spd_scene.spheres.size());
        double max_difference = 0;
        for (std::size_t i = 0; i < generated.spheres.size(); ++i) {
            max_difference =
                std::max(max_difference, (generated.spheres[i].centre - spd_scene.spheres[i].centre).length());
            max_difference =
                std::max(max_difference, std::abs(generated.spheres[i].radius - spd_scene.spheres[i].radius));
        }
        CHECK(max_difference < 1e-5);
        CHECK(generated.view == spd_scene.view);
        CHECK(generated.background == spd_scene.background);
        CHECK(generated.lights == spd_scene.lights);
        CHECK(generated.surfaces == spd_scene.surfaces);
        CHECK(generated.polygons == spd_scene.polygons);
    }
}

TEST_CASE("lattice: size n has (n + 1)^3 spheres, and every cylinder joins two spheres", "[generate]") {
    for (const int size : {1, 2, 3, 7, 12}) {
        CAPTURE(size);
        const Scene s = generate_lattice(size);
        const auto n = static_cast<std::size_t>(size);
        CHECK(s.spheres.size() == (n + 1) * (n + 1) * (n + 1));
        CHECK(s.cones.size() == 3 * n * (n + 1) * (n + 1));
        CHECK(s.surfaces.size() == 4);
        const double distance = 1.0 / size;
        std::set<std::tuple<long, long, long>> middles;  // middles of the cylinders, in half lattice distances
        for (const Cone& c : s.cones) {
            const Vec3 middle = (c.base + c.apex) / 2, axis_vector = c.apex - c.base;
            const Vec3 halves = middle * 2 / distance;
            middles.insert({std::lround(halves.x), std::lround(halves.y), std::lround(halves.z)});
            const int axis = c.surface - 1;  // one surface per axis
            CHECK(axis_vector[axis] == Approx((1 - 0.99 / 4) * distance));
            CHECK(axis_vector.length() == Approx(axis_vector[axis]));
            CHECK(c.base_radius == c.apex_radius);
            CHECK(std::lround(halves[axis]) % 2 == 1);
        }
        CHECK(middles.size() == s.cones.size());
        for (const Sphere& sphere : s.spheres) {
            CHECK(sphere.radius == Approx(distance / 4));
            CHECK((sphere.centre - s.view.from).length() > sphere.radius);
        }
    }
}

TEST_CASE("lattice: the scene equals that of SPD's file, with objects in the same order", "[generate]") {
    const auto path = spd_folder() / "lattice.nff";
    if (!std::filesystem::exists(path)) {
        WARN("file missing, skipped: " << path);
        return;
    }
    const Scene spd_scene = read_nff(path), generated = generate_lattice(12);
    REQUIRE(generated.spheres.size() == spd_scene.spheres.size());
    REQUIRE(generated.cones.size() == spd_scene.cones.size());
    double max_difference = 0;
    const auto compare = [&](const Vec3& a, const Vec3& b) {
        max_difference = std::max(max_difference, (a - b).length());
    };
    for (std::size_t i = 0; i < generated.spheres.size(); ++i) {
        compare(generated.spheres[i].centre, spd_scene.spheres[i].centre);
        compare(Vec3(generated.spheres[i].radius), Vec3(spd_scene.spheres[i].radius));
    }
    for (std::size_t i = 0; i < generated.cones.size(); ++i) {
        compare(generated.cones[i].base, spd_scene.cones[i].base);
        compare(generated.cones[i].apex, spd_scene.cones[i].apex);
        compare({generated.cones[i].base_radius, generated.cones[i].apex_radius, 0},
                {spd_scene.cones[i].base_radius, spd_scene.cones[i].apex_radius, 0});
        REQUIRE(generated.cones[i].surface == spd_scene.cones[i].surface);
    }
    compare(generated.view.from, spd_scene.view.from);
    compare(generated.view.at, spd_scene.view.at);
    CHECK(max_difference < 5e-6);  // the file has six digits
    CHECK(generated.view.up == spd_scene.view.up);
    CHECK(generated.view.angle_degrees == spd_scene.view.angle_degrees);
    CHECK(generated.background == spd_scene.background);
    CHECK(generated.lights == spd_scene.lights);
    CHECK(generated.surfaces == spd_scene.surfaces);
}

TEST_CASE("gears: wheels consist of valid outlines, and size 4 has as many polygons as SPD's gears", "[generate]") {
    for (const int size : {1, 2, 4}) {
        CAPTURE(size);
        const Scene s = generate_gears(size);
        const auto wheels = static_cast<std::size_t>(size * size * size);
        CHECK(s.polygons.size() == 146 * wheels + 1);
        CHECK(triangles_of(s) == 572 * wheels + 2);
        CHECK(std::count_if(s.polygons.begin(), s.polygons.end(),
                            [](const Polygon& p) { return p.vertices.size() == 144; }) == 2 * size * size * size);
        CHECK(s.lights.size() == 5);
        for (Polygon polygon : s.polygons) {
            const Polygon original = polygon;
            REQUIRE(clean_outline(polygon).reason.empty());
            REQUIRE(polygon == original);
        }
    }
    CHECK(generate_gears(4).polygons.size() == 9345);
    CHECK(triangles_of(generate_gears(4)) == 36610);
    CHECK(generate_gears(3).surfaces.size() == 5);
}

TEST_CASE("gears: wheels are closed surfaces whose fronts face outwards", "[generate]") {
    const Scene s = generate_gears(2);
    std::set<std::pair<Point, Point>> edges;
    double volume = 0;
    for (std::size_t i = 1; i < s.polygons.size(); ++i) {  // polygon 0 is the ground
        const std::vector<Vec3>& corners = s.polygons[i].vertices;
        for (std::size_t at = 0; at < corners.size(); ++at)
            REQUIRE(edges.insert({point(corners[at]), point(corners[(at + 1) % corners.size()])}).second);
        volume += corners[0].dot(newell_normal(corners)) / 6;
    }
    for (const auto& [start, end] : edges) REQUIRE(edges.contains({end, start}));
    const double disc_volume = 3.14159265 * 0.5 * 0.5 * 0.4;  // a wheel without teeth: radius 0.5, thickness 0.4
    CHECK(volume == Approx(8 * disc_volume).epsilon(0.05));
}

TEST_CASE("gears: teeth reach into the gaps of neighbouring wheels without touching them", "[generate]") {
    const Scene s = generate_gears(2);
    std::vector<Polygon> layer;  // the upper faces of the lower wheels
    for (std::size_t wheel = 0; wheel < 8; wheel += 2) layer.push_back(s.polygons[1 + 146 * wheel]);
    double outer_radius = 0;  // radius of a wheel, including its teeth
    for (const Vec3& v : layer[0].vertices) outer_radius = std::max(outer_radius, (v - middle_of(layer[0])).length());
    for (std::size_t i = 0; i < layer.size(); ++i)
        for (std::size_t j = 0; j < i; ++j) {
            CAPTURE(i, j);
            CHECK_FALSE(edges_cross(layer[i], layer[j]));
            const Vec3 offset = middle_of(layer[i]) - middle_of(layer[j]);
            CHECK(offset.z == 0);
            if (i + j == 3) continue;  // diagonal neighbours
            double nearest = offset.length();
            for (const Vec3& v : layer[i].vertices) nearest = std::min(nearest, (v - middle_of(layer[j])).length());
            CHECK(nearest < 0.97 * outer_radius);
        }
}

TEST_CASE("uniform: spheres lie inside voxels and do not touch; the voxels' numbers of spheres differ by at most one",
          "[generate]") {
    struct Row {
        int count;
        std::array<int, 3> voxels;
    };
    for (const Row& row : {Row{1, {1, 1, 1}}, Row{64, {4, 4, 4}}, Row{300, {3, 5, 2}}, Row{100, {4, 4, 4}},
                           Row{5, {8, 1, 3}}, Row{700, {64, 1, 1}}}) {
        CAPTURE(row.count, row.voxels[0], row.voxels[1], row.voxels[2]);
        const Scene s = generate_uniform(row.count, row.voxels);
        REQUIRE(s.spheres.size() == static_cast<std::size_t>(row.count));
        const int voxels = row.voxels[0] * row.voxels[1] * row.voxels[2];
        std::vector<int> spheres_in_voxel(static_cast<std::size_t>(voxels));
        std::set<std::tuple<double, double, double>> centres;
        for (const Sphere& sphere : s.spheres) {
            const int voxel = voxel_of(sphere, row.voxels);
            REQUIRE(voxel >= 0);
            ++spheres_in_voxel[static_cast<std::size_t>(voxel)];
            centres.insert({sphere.centre.x, sphere.centre.y, sphere.centre.z});
        }
        CHECK(centres.size() == s.spheres.size());
        for (const int n : spheres_in_voxel) CHECK((n == row.count / voxels || n == (row.count + voxels - 1) / voxels));
        int touching = 0;
        for (std::size_t i = 0; i < s.spheres.size(); ++i)
            for (std::size_t j = 0; j < i; ++j) touching += gap(s.spheres[i], s.spheres[j]) <= 0;
        CHECK(touching == 0);
        for (const Surface& surface : s.surfaces) CHECK((surface.specular == 0 && surface.transmittance == 0));
        CHECK(s.lights.size() == 1);
    }
}

TEST_CASE("random: centres lie in the cube, spheres fill 0.1 to 17 % of it, and the seed determines the scene",
          "[generate]") {
    for (const int count : {1, 30, 1000, 20000}) {
        CAPTURE(count);
        const Scene s = generate_random(count, 7);
        REQUIRE(s.spheres.size() == static_cast<std::size_t>(count));
        double volume = 0;
        bool inside = true;
        for (const Sphere& sphere : s.spheres) {
            for (int axis = 0; axis < 3; ++axis) inside = inside && std::abs(sphere.centre[axis]) <= 1;
            volume += 4.0 / 3 * 3.14159265 * std::pow(sphere.radius, 3);
        }
        CHECK(inside);
        CHECK(volume / 8 > 0.001);
        CHECK(volume / 8 < 0.17);
        CHECK(s == generate_random(count, 7));
        CHECK_FALSE(s.spheres == generate_random(count, 8).spheres);
    }
    CHECK(generate_random(1000, 7).surfaces.size() == 12);
}

TEST_CASE("cluster: seven spheres lie above the floor and almost never touch", "[generate]") {
    const ClusterShape shape;
    int disjoint = 0;
    for (std::uint64_t seed = 1; seed <= 300; ++seed) {
        CAPTURE(seed);
        const Scene s = generate_cluster(seed);
        REQUIRE(s.spheres.size() == 7);
        REQUIRE(s.planes.size() == 1);
        CHECK(generate_cluster(seed) == s);
        if (seed > 1) CHECK_FALSE(generate_cluster(seed - 1).spheres == s.spheres);
        bool touching = false;
        int glass = 0, mirrors = 0;
        for (std::size_t i = 0; i < s.spheres.size(); ++i) {
            const Sphere& sphere = s.spheres[i];
            CHECK(sphere.radius >= shape.min_sphere_radius - 1e-9);
            CHECK(sphere.radius <= shape.max_sphere_radius + 1e-9);
            CHECK(sphere.centre.z >= sphere.radius - 1e-8);
            CHECK(sphere.centre.z <= sphere.radius + shape.height + 1e-8);
            CHECK(std::hypot(sphere.centre.x, sphere.centre.y) <= shape.radius + 1e-8);
            for (std::size_t j = 0; j < i; ++j) touching = touching || gap(sphere, s.spheres[j]) < -1e-8;
            const Surface& surface = s.surfaces[static_cast<std::size_t>(sphere.surface)];
            glass += surface.transmittance > 0;
            mirrors += surface.transmittance == 0 && surface.specular > 0;
        }
        CHECK(glass == shape.glass);
        CHECK(mirrors == shape.mirrors);
        disjoint += !touching;
    }
    CHECK(disjoint >= 297);  // 200 attempts per sphere nearly always find a free position
    ClusterShape no_spheres;
    no_spheres.glass = no_spheres.mirrors = no_spheres.matt = 0;
    CHECK(generate_cluster(1, no_spheres).spheres.empty());
}

TEST_CASE("centre: the committed file is the generator's output", "[generate]") {
    const Scene s = generate_centre();
    CHECK(s.object_count() >= 20);
    CHECK(s.object_count() <= 30);
    CHECK(s.planes.size() == 1);
    CHECK(s.lights.size() <= 2);
    std::ifstream file(RAYA_SOURCE_DIR "/scenes/centre.nff");
    const std::string committed{std::istreambuf_iterator<char>(file), {}};
    CHECK(committed == write_nff(s));
    CHECK(read_nff(RAYA_SOURCE_DIR "/scenes/centre.nff") == s);
}

TEST_CASE("generated scenes are equal after writing and reading", "[generate]") {
    for (const Scene& s : {generate_balls(3), generate_lattice(4), generate_gears(2), generate_uniform(100, {3, 3, 3}),
                           generate_random(100, 1), generate_terrain(100, 1), generate_centre(), generate_cluster(1)})
        CHECK(parse_nff(write_nff(s), s.name) == s);
}

TEST_CASE("generators refuse parameters out of range", "[generate]") {
    CHECK_THROWS_WITH(generate_balls(-1), "balls: level -1: must be 0..6");
    CHECK_THROWS_WITH(generate_balls(7), "balls: level 7: must be 0..6");
    CHECK_THROWS_WITH(generate_lattice(0), "lattice: size 0: must be 1..64");
    CHECK_THROWS_WITH(generate_lattice(65), "lattice: size 65: must be 1..64");
    CHECK_THROWS_WITH(generate_gears(0), "gears: size 0: must be 1..16");
    CHECK_THROWS_WITH(generate_gears(17), "gears: size 17: must be 1..16");
    CHECK_THROWS_WITH(generate_random(0, 1), "random: 0 spheres: must be 1..20000000");
    CHECK_THROWS_WITH(generate_uniform(20000001, {1, 1, 1}), "uniform: 20000001 spheres: must be 1..20000000");
    CHECK_THROWS_WITH(generate_terrain(0, 1), "terrain: 0 triangles: must be 1..20000000");
    CHECK_THROWS_WITH(terrain_ply(20000001, 1), "terrain: 20000001 triangles: must be 1..20000000");
    CHECK_THROWS_WITH(generate_uniform(1, {1, 0, 1}), "uniform: 0 voxels along an axis: must be 1..256");
    CHECK_THROWS_WITH(generate_uniform(1, {1, 1, 257}), "uniform: 257 voxels along an axis: must be 1..256");
    CHECK_THROWS_WITH(generate_uniform(1, {256, 256, 17}), "uniform: 1114112 voxels: at most 1048576");
    CHECK_THROWS_AS(generate_balls(7), UserError);
    CHECK_THROWS_AS(generate_random(-1, 1), UserError);
    CHECK_THROWS_AS(generate_uniform(0, {1, 1, 1}), UserError);
}
