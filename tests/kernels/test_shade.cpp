// Compares one step of the kernels' ray tree with the formulas of the reference: direct lighting, reflection,
// refraction, event counts.
#include <fmt/format.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstdint>
#include <map>
#include <optional>
#include <vector>

#include "tests/kernels/agreement.hpp"
#include "tests/kernels/probe.hpp"
#include "tests/kernels/random_scene.hpp"

namespace raya {
namespace {

constexpr std::size_t kShadeRays = 4'000;
constexpr std::uint64_t kSceneSeed = 51, kRaySeed = 52;
constexpr double kWeight = 0.5;  // weight of the rays that probe.cl shades
constexpr std::uint32_t kLastLevel = 8;

// If the normal turns by an angle, the reflected direction turns by twice that angle and the refracted direction by at
// most 1.5 times that angle. The error of the normal is the error of the hit point divided by the radius of curvature,
// which is at least 0.2 except near the tips of cones.
constexpr double kDirectionLimit = 2 * kPlaceLimit * 4 / 0.2;
// A highlight multiplies this error by its exponent, at most 100, and by Ks, ray weight and light intensity, whose
// product is at most 0.1.
constexpr double kSumLimit = 100 * 0.1 * kDirectionLimit;
constexpr double kWeightLimit = 1e-7;
constexpr double kMaxShadesGrazing = 0.01;  // as a fraction of all rays: edges, shadows, cone tips, critical angles

void append_ray(RayResult& found, const ProbedRay& ray) {
    append(found, ray.origin);
    append(found, ray.direction);
    found.push_back(ray.weight);
}

// RayResult holds for a hit: object number; numbers of shadow rays, shadow hits, reflected rays and refracted rays;
// sum; then the reflected ray and the refracted ray, if they were made. For a miss it holds object number and sum.
constexpr std::size_t kIntegers = 5, kSumAt = 5, kRaysAt = 8, kRayNumbers = 7;

RayResult limits_for(const RayResult& found, double extent) {
    RayResult limits(kIntegers, 0);
    limits.insert(limits.end(), 3, kSumLimit);
    for (std::size_t at = kRaysAt; at < found.size(); at += kRayNumbers) {
        limits.insert(limits.end(), 3, kPlaceLimit * extent);
        limits.insert(limits.end(), 3, kDirectionLimit);
        limits.push_back(kWeightLimit);
    }
    return found.size() > kSumAt ? limits : RayResult(found.size(), kWeightLimit);
}

struct DirectLight {
    Colour sum;
    int shadow_rays = 0, shadow_hits = 0;
};

DirectLight reference_light(const Scene& scene, const reference::Hit& hit, const Vec3& start, const Vec3& mirror) {
    const Surface& surface = scene.surfaces[static_cast<std::size_t>(hit.surface)];
    DirectLight lit{ambient_intensity(scene) * surface.diffuse * hit.colour};
    for (const Light& light : scene.lights) {
        const Vec3 arm = light.position - start, to_light = arm.normalized();
        if (hit.shading.dot(to_light) <= 0) continue;
        ++lit.shadow_rays;
        if (reference::closest_hit(scene, {start, to_light}, arm.length())) {
            ++lit.shadow_hits;
            continue;
        }
        const double gloss = surface.specular * std::pow(std::max(0.0, mirror.dot(to_light)), surface.shine);
        const bool shines = surface.specular > 0 && mirror.dot(to_light) > 0;
        lit.sum += light_colour(scene, light) *
                   (surface.diffuse * hit.shading.dot(to_light) * hit.colour + Colour(shines ? gloss : 0.0));
    }
    return lit;
}

RayResult reference_step(const Scene& scene, const reference::Ray& ray) {
    const auto hit = reference::closest_hit(scene, ray);
    RayResult found{hit ? static_cast<double>(hit->object) : -1.0};
    if (!hit) {
        append(found, kWeight * scene.background);
        return found;
    }
    const Surface& surface = scene.surfaces[static_cast<std::size_t>(hit->surface)];
    double largest = scene_extent(scene);
    for (int axis = 0; axis < 3; ++axis) largest = std::max(largest, std::abs(hit->point[axis]));
    const Vec3 margin = 0x1p-20 * largest * hit->geometric;
    const Vec3 mirror = reference::reflected_direction(ray.direction, hit->shading);
    const double e = hit->leaving ? surface.refraction_index : 1 / surface.refraction_index;
    std::optional<Vec3> through;
    if (surface.transmittance > 0) through = reference::refracted_direction(ray.direction, hit->shading, e);
    const double reflectance = surface.specular + (surface.transmittance > 0 && !through ? surface.transmittance : 0);
    const DirectLight lit = reference_light(scene, *hit, hit->point + margin, mirror);
    for (const double number :
         {double(lit.shadow_rays), double(lit.shadow_hits), double(reflectance > 0), double(through.has_value())})
        found.push_back(number);
    append(found, kWeight * lit.sum);
    if (reflectance > 0) append_ray(found, ProbedRay{hit->point + margin, mirror, kWeight * reflectance});
    if (through) append_ray(found, ProbedRay{hit->point - margin, *through, kWeight * surface.transmittance});
    return found;
}

RayResult probed_step(const ProbedSteps& steps, std::size_t ray, int object) {
    RayResult found{static_cast<double>(object)};
    if (object < 0) {
        append(found, steps.sum(ray));
        return found;
    }
    const bool reflected = steps.events(ray, RAYA_REFLECTED) != 0, refracted = steps.events(ray, RAYA_REFRACTED) != 0;
    for (const int kind : {RAYA_SHADOW, RAYA_SHADOW_HITS, RAYA_REFLECTED, RAYA_REFRACTED})
        found.push_back(steps.events(ray, static_cast<std::size_t>(kind)));
    append(found, steps.sum(ray));
    if (reflected) append_ray(found, steps.followed(ray));
    if (refracted) append_ray(found, reflected ? steps.pending(ray) : steps.followed(ray));
    return found;
}

// Returns the number of polygons of the job, in which each triangle of a patch is one polygon.
std::size_t face_count(const Scene& scene) {
    return object_numbers(scene).size() - (scene.object_count() - scene.polygons.size());
}

std::size_t event(int kind) { return static_cast<std::size_t>(kind); }

// Checks the event counts and the state of the ray tree after one step at `level`.
void check_state(const Scene& scene, std::size_t faces, const ProbedSteps& steps, std::size_t ray, bool hit,
                 std::uint32_t level) {
    const bool reflected = steps.events(ray, event(RAYA_REFLECTED)) != 0,
               refracted = steps.events(ray, event(RAYA_REFRACTED)) != 0;
    const std::uint32_t shadow = steps.events(ray, event(RAYA_SHADOW));
    const std::uint32_t lit = shadow - steps.events(ray, event(RAYA_SHADOW_HITS));
    CHECK(steps.active(ray) == (reflected || refracted));
    CHECK(steps.level(ray) == (reflected || refracted ? level + 1 : level));
    CHECK(steps.pending_levels(ray) == (reflected && refracted ? 1u << level : 0u));
    CHECK(steps.events(ray, event(RAYA_PRIMARY)) == 0);
    CHECK(steps.events(ray, event(RAYA_PRIMARY_HITS)) == (hit && level == 0 ? 1u : 0u));
    CHECK(steps.events(ray, event(RAYA_SHADED)) == (hit ? 1u : 0u));
    CHECK(steps.events(ray, event(RAYA_LIT)) == lit);
    CHECK(steps.events(ray, event(RAYA_HIGHLIGHTS)) <= lit);
    CHECK(steps.events(ray, event(RAYA_SPHERE_TESTS)) == (1 + shadow) * scene.spheres.size());
    CHECK(steps.events(ray, event(RAYA_PLANE_TESTS)) == (1 + shadow) * scene.planes.size());
    CHECK(steps.events(ray, event(RAYA_POLYGON_TESTS)) == (1 + shadow) * faces);
    CHECK(steps.events(ray, event(RAYA_CONE_TESTS)) == (1 + shadow) * scene.cones.size());
}

}  // namespace

TEST_CASE("a step of a ray tree agrees with the reference's formulas", "[kernels]") {
    const Scene scene = mixed_scene(kSceneSeed);
    const std::vector<reference::Ray> rays = random_rays(kRaySeed, kShadeRays);
    const std::vector<int> numbers = object_numbers(scene);
    const std::size_t faces = face_count(scene);
    KernelRunner runner("tests/kernels/probe.cl", test_builds().front());
    const ProbedHits hits = closest_hits(runner, job_words(scene), ray_words(rays));
    const ProbedSteps steps = shade_tree_step(runner, job_words(scene), ray_words(rays), 0);
    const auto find = [&](const reference::Ray& ray) { return reference_step(scene, ray); };
    Agreement agreement{.shift = kPlaceLimit * scene_extent(scene)};
    std::size_t reflecting_and_refracting = 0, only_refracting = 0, total_reflections = 0;
    for (std::size_t i = 0; i < kShadeRays; ++i) {
        CAPTURE(kSceneSeed, kRaySeed, i, hits.objects[i]);
        const bool hit = hits.objects[i] != kNoObject;
        const RayResult found = probed_step(steps, i, hit ? numbers[hits.objects[i]] : -1);
        CAPTURE(found);
        CHECK(agreement.accepts(find, rays[i], found, limits_for(found, scene_extent(scene))));
        check_state(scene, faces, steps, i, hit, 0);
        reflecting_and_refracting += steps.pending_levels(i) != 0;
        only_refracting += steps.events(i, event(RAYA_REFRACTED)) && !steps.events(i, event(RAYA_REFLECTED));
        total_reflections += hit && steps.events(i, event(RAYA_REFLECTED)) && steps.followed(i).weight > 0.9 * kWeight;
    }
    fmt::print("Grazing rays that differ from the reference by more than the limits, of {} shaded rays: {}.\n",
               kShadeRays, agreement.grazing);
    CHECK(static_cast<double>(agreement.grazing) <= kMaxShadesGrazing * kShadeRays);
    CHECK(reflecting_and_refracting > kShadeRays / 50);
    CHECK(only_refracting > kShadeRays / 50);
    CHECK(total_reflections > kShadeRays / 50);  // weight factor Ks + T: 0.92 or 0.95
}

TEST_CASE("a step at a deeper level gives the same numbers, and a step at the last level makes no rays", "[kernels]") {
    const Scene scene = mixed_scene(kSceneSeed);
    const std::vector<std::uint32_t> job = job_words(scene);
    const std::vector<float> rays = ray_words(random_rays(kRaySeed, kShadeRays));
    const std::size_t faces = face_count(scene);
    KernelRunner runner("tests/kernels/probe.cl", test_builds().front());
    const ProbedSteps first = shade_tree_step(runner, job, rays, 0), deeper = shade_tree_step(runner, job, rays, 5);
    const ProbedSteps last = shade_tree_step(runner, job, rays, kLastLevel);
    CHECK(bits(deeper.numbers) == bits(first.numbers));
    for (std::size_t i = 0; i < kShadeRays; ++i) {
        CAPTURE(kSceneSeed, kRaySeed, i);
        check_state(scene, faces, deeper, i, first.events(i, event(RAYA_SHADED)) != 0, 5);
        CHECK_FALSE(last.active(i));
        CHECK(last.pending_levels(i) == 0);
        CHECK(last.events(i, event(RAYA_REFLECTED)) + last.events(i, event(RAYA_REFRACTED)) == 0);
        CHECK(last.sum(i) == first.sum(i));
    }
}

TEST_CASE("a step gives the same bits in all builds", "[kernels]") {
    const std::vector<std::uint32_t> job = job_words(mixed_scene(kSceneSeed));
    const std::vector<float> rays = ray_words(random_rays(kRaySeed, kShadeRays));
    std::map<std::uint32_t, ProbedSteps> first;  // [level]: results of the first build
    for (const TestBuild& test_build : test_builds()) {
        KernelRunner runner("tests/kernels/probe.cl", test_build);
        for (const std::uint32_t level : {0u, 5u, kLastLevel}) {
            CAPTURE(test_build.name(), level, kSceneSeed, kRaySeed);
            const ProbedSteps steps = shade_tree_step(runner, job, rays, level);
            const auto entry = first.try_emplace(level, steps).first;
            CHECK(steps.state == entry->second.state);
            CHECK(bits(steps.numbers) == bits(entry->second.numbers));
        }
    }
}

}  // namespace raya
