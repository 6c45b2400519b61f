// A grid and a BVH find the same hits as testing all objects, bit for bit, for rays aimed at silhouettes, edges, rims
// and corners, for rays along axes, and for rays from beyond the reach.
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "host/accel/bvh.hpp"
#include "host/verify/hits.hpp"
#include "tests/accel/partition_lists.hpp"
#include "tests/thorough.hpp"

namespace raya {
namespace {

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

// Returns 16 rays aimed at each object. A quarter of the directions are replaced by an axis direction, an eighth of the
// origins are moved back by up to 8 times the reach, and a third of the limits are random, up to 2 * bounds.reach.
Rays rays_at(SplitMix& random, const Scene& scene, const RayBounds& bounds) {
    Rays rays;
    for (const reference::Ray& aimed : aim_at_all(random, scene, bounds, 1).rays) {
        const Vec3 direction = below(random, 4) == 0 ? axis_direction(random) : aimed.direction;
        const double back = below(random, 8) == 0 ? bounds.reach * std::exp2(random.uniform(0, 3)) : 0;
        const Vec3 origin = bounds.rounded(aimed.origin - back * direction);
        const double limit = below(random, 3) == 0 ? bounds.reach * random.uniform(0, 2) : kDefaultRayLimit;
        const auto floats = [](const Vec3& v) { return std::array{float(v.x), float(v.y), float(v.z)}; };
        rays.add(floats(origin), floats(direction), round_to_format(limit, bounds.format));
    }
    rays.pad();
    return rays;
}

void check_hits(std::uint32_t lanes, const NumberFormat& format, AccelKind kind) {
    std::vector<std::string> options = {fmt::format("-DRAYA_ACCEL={}", static_cast<std::uint32_t>(kind))};
    if (!format.is_fp32()) options.emplace_back("-DRAYA_FILTER=1");
    KernelRunner runner("tests/accel/search_probe.cl", {lanes, true, format, {}, options});
    std::size_t all_hits = 0, all_rays = 0;
    for (unsigned seed = 1; seed <= quick_cases(6, 40); ++seed) {
        SplitMix random(seed);
        const double scale = random_scale(random, format);
        const Scene scene = with_random_sizes(crowded_objects(random, 12), random, scale);
        PackedJob job = job_in(scene, format);
        Accel accel{kind};
        if (seed % 2 == 0) accel.divisions = random_divisions(random);
        kind == AccelKind::kBvh ? append_bvh(job, format) : append_grid(job, accel_partition(job, format, accel));
        const Rays rays = rays_at(random, scene, {format, 2.0 * job.header().extent});
        const Hits expected = find_hits(runner, "hits_without_accel", job.words(), rays);
        const Hits found = find_hits(runner, "hits_with_accel", job.words(), rays);
        const Hits shadow_hits = find_hits(runner, "shadow_hits_with_accel", job.words(), rays);
        for (std::size_t i = 0; i < rays.count(); ++i) {
            const bool is_hit = expected.objects[i] != kNoObject;
            all_hits += is_hit;
            if (found.objects[i] == expected.objects[i] && found.distances[i] == expected.distances[i] &&
                (shadow_hits.objects[i] != kNoObject) == is_hit)
                continue;
            CAPTURE(seed, rays.text(i), expected.text(i), found.text(i), shadow_hits.text(i));
            FAIL("the search finds another hit");
        }
        all_rays += rays.count();
    }
    CHECK(5 * all_hits > all_rays);
}

}  // namespace

TEST_CASE("a search in a grid or BVH finds the hits of testing all objects, in every format", "[search]") {
    for (const char* name : quick(2, {"fp32", "e6m15", "e5m10", "e8m12", "e6m15t"}))
        for (const std::uint32_t lanes : quick(1, {4u, 16u, 1u, 8u}))
            for (const AccelKind kind : {AccelKind::kGrid, AccelKind::kBvh}) {
                CAPTURE(name, lanes, accel_text({kind}));
                check_hits(lanes, parse_format(name), kind);
            }
}

}  // namespace raya
