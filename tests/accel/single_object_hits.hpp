// Finds hits of rays that are aimed at single objects of a scene: each ray is tested only against its object.
#pragma once
#include <cstdint>
#include <vector>

#include "host/scene/packer.hpp"
#include "tests/accel/aimed_rays.hpp"
#include "tests/kernels/kernel_runner.hpp"
#include "tests/kernels/probe.hpp"

namespace raya {

inline PackedJob job_in(const Scene& scene, const NumberFormat& format) {
    JobSettings settings;
    settings.image = {16, 16};
    settings.format = format;
    return pack_job(scene, settings);
}

/// A hit that a kernel has found, with its ray.
struct FoundHit {
    std::uint32_t object;  // object number in the job
    reference::Ray ray;
    double t;
    Vec3 point() const { return ray.origin + t * ray.direction; }
};

/// Rays, and the objects that they are aimed at. Rays 16 i to 16 i + 15 are aimed at objects[i].
struct AimedRays {
    std::vector<std::uint32_t> objects;  // object numbers in the job
    std::vector<reference::Ray> rays;
};

/// Returns 16 * `rounds` rays aimed at each finite object.
inline AimedRays aim_at_all(SplitMix& random, const Scene& scene, const RayBounds& bounds, int rounds) {
    AimedRays aimed;
    const std::vector<int> numbers = object_numbers(scene);
    for (int round = 0; round < rounds; ++round)
        for (std::uint32_t object = 0; object < numbers.size(); ++object) {
            const auto number = static_cast<std::size_t>(numbers[object]);
            if (number >= scene.spheres.size() && number < scene.spheres.size() + scene.planes.size()) continue;
            aimed.objects.push_back(object);
            for (std::size_t i = 0; i < kMaxLanes; ++i)
                aimed.rays.push_back(random_aimed_ray(random, bounds, aim_at(random, scene, number)));
        }
    return aimed;
}

/// Returns the hits of the rays with the objects that they are aimed at.
inline std::vector<FoundHit> single_object_hits(KernelRunner& runner, const PackedJob& job, const AimedRays& aimed) {
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

}  // namespace raya
