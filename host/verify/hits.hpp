// Checks of ray-object intersections with kernels/checks/hits.cl. Known hits are calculated by hand. Hits that the grid
// traversal or the filters find are compared with the hits found by testing all objects.
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "host/cl/kernel_source.hpp"
#include "host/model/number_format.hpp"
#include "host/verify/verdict.hpp"

namespace raya {

inline constexpr std::uint32_t kNoObject = 0xffffffffu;  // equals RAYA_NO_OBJECT of the kernels
inline constexpr float kDefaultRayLimit = 4096;          // maximum t of a ray, beyond all objects of the scenes

/// Rays in the memory layout of the kernels.
struct Rays {
    static constexpr std::size_t kWords = 7;
    std::vector<float> words;  // [ray][kWords]: origin, direction, limit

    std::size_t count() const { return words.size() / kWords; }
    void add(const std::array<float, 3>& origin, const std::array<float, 3>& direction, float limit);
    /// Appends rays of limit 0, which hit nothing, until the number of rays is a multiple of kMaxLanes.
    void pad();
    std::string text(std::size_t ray) const;
};

/// Hits that a kernel has found. Both vectors are indexed by the number of the ray.
struct Hits {
    std::vector<std::uint32_t> objects;    // object number, or kNoObject
    std::vector<std::uint32_t> distances;  // bits of t if the ray hits an object, else bits of its limit

    std::string text(std::size_t ray) const;
};

/// Runs `kernel`, "hits_without_accel" or "hits_with_accel", on the words of a job (scene and accelerator). The number
/// of rays must be a multiple of kMaxLanes.
Hits find_hits(CheckRunner& runner, const std::string& kernel, const std::vector<std::uint32_t>& job, const Rays& rays);

}  // namespace raya
