// Hits that can be worked out by hand: small scenes in numbers that every format holds exactly, rays along the axes,
// and what they meet.
#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "host/scene/scene.hpp"

namespace raya {

inline constexpr std::uint32_t kNothing = 0xffffffffu;  // RAYA_NO_OBJECT of the kernels
inline constexpr float kUsualLimit = 4096;              // of rays: beyond all of the scenes

struct KnownHit {
    const char* what;
    std::array<float, 3> origin, direction;
    std::uint32_t object;  // number in the job, kNothing
    float t;               // where the ray hits; of a miss without a meaning
    float limit = kUsualLimit;
};

struct KnownScene {
    std::string name;
    Scene scene;
    std::vector<KnownHit> hits;
};

/// Spheres, planes, polygons and patches, cones: hit from outside and from inside, touched, missed, at equal distances.
/// Exact in any format with 12 fraction bits or more.
std::vector<KnownScene> known_scenes();

}  // namespace raya
