// Every hit that a kernel computes, in any format, lies in its object's hit region (host/accel/hit_regions.hpp) and in
// voxels that list the object. The environment variable RAYA_REGISTRATION_CASES sets the number of random scenes per
// kind of object and format.
#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstdlib>
#include <map>

#include "host/accel/hit_regions.hpp"
#include "host/scene/nff.hpp"
#include "tests/accel/partition_lists.hpp"
#include "tests/paths.h"
#include "tests/thorough.hpp"

namespace raya {
namespace {

// A hit that a kernel has found, with its ray.
struct FoundHit {
    std::uint32_t object;  // object number in the job
    reference::Ray ray;
    double t;
    Vec3 point() const { return ray.origin + t * ray.direction; }
};

// Returns the hits of the rays with the objects that they are aimed at.
std::vector<FoundHit> single_object_hits(KernelRunner& runner, const PackedJob& job, const AimedRays& aimed) {
    const auto job_buffer = runner.filled("job", job.words());
    const auto rays = runner.filled("rays", ray_words(aimed.rays));
    const auto objects = runner.filled("objects", aimed.objects);
    auto distances = runner.constant<float>("distances", aimed.rays.size(), 0);
    runner.run_rows<const Buffer<std::uint32_t>&, const Buffer<float>&, const Buffer<std::uint32_t>&, Buffer<float>&>(
        "single_object_hits", aimed.rays.size(), job_buffer, rays, objects, distances);
    const std::vector<float> t = runner.read(distances);
    std::vector<FoundHit> hits;
    for (std::size_t i = 0; i < t.size(); ++i)
        if (t[i] != kFarLimit) hits.push_back({aimed.objects[i / kMaxLanes], aimed.rays[i], t[i]});
    return hits;
}

const std::vector<std::string> kScenes = {"spheres", "planes", "polygons", "cones", "mirrors", "glass"};

std::uint64_t case_count() {
    const char* given = std::getenv("RAYA_REGISTRATION_CASES");
    return given ? std::strtoull(given, nullptr, 10) : 20;
}

// Returns true if at least one voxel lies within `error` of the point and all such voxels list the object.
bool is_listed_near(const Partition& p, const Vec3& point, double error, std::uint32_t object) {
    std::array<std::vector<std::uint32_t>, 3> at;
    for (std::uint32_t axis = 0; axis < 3; ++axis)
        for (std::uint32_t k = 0; k < p.grid.divisions[axis]; ++k) {
            const double x = point[static_cast<int>(axis)];
            if (raya_voxel_plane(p.grid, axis, k) <= x + error && x - error <= raya_voxel_plane(p.grid, axis, k + 1))
                at[axis].push_back(k);
        }
    for (const std::uint32_t z : at[2])
        for (const std::uint32_t y : at[1])
            for (const std::uint32_t x : at[0])
                if (!lists_object(p, raya_voxel(p.grid, x, y, z), object)) return false;
    return !at[0].empty() && !at[1].empty() && !at[2].empty();
}

// The largest share of what the traversal of the BVH allows that a hit needs, of each kind of object.
using NeededShares = std::map<std::uint32_t, double>;

// Checks that a hit at t lies in its object's box, or for a sphere in the sphere in the box, widened by what the
// traversal allows at t.
void check_spread(const HitRegions& regions, std::size_t i, const PackedJob& job, const FoundHit& hit,
                  NeededShares& shares) {
    const std::uint32_t kind = kind_of_object(job.header().objects, regions.number(i));
    const Box box = regions.box(i);
    const Vec3 point = hit.point(), outside = point - box.nearest(point);
    const double allowed = (1.1 * std::abs(hit.ray.direction.length2() - 1) + regions.spread(kind)) * hit.t;
    const double needed = kind == RAYA_SPHERE
                              ? (point - 0.5 * (box.min + box.max)).length() - 0.5 * (box.max.x - box.min.x)
                              : std::max({std::abs(outside.x), std::abs(outside.y), std::abs(outside.z)});
    CAPTURE(hit.object, hit.ray.origin, hit.ray.direction, hit.t, point, box.min, box.max);
    if (needed > allowed) FAIL("a hit lies outside its object's box of the BVH");
    if (regions.spread(kind) > 0) shares[kind] = std::max(shares[kind], needed / allowed);
}

// Checks that hits lie in the regions of their objects and in voxels that list the objects. Returns the number of hits.
// See check_spread() for `shares`.
std::size_t check_hits(KernelRunner& runner, SplitMix& random, const Scene& scene, const NumberFormat& format,
                       int rounds, NeededShares& shares) {
    const PackedJob job = job_in(scene, format);
    const Partition p = partition(job, format, random_divisions(random));
    const double error = half_traversal_error(p.grid), extent = job.header().extent;
    const RayBounds bounds{format, std::min(2 * extent, double{p.grid.reach})};
    const std::vector<FoundHit> hits = single_object_hits(runner, job, aim_at_all(random, scene, bounds, rounds));
    const HitRegions regions(job, format);
    const std::vector<std::uint32_t> numbers = finite_numbers(job);
    for (const FoundHit& hit : hits) {
        const Vec3 point = hit.point();
        const auto i = std::lower_bound(numbers.begin(), numbers.end(), hit.object) - numbers.begin();
        const bool in_region =
            !regions.all_bounded() || regions.region(static_cast<std::size_t>(i)).touches({point, point});
        if (regions.all_bounded()) check_spread(regions, static_cast<std::size_t>(i), job, hit, shares);
        if (in_region && is_listed_near(p, point, error, hit.object)) continue;
        CAPTURE(scene.name, format_name(format), p.grid.divisions, hit.object, hit.ray.origin, hit.ray.direction, hit.t,
                point);
        FAIL((in_region ? "a hit lies in a voxel that does not list its object"
                        : "a hit lies outside its object's region"));
    }
    return hits.size();
}

Scene scene_of(const std::string& name) { return read_nff(RAYA_SOURCE_DIR "/scenes/" + name + ".nff"); }

}  // namespace

TEST_CASE("every hit lies in voxels that list its object") {
    std::size_t hits = 0, cases = 0;
    NeededShares shares;
    const std::vector<std::string> formats = quick_of(4, kFormats);
    for (const std::string& name : formats) {
        const NumberFormat format = parse_format(name);
        KernelRunner runner("tests/accel/hits_probe.cl", {4, true, format});
        for (const ObjectKind& kind : object_kinds())
            for (std::uint64_t seed = 0; seed < case_count() && kind.name != "plane"; ++seed, ++cases) {
                SplitMix random(seed);
                CAPTURE(kind.name, seed);
                const double scale = random_scale(random, format);
                hits += check_hits(runner, random, with_random_sizes(random_scene(kind, seed, 8), random, scale),
                                   format, 2, shares);
            }
        for (const std::string& scene : kScenes) {
            SplitMix random(1);
            hits += check_hits(runner, random, scene_of(scene), format, 1, shares);
        }
    }
    CHECK(cases == formats.size() * 7 * case_count());  // 7 kinds of finite objects
    CHECK(hits > 80 * cases);
    CHECK(shares[RAYA_SPHERE] > 0.3);
    CHECK(shares[RAYA_POLYGON] > 0.3);
}

// The ray is nearly parallel to a cylinder, at a distance of half a unit. In the quadratic, b is 0 and a c is so small
// that it is flushed to 0.
TEST_CASE("a ray does not hit a cone if rounding flushes the discriminant to 0") {
    const NumberFormat format = parse_format("e6m15");
    KernelRunner runner("tests/accel/hits_probe.cl", {4, true, format});
    Scene scene = empty_scene();
    scene.cones = {{{0, 0, 0}, 0.125, {1, 0, 0}, 0.125, 0}};
    AimedRays rays;
    rays.objects = {0};
    for (int i = 0; i < 8; ++i) {
        rays.rays.push_back({{-1, -std::ldexp(1.0, -14), 0.5}, {1, std::ldexp(1.0, -14), 0}});
        rays.rays.push_back({{0.5, 2, 0}, {0, -1, 0}});
    }
    const std::vector<FoundHit> hits = single_object_hits(runner, job_in(scene, format), rays);
    CHECK(hits.size() == 8);
    for (const FoundHit& hit : hits) CHECK(hit.t == 2 - 0.125);
}

}  // namespace raya
