// The partition registers each object in all voxels in which a kernel can find a hit of the object, and in few others.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstring>
#include <functional>
#include <set>

#include "host/accel/hit_regions.hpp"
#include "host/accel/partition.hpp"
#include "host/error.hpp"
#include "tests/accel/partition_lists.hpp"

namespace raya {
namespace {

// Returns a scene with spheres at two opposite corners of a cube, so that objects added between them do not change the
// grid's box.
Scene cornered_scene() {
    Scene scene = empty_scene();
    scene.view.from = Vec3(1);
    scene.spheres = {{Vec3(-1), 1e-3, 0}, {Vec3(1), 1e-3, 0}};
    return scene;
}

// Returns the number of voxels that intersect the surface of a sphere.
std::size_t touched_voxels(const raya_grid& g, const Sphere& s) {
    std::size_t touched = 0;
    for (std::uint32_t v = 0; v < raya_voxels(g); ++v) {
        const std::array<std::uint32_t, 3> at = {v % g.divisions[0], v / g.divisions[0] % g.divisions[1],
                                                 v / g.divisions[0] / g.divisions[1]};
        double near = 0, far = 0;
        for (std::uint32_t axis = 0; axis < 3; ++axis) {
            const double low = raya_voxel_plane(g, axis, at[axis]) - s.centre[static_cast<int>(axis)];
            const double high = raya_voxel_plane(g, axis, at[axis] + 1) - s.centre[static_cast<int>(axis)];
            near += low > 0 || high < 0 ? std::min(low * low, high * high) : 0;
            far += std::max(low * low, high * high);
        }
        touched += near <= s.radius * s.radius && s.radius * s.radius <= far;
    }
    return touched;
}

}  // namespace

TEST_CASE("lists are ascending and hold the finite objects that are not separate; the job holds the same lists") {
    for (std::uint64_t seed = 0; seed < 150; ++seed) {
        SplitMix random(seed);
        const NumberFormat format = parse_format(kFormats[seed % kFormats.size()]);
        PackedJob job = job_in(with_random_sizes(mixed_scene(seed), random, random_scale(random, format)), format);
        std::vector<std::uint32_t> listed, separate;
        for (const std::uint32_t number : finite_numbers(job))
            (below(random, 5) == 0 ? separate : listed).push_back(number);
        const Divisions divisions = random_divisions(random);
        const Partition p = partition(job, format, divisions, separate);
        CAPTURE(seed, format_name(format), divisions);
        REQUIRE(p.starts.size() == divisions[0] * divisions[1] * divisions[2] + 1);
        REQUIRE(p.starts.front() == 0);
        REQUIRE(p.starts.back() == p.objects.size());
        for (std::size_t v = 0; v + 1 < p.starts.size(); ++v)
            REQUIRE(std::is_sorted(p.objects.begin() + p.starts[v], p.objects.begin() + p.starts[v + 1],
                                   std::less_equal<>()));
        const std::set<std::uint32_t> all(p.objects.begin(), p.objects.end());
        REQUIRE(std::vector(all.begin(), all.end()) == listed);
        REQUIRE(p.copies() == p.objects.size() - listed.size());
        const HitRegions regions(job, format, 2, separate);
        for (std::uint32_t axis = 0; axis < 3; ++axis) {
            const double low = raya_voxel_plane(p.grid, axis, 0), error = half_traversal_error(p.grid);
            const double high = raya_voxel_plane(p.grid, axis, divisions[axis]);
            REQUIRE(low < high);
            for (std::size_t i = 0; i < regions.size() && regions.all_bounded(); ++i) {
                const Box box = regions.region(i).box;
                REQUIRE(low + error < box.min[static_cast<int>(axis)]);
                REQUIRE(high - error > box.max[static_cast<int>(axis)]);
            }
        }
        const std::vector<std::uint32_t> before = job.words();
        const AccelSummary summary = append_grid(job, p);
        const auto grid = record_at<raya_grid_words>(job.words(), job.header().accel_at);
        const auto words_at = [&](std::uint32_t at, std::size_t count) {
            const auto first = job.words().begin() + at;
            return std::vector<std::uint32_t>(first, first + static_cast<std::ptrdiff_t>(count));
        };
        REQUIRE(words_at(grid.starts_at, p.starts.size()) == p.starts);
        REQUIRE(words_at(grid.lists_at, p.objects.size()) == p.objects);
        REQUIRE(words_at(grid.separate_at, grid.separate) == separate);
        REQUIRE(std::memcmp(&grid.grid, &p.grid, sizeof p.grid) == 0);
        REQUIRE(job.words().size() - before.size() == summary.words);
        raya_job header_without_grid = job.header();
        header_without_grid.accel_at = 0;
        job.set_header(header_without_grid);
        REQUIRE(std::equal(before.begin(), before.end(), job.words().begin()));
    }
}

TEST_CASE("spheres are registered in the voxels of their surfaces and in few others") {
    for (std::uint64_t seed = 0; seed < 20; ++seed) {
        SplitMix random(seed);
        Scene scene = cornered_scene();
        for (int i = 0; i < 10; ++i) scene.spheres.push_back({random_point(random, 0.5), random.uniform(0.01, 0.5), 0});
        const Partition p = partition_of(scene, "fp32", {12, 12, 12});
        const Partition coarse = partition_of(scene, "e6m15", {12, 12, 12});
        std::size_t touched = 0;
        for (const Sphere& s : scene.spheres) touched += touched_voxels(p.grid, s);
        CAPTURE(seed, touched);
        CHECK(p.objects.size() >= touched);
        CHECK(double(p.objects.size()) <= 1.01 * double(touched));
        CHECK(double(coarse.objects.size()) <= 1.5 * double(touched));
    }
}

TEST_CASE("large slanted objects are registered only near their surfaces") {
    constexpr double kSide = 16;
    Scene scene = cornered_scene();
    scene.polygons = {{{{-1, -1, -1}, {1, -1, 0.5}, {1, 1, 1}, {-1, 1, -0.5}}, {}, 0}};
    scene.cones = {{{-0.9, -0.9, -0.9}, 0.01, {0.9, 0.9, 0.9}, 0.01, 0}};
    const Partition p = partition_of(scene, "fp32", {16, 16, 16});
    CHECK(double(std::ranges::count(p.objects, 2u)) < 2.5 * kSide * kSide);
    CHECK(double(std::ranges::count(p.objects, 3u)) < 14 * kSide);
}

TEST_CASE("a scene without finite objects has a box with side 1; the sides of a flat scene's box are above 0") {
    Scene scene = empty_scene();
    scene.planes = {{{0, 0, 1}, 1, 0}};
    const Partition empty = partition_of(scene, "fp32", {2, 3, 4});
    CHECK(empty.objects.empty());
    CHECK(empty.copies() == 0);
    for (std::uint32_t axis = 0; axis < 3; ++axis) {
        CHECK(raya_voxel_plane(empty.grid, axis, 0) == -0.5F);
        CHECK(raya_voxel_plane(empty.grid, axis, empty.grid.divisions[axis]) == Approx(0.5F));
    }
    scene.polygons = {{{{0, 0, 2}, {1, 0, 2}, {0, 1, 2}}, {}, 0}};
    for (const float cell : partition_of(scene, "fp32", {3, 3, 3}).grid.cell) CHECK(cell > 0);
}

TEST_CASE("if no error bound is known, every object is in every list") {
    Scene coarse = mixed_scene(1), huge = random_scene(object_kinds()[0], 2), steep = mixed_scene(3);
    huge.spheres[0].centre.x = 100;
    steep.cones.push_back({{0, 0, 0}, 1, {0, 0, 0.01}, 0, 0});
    const std::vector<std::pair<Scene, std::string>> cases = {
        {coarse, "e8m9"}, {coarse, "e5m6t"}, {huge, "e5m10"}, {steep, "e6m15"}};
    for (const auto& [scene, format] : cases) {
        const PackedJob job = job_in(scene, parse_format(format));
        const Partition p = partition(job, parse_format(format), {3, 4, 5});
        CAPTURE(format);
        CHECK(p.objects.size() == 60 * finite_numbers(job).size());
        CHECK(p.grid.reach == (format[1] == '5' ? 0x1p7F : format[1] == '6' ? 0x1p15F : 0x1p60F));
        for (std::uint32_t axis = 0; axis < 3; ++axis) {
            CHECK(raya_voxel_plane(p.grid, axis, 0) <= -2 * p.grid.reach);
            CHECK(raya_voxel_plane(p.grid, axis, p.grid.divisions[axis]) >= 2 * p.grid.reach);
        }
    }
    CHECK(partition_of(coarse, "e5m10", {3, 4, 5}).grid.reach < 0x1p6F);
    CHECK(divisions_for(job_in(coarse, parse_format("e8m9")), parse_format("e8m9"), 1000) == Divisions{1, 1, 1});
}

TEST_CASE("the reach is twice the scene's extent; with planes it is as large as the voxel size allows") {
    Scene scene = mixed_scene(1);
    REQUIRE(!scene.planes.empty());
    for (const std::string format : {"fp32", "e6m15", "e8m12"}) {
        CAPTURE(format);
        const double extent = job_in(scene, parse_format(format)).header().extent;
        const double reach_ratio = partition_of(scene, format, {2, 2, 2}).grid.reach / extent;
        CHECK(reach_ratio == std::exp2(std::round(std::log2(reach_ratio))));
        CHECK(reach_ratio >= (format == "fp32" ? 4 : 2));
        CHECK(reach_ratio <= 1024);
        CHECK(partition_of(scene, format, {200, 200, 200}).grid.reach / extent <= reach_ratio);
    }
    CHECK(partition_of(scene, "e6m15", {2, 2, 2}).grid.reach < partition_of(scene, "fp32", {2, 2, 2}).grid.reach);
    scene.planes.clear();
    for (const std::string format : {"fp32", "e6m15", "e8m12"})
        CHECK(partition_of(scene, format, {2, 2, 2}).grid.reach ==
              2 * job_in(scene, parse_format(format)).header().extent);
}

TEST_CASE("illegal divisions are refused") {
    const Scene scene = mixed_scene(1);
    using Catch::Contains;
    CHECK_THROWS_WITH(partition_of(scene, "fp32", {0, 1, 1}), Contains("0x1x1 voxels"));
    for (const Divisions& large : {Divisions{257, 256, 256}, {0xffffffffu, 0xffffffffu, 2}, {1u << 31, 2, 1}})
        CHECK_THROWS_WITH(partition_of(scene, "fp32", large), Contains("at most 16777216"));
    CHECK_THROWS_WITH(partition_of(random_scene(object_kinds()[0], 1, 1025), "e5m6", {1024, 1024, 1}),
                      Contains("fewer voxels"));
    CHECK(partition_of(scene, "fp32", {1, 1u << 20, 1}).starts.size() == (1u << 20) + 1);
}

TEST_CASE("an acceleration grid has about the requested number of voxels, which are nearly cubes") {
    for (std::uint64_t seed = 0; seed < 300; ++seed) {
        SplitMix random(seed);
        Scene scene = cornered_scene();
        for (int axis = 0; axis < 3; ++axis) scene.spheres[1].centre[axis] = -1 + std::exp2(random.uniform(-6, 6));
        const NumberFormat format{};
        const PackedJob job = job_in(scene, format);
        const double requested = std::exp2(random.uniform(0, 24));
        const Divisions d = divisions_for(job, format, static_cast<std::uint64_t>(requested));
        const raya_grid grid = partition(job, format, d).grid;
        CAPTURE(seed, requested, d, grid.cell);
        const double voxels = double(d[0]) * d[1] * d[2];
        REQUIRE(voxels <= requested * 1.0001);
        REQUIRE(voxels >= requested / 3);
        for (std::size_t a = 0; a < 3; ++a)
            for (std::size_t b = 0; b < 3; ++b)
                if (d[a] > 1 && d[b] > 1) REQUIRE(grid.cell[a] < 2.5F * grid.cell[b]);
    }
    const PackedJob job = job_in(cornered_scene(), {});
    CHECK(divisions_for(job, {}, 1000) == Divisions{10, 10, 10});
    CHECK(divisions_for(job, {}, 1) == Divisions{1, 1, 1});
    CHECK(divisions_for(job, {}, 0) == Divisions{1, 1, 1});
    CHECK(divisions_for(job, {}, std::uint64_t{1} << 40) == Divisions{256, 256, 256});
}

TEST_CASE("an acceleration grid has fewer voxels if rounding would spread each object over many voxels") {
    Scene scene = cornered_scene();
    SplitMix random(1);
    for (int i = 0; i < 20000; ++i) scene.spheres.push_back({random_point(random, 1), 0.02, 0});
    for (const char* name : {"fp32", "e6m15", "e5m10", "e6m10t"}) {
        const NumberFormat format = parse_format(name);
        const PackedJob job = job_in(scene, format);
        const Divisions d = divisions_for(job, format, 20000);
        CAPTURE(name, d);
        CHECK((d[0] * d[1] * d[2] > 18000) == (format.fraction_bits > 10));
        CHECK(partition(job, format, d).objects.size() < 16 * scene.spheres.size());
    }
}

}  // namespace raya
