// Compares the nearest hits that kernels find with those of the reference, for every kind of object and every build of
// the kernels.
#include <fmt/format.h>

#include <catch2/catch.hpp>
#include <cmath>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "tests/kernels/probe.hpp"
#include "tests/kernels/random_scene.hpp"

namespace raya {
namespace {

constexpr std::size_t kRays = 10'000;

// The rounding error of a coordinate is at most 2^-25 of the scene's extent, 3e-8, and the computation of a hit rounds
// about thirty times: 9e-7 in all.
constexpr double kDistanceLimit = 1e-6;  // relative to the scene's extent

// The maximum fraction of rays that may exceed kDistanceLimit because they graze an edge or an outline. A band of 1e-6
// of the extent around the outlines of twenty objects covers about 1e-4 of the view.
constexpr double kMaxGrazing = 0.001;

/// Compares rays and counts them. A hit may differ from the reference by more than the limit only if moving the ray
/// sideways by the limit changes the reference's hit as much: such a ray grazes an edge or an outline, or the distance
/// of its hit is ill-conditioned.
struct Agreement {
    const Scene& scene;
    double limit;             // of the distance's error and of the shifts, scene units
    std::size_t grazing = 0;  // number of rays whose hits differ by more than the limit

    /// `object`: number of the hit object, -1 for a miss.
    bool accepts(const reference::Ray& ray, int object, double distance) {
        const auto [expected_object, expected] = reference_hit(ray);
        const bool same_object = object == expected_object;
        if (same_object && (object < 0 || std::abs(distance - expected) <= limit)) return true;
        ++grazing;
        const Vec3 axis = std::abs(ray.direction.x) < 0.5 ? Vec3(1, 0, 0) : Vec3(0, 1, 0);
        const Vec3 u = ray.direction.cross(axis).normalized(), v = ray.direction.cross(u);
        double spread = 0;
        for (const double du : {-limit, 0.0, limit})
            for (const double dv : {-limit, 0.0, limit}) {
                const auto [moved_object, moved] = reference_hit({ray.origin + du * u + dv * v, ray.direction});
                if (moved_object != expected_object) return true;
                spread = std::max(spread, std::abs(moved - expected));
            }
        return same_object && std::abs(distance - expected) <= limit + spread;
    }

  private:
    std::pair<int, double> reference_hit(const reference::Ray& ray) const {
        const auto hit = reference::closest_hit(scene, ray);
        return hit ? std::pair(static_cast<int>(hit->object), hit->t) : std::pair(-1, 0.0);
    }
};

std::size_t check_against_reference(const Scene& scene, const std::vector<reference::Ray>& rays,
                                    const ProbedHits& hits) {
    const std::vector<int> numbers = object_numbers(scene);
    Agreement agreement{scene, kDistanceLimit * scene_extent(scene)};
    std::size_t hit_count = 0;
    for (std::size_t i = 0; i < rays.size(); ++i) {
        CAPTURE(i, hits.objects[i], hits.distances[i]);
        const bool hit = hits.objects[i] != kNoObject;
        hit_count += hit;
        if (hit) REQUIRE(hits.objects[i] < numbers.size());
        if (!hit) REQUIRE(hits.distances[i] == kFarLimit);
        CHECK(agreement.accepts(rays[i], hit ? numbers[hits.objects[i]] : -1, hits.distances[i]));
    }
    CHECK(hit_count > kRays / 10);
    CHECK(static_cast<double>(agreement.grazing) <= kMaxGrazing * kRays);
    return agreement.grazing;
}

}  // namespace

TEST_CASE("closest hits agree with the reference, with the same bits in all builds", "[kernels]") {
    const std::vector<reference::Ray> rays = random_rays(11, kRays);
    const std::vector<float> words = ray_words(rays);
    std::map<std::string, ProbedHits> first;
    std::string grazing;  // number of grazing rays for each kind of object
    for (const TestBuild& test_build : test_builds()) {
        KernelRunner runner("tests/kernels/probe.cl", test_build);
        for (std::size_t k = 0; k < object_kinds().size(); ++k) {
            const ObjectKind& kind = object_kinds()[k];
            const std::uint64_t seed = 100 + k;
            CAPTURE(test_build.name(), kind.name, seed);
            const Scene scene = random_scene(kind, seed);
            const ProbedHits hits = closest_hits(runner, job_words(scene), words);
            const auto [entry, is_first] = first.try_emplace(kind.name, hits);
            if (is_first) grazing += fmt::format(" {} {},", kind.name, check_against_reference(scene, rays, hits));
            CHECK(hits.objects == entry->second.objects);
            CHECK(bits(hits.distances) == bits(entry->second.distances));
        }
    }
    grazing.pop_back();
    fmt::print(
        "Grazing rays that differ from the reference by more than the limit, of {} rays per kind of object:{}.\n",
        kRays, grazing);
}

TEST_CASE("on a tie the lowest object number wins", "[kernels]") {
    constexpr std::uint64_t kSeed = 21;
    const Scene single_scene = mixed_scene(kSeed);
    Scene double_scene = empty_scene();  // every object occurs twice, with consecutive numbers
    const auto double_objects = [](const auto& objects, auto& doubled) {
        for (const auto& object : objects) doubled.insert(doubled.end(), 2, object);
    };
    double_objects(single_scene.spheres, double_scene.spheres);
    double_objects(single_scene.planes, double_scene.planes);
    double_objects(single_scene.polygons, double_scene.polygons);
    double_objects(single_scene.cones, double_scene.cones);
    const std::vector<float> rays = ray_words(random_rays(22, 1600));
    const std::vector<int> single_numbers = object_numbers(single_scene), numbers = object_numbers(double_scene);
    for (const std::uint32_t lanes : {1u, 4u}) {
        KernelRunner runner("tests/kernels/probe.cl", {lanes, true});
        const ProbedHits expected = closest_hits(runner, job_words(single_scene), rays);
        const ProbedHits hits = closest_hits(runner, job_words(double_scene), rays);
        CHECK(bits(hits.distances) == bits(expected.distances));
        for (std::size_t i = 0; i < hits.objects.size(); ++i) {
            CAPTURE(kSeed, lanes, i);
            REQUIRE((hits.objects[i] == kNoObject) == (expected.objects[i] == kNoObject));
            if (hits.objects[i] != kNoObject)
                CHECK(numbers[hits.objects[i]] == 2 * single_numbers[expected.objects[i]]);
        }
    }
}

TEST_CASE("a hit counts only if it is nearer than the ray's limit", "[kernels]") {
    constexpr std::uint64_t kSeed = 31;
    const std::vector<std::uint32_t> job = job_words(mixed_scene(kSeed));
    std::vector<float> rays = ray_words(random_rays(32, 1600));
    for (const std::uint32_t lanes : {1u, 4u}) {
        KernelRunner runner("tests/kernels/probe.cl", {lanes, true});
        const ProbedHits hits = closest_hits(runner, job, rays);
        std::vector<float> up_to_hit = rays, beyond_hit = rays;
        for (std::size_t i = 0; i < hits.distances.size(); ++i) {
            up_to_hit[7 * i + 6] = hits.distances[i];
            beyond_hit[7 * i + 6] = std::nextafter(hits.distances[i], kFarLimit);
        }
        CAPTURE(kSeed, lanes);
        CHECK(closest_hits(runner, job, beyond_hit).objects == hits.objects);
        const ProbedHits stopped = closest_hits(runner, job, up_to_hit);
        CHECK(stopped.objects == std::vector<std::uint32_t>(hits.objects.size(), kNoObject));
        CHECK(bits(stopped.distances) == bits(hits.distances));
        const ProbedHits zero_limit = closest_hits(runner, job, ray_words(random_rays(32, 1600), 0));
        CHECK(zero_limit.objects == stopped.objects);
    }
}

}  // namespace raya
