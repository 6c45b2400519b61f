// Functions that run the kernels of probe.cl on a scene and rays.
#pragma once
#include <array>
#include <bit>
#include <cstdint>
#include <vector>

#include "host/scene/packer.hpp"
#include "host/verify/hits.hpp"
#include "tests/kernels/kernel_runner.hpp"
#include "tests/reference/reference.hpp"

namespace raya {

/// Returns the words of a scene's job. The image size is arbitrary, because probe.cl uses neither camera, image size
/// nor cycles.
inline std::vector<std::uint32_t> job_words(const Scene& scene) {
    JobSettings settings;
    settings.image = {16, 16};
    return pack_job(scene, settings).words();
}

/// Returns, for each object of the job, its object number in the scene. They differ because a patch of more than three
/// corners becomes several polygons of the job.
inline std::vector<int> object_numbers(const Scene& scene) {
    std::vector<int> numbers;
    const std::size_t first_polygon = scene.spheres.size() + scene.planes.size();
    for (std::size_t i = 0; i < scene.object_count(); ++i) {
        const bool polygon = i >= first_polygon && i < first_polygon + scene.polygons.size();
        const bool patch = polygon && !scene.polygons[i - first_polygon].normals.empty();
        numbers.insert(numbers.end(), patch ? scene.polygons[i - first_polygon].vertices.size() - 2 : 1,
                       static_cast<int>(i));
    }
    return numbers;
}

/// The default limit of rays. Kernels return a ray's limit as its distance if the ray hits nothing.
inline constexpr float kFarLimit = 0x1p60F;

/// Returns the rays as an array [ray][7]: origin, direction, limit.
inline std::vector<float> ray_words(const std::vector<reference::Ray>& rays, float limit = kFarLimit) {
    std::vector<float> words;
    for (const reference::Ray& ray : rays) {
        for (int axis = 0; axis < 3; ++axis) words.push_back(static_cast<float>(ray.origin[axis]));
        for (int axis = 0; axis < 3; ++axis) words.push_back(static_cast<float>(ray.direction[axis]));
        words.push_back(limit);
    }
    return words;
}

/// The nearest hits, one per ray.
struct ProbedHits {
    std::vector<std::uint32_t> objects;  // object numbers in the job
    std::vector<float> distances;
};

inline ProbedHits closest_hits(KernelRunner& runner, const std::vector<std::uint32_t>& job,
                               const std::vector<float>& rays) {
    const Hits hits = find_hits(runner, "hits_without_accel", job, Rays{rays});
    ProbedHits probed{hits.objects, {}};
    for (const std::uint32_t bits : hits.distances) probed.distances.push_back(std::bit_cast<float>(bits));
    return probed;
}

struct ProbedPlaces {
    enum Vector : std::size_t { kPoint, kOuter, kInner, kGeometric, kNormal, kColour };
    std::vector<std::uint32_t> leaving;  // [ray]: 1 if the ray leaves the object
    std::vector<float> places;           // [ray][6][3]: as stored by find_places in probe.cl

    Vec3 vector(std::size_t ray, Vector index) const {
        const float* numbers = &places[ray * 18 + index * 3];
        return {numbers[0], numbers[1], numbers[2]};
    }
};

inline ProbedPlaces find_places(KernelRunner& runner, const std::vector<std::uint32_t>& job,
                                const std::vector<float>& rays) {
    const std::size_t count = rays.size() / 7;
    const auto job_buffer = runner.filled("job", job);
    const auto ray_buffer = runner.filled("rays", rays);
    auto leaving = runner.constant<std::uint32_t>("leaving", count, 0);
    auto places = runner.constant<float>("places", count * 18, 0);
    runner.run_rows<const Buffer<std::uint32_t>&, const Buffer<float>&, Buffer<std::uint32_t>&, Buffer<float>&>(
        "find_places", count, job_buffer, ray_buffer, leaving, places);
    return {runner.read(leaving), runner.read(places)};
}

/// Returns the bits of the numbers, for exact comparison.
inline std::vector<std::uint32_t> bits(const std::vector<float>& numbers) {
    std::vector<std::uint32_t> words;
    words.reserve(numbers.size());
    for (const float number : numbers) words.push_back(std::bit_cast<std::uint32_t>(number));
    return words;
}

}  // namespace raya
