// Rays against objects: hits that can be worked out by hand, the kernels of kernels/checks/hits.cl, and the walk
// through the grid against testing all objects.
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "host/cl/kernel_source.hpp"
#include "host/model/number_format.hpp"
#include "host/scene/packer.hpp"
#include "host/scene/scene.hpp"
#include "host/verify/check_runner.hpp"
#include "host/verify/verdict.hpp"

namespace raya {

inline constexpr std::uint32_t kNoObject = 0xffffffffu;  // RAYA_NO_OBJECT of the kernels
inline constexpr float kUsualLimit = 4096;               // of rays: beyond all of the scenes

struct KnownHit {
    const char* what;
    std::array<float, 3> origin, direction;
    std::uint32_t object;  // number in the job, kNoObject
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

/// Rays for kernels.
struct Rays {
    static constexpr std::size_t kWords = 7;
    std::vector<float> words;  // [ray][kWords]: origin, direction, limit

    std::size_t count() const { return words.size() / kWords; }
    void add(const std::array<float, 3>& origin, const std::array<float, 3>& direction, float limit);
    /// Adds rays of limit 0, which hit nothing, until their number is a multiple of kMostLanes.
    void pad();
    std::string text(std::size_t ray) const;
};

/// What they hit.
struct Hits {
    std::vector<std::uint32_t> objects, distances;  // [ray]: number or kNoObject; bits, the limit of a miss

    std::string text(std::size_t ray) const;
};

/// By `kernel`, hits_of_all or hits_by_search, of a job's words. The number of rays is a multiple of kMostLanes.
Hits find_hits(CheckRunner& runner, const std::string& kernel, const std::vector<std::uint32_t>& job, const Rays& rays);

/// How the kernels are built.
struct HitBuild {
    NumberFormat format;
    std::uint32_t lanes = 1;
    bool filter = false;  // of spheres
    bool grid = true;     // false: without the search by a grid, of which the kernel is the longer part
    KernelSources sources{};

    /// "e6m15 filtered, 16 lanes"
    std::string name() const;
};

class HitRunner : public CheckRunner {
  public:
    HitRunner(Session& session, const HitBuild& build);
    const NumberFormat& format() const { return format_; }
    bool grid() const { return grid_; }

  private:
    NumberFormat format_;
    bool grid_;
};

/// Of the first `count` rays: how many are wrong, with the first of them, of which `what` tells the name; else `done`.
Verdict compare_hits(const Hits& expected, const Hits& got, const Rays& rays, std::size_t count,
                     const std::function<std::string(std::size_t)>& what, const std::string& done);

/// All kernels of the build find the known hits.
Verdict check_known_hits(HitRunner& runner, const KnownScene& known);

/// What the grid finds is what testing all objects finds, on the same device: the walk decides nothing. In a build with
/// the grid, by `rays` rays
/// in each of the scenes of scenes/ that are named; a multiple of kMostLanes.
Verdict check_walk(HitRunner& runner, const std::vector<std::string>& scenes, std::size_t rays);

}  // namespace raya
