// BVH traversal finds the same hits as testing all objects, bit for bit, for rays aimed at silhouettes, edges, rims and
// corners, and for rays along axes.
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "host/accel/bvh.hpp"
#include "host/verify/hits.hpp"
#include "tests/accel/partition_lists.hpp"
#include "tests/accel/single_object_hits.hpp"
#include "tests/thorough.hpp"

namespace raya {
namespace {

const std::vector<std::string> kKernelFormats = {"fp32", "e6m15", "e5m10", "e8m12", "e6m15t"};

// Adds a star-shaped planar polygon of many corners.
void add_star(Scene& scene, SplitMix& random) {
    const Vec3 middle = random_direction(random), normal = random_direction(random);
    const Vec3 u = perpendicular(random, normal), v = normal.cross(u);
    Polygon star;
    const std::uint32_t corners = 5 + below(random, 60);
    for (std::uint32_t i = 0; i < corners; ++i) {
        const double turn = 2 * std::numbers::pi * i / corners, radius = i % 2 ? 0.4 : 1;
        star.vertices.push_back(middle + radius * (std::cos(turn) * u + std::sin(turn) * v));
    }
    scene.polygons.push_back(star);
}

// Returns a scene with `count_per_kind` objects of each kind close together, so that their boxes overlap.
Scene crowded_objects(SplitMix& random, int count_per_kind) {
    Scene scene = empty_scene();
    for (int i = 0; i < count_per_kind; ++i) {
        for (const ObjectKind& kind : object_kinds())
            if (kind.name != "plane") kind.add(scene, random);
        add_star(scene, random);
    }
    return scene;
}

// Returns 16 * `rounds` rays aimed at each object. A quarter of the directions are replaced by an axis direction, and a
// third of the limits by a random limit up to 2 * bounds.reach.
Rays rays_at(SplitMix& random, const Scene& scene, const RayBounds& bounds, int rounds) {
    Rays rays;
    for (const reference::Ray& aimed : aim_at_all(random, scene, bounds, rounds).rays) {
        std::array<float, 3> origin{}, direction{};
        const bool along_axis = below(random, 4) == 0;
        const std::uint32_t axis = below(random, 3);
        for (std::uint32_t a = 0; a < 3; ++a) {
            origin[a] = static_cast<float>(aimed.origin[static_cast<int>(a)]);
            const double d = aimed.direction[static_cast<int>(a)];
            direction[a] = along_axis ? (a == axis ? std::copysign(1.0F, float(d)) : 0.0F) : static_cast<float>(d);
        }
        const double limit = below(random, 3) == 0 ? bounds.reach * random.uniform(0, 2) : kDefaultRayLimit;
        rays.add(origin, direction, static_cast<float>(round_to_format(limit, bounds.format)));
    }
    rays.pad();
    return rays;
}

/// Numbers of rays with a wrong result, of rays with a hit, and of all rays.
struct Tally {
    std::size_t wrong = 0, hits = 0, rays = 0;
};

Tally compare(const TestBuild& test_build, unsigned cases) {
    KernelRunner runner("tests/accel/descent_probe.cl", test_build);
    Tally tally;
    for (unsigned seed = 1; seed <= cases; ++seed) {
        SplitMix random(seed);
        const double scale = random_scale(random, test_build.format);
        const Scene scene = with_random_sizes(crowded_objects(random, 12), random, scale);
        PackedJob job = job_in(scene, test_build.format);
        append_bvh(job, test_build.format);
        const RayBounds bounds{test_build.format, 2.0 * job.header().extent};
        const Rays rays = rays_at(random, scene, bounds, 1);
        const Hits expected = find_hits(runner, "hits_without_accel", job.words(), rays);
        const Hits traversed = find_hits(runner, "hits_with_accel", job.words(), rays);
        const Hits shadow_hits = find_hits(runner, "shadow_hits_with_accel", job.words(), rays);
        for (std::size_t i = 0; i < rays.count(); ++i) {
            const bool hit = expected.objects[i] != kNoObject;
            tally.hits += hit;
            tally.wrong += traversed.objects[i] != expected.objects[i] ||
                           traversed.distances[i] != expected.distances[i] ||
                           (shadow_hits.objects[i] != kNoObject) != hit;
        }
        tally.rays += rays.count();
    }
    return tally;
}

std::vector<std::string> tree_options(bool filter) {
    std::vector<std::string> options = {"-DRAYA_ACCEL=2"};
    if (filter) options.emplace_back("-DRAYA_FILTER=1");
    return options;
}

}  // namespace

TEST_CASE("BVH traversal finds the hits of testing all objects, in every format", "[descent]") {
    for (const std::string& name : quick_of(2, kKernelFormats))
        for (const std::uint32_t lanes : quick(1, {16u, 1u, 4u, 8u})) {
            const NumberFormat format = parse_format(name);
            CAPTURE(name, lanes);
            const Tally tally = compare({lanes, true, format, {}, tree_options(!format.is_fp32())}, quick_cases(4, 40));
            CHECK(tally.wrong == 0);
            CHECK(5 * tally.hits > tally.rays);
        }
}

TEST_CASE("injected faults are detected: boxes without a margin, a missing edge, filters without a bound",
          "[descent]") {
    struct Mutant {
        const char* format;
        SourcePatch patch;
    };
    const std::vector<Mutant> mutants = {
        {"spa22", {"geometry/outline_filter.clh", "5.0f * RAYA_ERROR", "0.1f * RAYA_ERROR"}},
        {"fp32",
         {"bvh/leaves.clh", "edge < edges; edge += RAYA_LANES)\n        crossed",
          "edge + 1 < edges; ++edge)\n        crossed"}},
        {"spa22", {"geometry/sphere_filter.clh", "1.0f + 0x1p-9f + 64.0f * RAYA_ERROR", "1.0f - 0x1p-9f"}},
        {"spa22", {"geometry/sphere_filter.clh", "(as_lanes_int(outside) | ~as_lanes_int(b))", "~as_lanes_int(b)"}},
        {"spa22",
         {"geometry/outline_filter.clh", "(fabs(rising - falling) > error)", "(fabs(rising - falling) > 0.0f)"}},
        {"fp32", {"bvh/boxes.clh", "near <= far;", "near < far * (1.0f - 0x1p-12f);"}}};
    for (const auto& [name, patch] : quick_of(2, mutants)) {
        const NumberFormat format = parse_format(name);
        CAPTURE(name, patch.file, patch.replace);
        CHECK(compare({16, true, format, {patch}, tree_options(!format.is_fp32())}, 4).wrong > 0);
    }
}

}  // namespace raya
