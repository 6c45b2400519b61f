// Packs a scene, a view and a mapping into the words that the bus broadcasts and every PE holds (kernels/shared/job.h).
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "host/machine/number_format.hpp"
#include "host/scene/scene.hpp"
#include "kernels/shared/job.h"

namespace raya {

/// Where in a pixel its primary ray goes through (kernels/README.md, Camera).
enum class Sampling { kCentres, kCorners };

/// What a job needs beside its scene. The image is mapping.width x mapping.height pixels.
struct JobSettings {
    raya_mapping mapping{};
    Sampling sampling = Sampling::kCentres;
    std::uint32_t bounces = 8;
    std::array<std::uint32_t, RAYA_EVENTS> cycles{};  // modelled cycles of one event of each kind
    NumberFormat format{};                            // of every number in the job
};

struct PackedJob {
    std::vector<std::uint32_t> words;
    bool has_polygons = false, has_patches = false, has_cones = false;
};

/// Numbers are rounded from double to the format once each. Patches of more than three vertices are cut into triangles,
/// each of which counts as a polygon of its own. Throws UserError for a scene of more than 2^30 words.
PackedJob pack_job(const Scene& scene, const JobSettings& settings);

}  // namespace raya
