// Compares the hit points, normals, sides (entering or leaving) and colours that kernels compute with those of the
// reference.
#include <fmt/format.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "tests/kernels/agreement.hpp"
#include "tests/kernels/probe.hpp"
#include "tests/kernels/random_scene.hpp"

namespace raya {
namespace {

constexpr std::size_t kPlaceRays = 4'000;

constexpr double kColourLimit = 1e-7;          // error of rounding the scene's colours to fp32
constexpr double kMaxGrazingFraction = 0.002;  // maximum fraction of rays that graze an edge or a checker square's side

RayResult reference_place(const Scene& scene, const reference::Ray& ray) {
    const auto hit = reference::closest_hit(scene, ray);
    if (!hit) return {-1};
    RayResult found{static_cast<double>(hit->object), hit->leaving ? 1.0 : 0.0};
    append(found, hit->point);
    append(found, hit->geometric);
    append(found, hit->shading);
    append(found, hit->colour);
    return found;
}

// Returns an upper bound of the curvature of an object at a point. It is 1 / 0.2 = 5 for spheres, whose radii are at
// least 0.2, and for patches, whose normals turn no faster. It grows towards a cone's apex, where the radius may be 0.
double curvature(const Scene& scene, std::size_t object, const Vec3& point) {
    const std::size_t first_cone = scene.object_count() - scene.cones.size();
    if (object < first_cone) return 5;
    const Cone& cone = scene.cones[object - first_cone];
    const Vec3 along = cone.apex - cone.base;
    const double height_fraction = (point - cone.base).dot(along) / along.length2();  // 0 at the base, 1 at the apex
    const double radius = std::abs(cone.base_radius + height_fraction * (cone.apex_radius - cone.base_radius));
    return std::max(5.0, 1 / radius);
}

// The error of a normal is the error of the hit point times the curvature.
RayResult limits_of(const Scene& scene, std::size_t object, const Vec3& point) {
    const double position_limit = kPlaceLimit * scene_extent(scene);
    RayResult limits{0, 0};
    limits.insert(limits.end(), 3, position_limit);
    limits.insert(limits.end(), 6, position_limit * curvature(scene, object, point));
    limits.insert(limits.end(), 3, kColourLimit);
    return limits;
}

std::size_t check_against_reference(const Scene& scene, const std::vector<reference::Ray>& rays, const ProbedHits& hits,
                                    const ProbedPlaces& places) {
    const std::vector<int> numbers = object_numbers(scene);
    const auto find = [&](const reference::Ray& ray) { return reference_place(scene, ray); };
    Agreement agreement{.shift = kPlaceLimit * scene_extent(scene)};
    std::size_t leaving = 0;
    for (std::size_t i = 0; i < rays.size(); ++i) {
        if (hits.objects[i] == kNoObject) continue;
        const int object = numbers[hits.objects[i]];
        RayResult found{double(object), double(places.leaving[i])};
        for (const auto vector :
             {ProbedPlaces::kPoint, ProbedPlaces::kGeometric, ProbedPlaces::kNormal, ProbedPlaces::kColour})
            append(found, places.vector(i, vector));
        CAPTURE(i, hits.objects[i], hits.distances[i]);
        const RayResult limits =
            limits_of(scene, static_cast<std::size_t>(object), places.vector(i, ProbedPlaces::kPoint));
        CHECK(agreement.accepts(find, rays[i], found, limits));
        leaving += places.leaving[i];
    }
    CHECK(leaving > agreement.rays / 50);  // rays hit both sides of objects
    CHECK(static_cast<double>(agreement.grazing) <= kMaxGrazingFraction * static_cast<double>(agreement.rays));
    return agreement.grazing;
}

// Checks the origins of secondary rays: P+ = P + margin G and P- = P - margin G, each rounded once. The margin is 2^-20
// times the largest coordinate of P or of the scene.
void check_secondary_origins(const Scene& scene, const ProbedHits& hits, const ProbedPlaces& places) {
    const auto extent = static_cast<float>(scene_extent(scene));
    for (std::size_t i = 0; i < hits.objects.size(); ++i) {
        if (hits.objects[i] == kNoObject) continue;
        const Vec3 point = places.vector(i, ProbedPlaces::kPoint), normal = places.vector(i, ProbedPlaces::kGeometric);
        float largest = extent;
        for (int axis = 0; axis < 3; ++axis) largest = std::max(largest, std::abs(static_cast<float>(point[axis])));
        for (int axis = 0; axis < 3; ++axis) {
            const float p = static_cast<float>(point[axis]), g = static_cast<float>(normal[axis]),
                        margin = 0x1p-20F * largest;
            CAPTURE(i, axis);
            CHECK(places.vector(i, ProbedPlaces::kOuter)[axis] == std::fma(g, margin, p));
            CHECK(places.vector(i, ProbedPlaces::kInner)[axis] == std::fma(g, -margin, p));
        }
    }
}

}  // namespace

TEST_CASE("hit points, normals, sides and colours agree with the reference, with the same bits in all builds",
          "[kernels]") {
    const std::vector<reference::Ray> rays = random_rays(41, kPlaceRays);
    const std::vector<float> words = ray_words(rays);
    std::map<std::string, ProbedPlaces> first;
    std::string grazing;
    for (const TestBuild& test_build : test_builds()) {
        KernelRunner runner("tests/kernels/probe.cl", test_build);
        for (std::size_t k = 0; k < object_kinds().size(); ++k) {
            const ObjectKind& kind = object_kinds()[k];
            const std::uint64_t seed = 200 + k;
            CAPTURE(test_build.name(), kind.name, seed);
            const Scene scene = random_scene(kind, seed);
            const std::vector<std::uint32_t> job = job_words(scene);
            const ProbedPlaces places = find_places(runner, job, words);
            const auto [entry, is_first] = first.try_emplace(kind.name, places);
            if (is_first) {
                const ProbedHits hits = closest_hits(runner, job, words);
                grazing += fmt::format(" {} {},", kind.name, check_against_reference(scene, rays, hits, places));
                check_secondary_origins(scene, hits, places);
            }
            CHECK(places.leaving == entry->second.leaving);
            CHECK(bits(places.places) == bits(entry->second.places));
        }
    }
    grazing.pop_back();
    fmt::print(
        "Grazing rays whose hit points, normals or colours are outside the limits, of {} rays per kind of object:{}.\n",
        kPlaceRays, grazing);
}

}  // namespace raya
