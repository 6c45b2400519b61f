// One scene rendered on one machine in every way of finding a ray's nearest hit, in turns: what the study of
// accelerators counts and times.
#pragma once
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "host/cl/commands.hpp"
#include "host/model/machine.hpp"
#include "host/report/render_report.hpp"
#include "host/scene/scene.hpp"
#include "host/study/measured.hpp"

namespace raya {

/// The ways: every ray against all objects, a grid, a tree of boxes; and another ray tracer.
inline constexpr const char *kNoAccel = "none", *kGridWay = "grid", *kBvhWay = "bvh", *kEmbreeWay = "Embree";

struct AccelSettings {
    std::uint32_t side = 256;  // of the image, pixels
    std::uint32_t bounces = 4;
    int rounds = 5;          // turns of all ways
    double bearable_s = 30;  // a render that would take longer without an accelerator is left out
    double enough_s = 10;    // of samples of one way: no further turn for it
};

/// A scene, made when its turn comes.
struct AccelScene {
    std::string series;  // the kind of scene: rows of one series differ in the number of objects
    std::string group;   // those of one group have as many objects and differ in their seed
    std::uint64_t seed = 0;
    std::function<Scene()> make;
};

/// One scene in one way.
struct AccelRun {
    std::string series, group;
    std::uint64_t seed = 0;
    std::string way;
    std::uint64_t objects = 0, rays = 0;
    EventCounts events{};           // of one image; Embree counts none
    std::uint64_t scene_words = 0;  // of a PE's memory that hold the scene; Embree tells none, nor
    std::uint64_t accel_words = 0;  // those of the grid or tree
    double build_ms = 0;            // measured: to make the grid or tree
    Measured time{};                // of one image, from packed scene to image
    std::vector<double> turns_ms;   // the least of each turn

    bool is_counted() const { return way != kEmbreeWay; }
    double tests_a_ray() const { return static_cast<double>(test_count(events)) / static_cast<double>(rays); }
    double steps_a_ray() const { return static_cast<double>(events[RAYA_STEPS]) / static_cast<double>(rays); }
    double ns_a_ray() const { return 1e6 * time.min_ms / static_cast<double>(rays); }
};

/// A scene that was not rendered without an accelerator.
struct LeftOut {
    std::string group;
    std::uint64_t objects = 0;
    double predicted_s = 0;  // from the rays of this scene and the last time of a test
};

struct AccelRuns {
    std::vector<AccelRun> runs;
    std::vector<LeftOut> left_out;
    bool has_peer = false;                   // embree_peer was there
    std::vector<std::string> peer_failures;  // "group: what it said"
};

/// Measures scenes one after another, those of fewer objects first.
class AccelBench {
  public:
    /// `peer`: the program embree_peer, where there is one.
    AccelBench(Session& session, const AccelSettings& settings, const std::optional<std::filesystem::path>& peer);

    /// In fp32 on `grande`. Throws UserError, DeviceError as RingRenderer does; DeviceError too where two ways give two
    /// images.
    void measure(const AccelScene& scene);

    const AccelRuns& runs() const { return runs_; }

  private:
    struct Way;
    Way prepared(const AccelScene& scene, const Scene& made, const std::string& name) const;
    std::vector<Way> ways_of(const AccelScene& scene, const Scene& made);
    std::optional<Way> peer_way(const AccelScene& scene, const Scene& made);
    void take_turns(std::vector<Way>& ways) const;

    Session& session_;
    AccelSettings settings_;
    std::optional<std::filesystem::path> peer_;
    double test_s_ = 1e-9;  // of one test without an accelerator: a cautious guess until one is measured
    AccelRuns runs_;
};

/// Pixels that a PE takes together, along each axis: 16 where that divides the image's side.
std::uint32_t tile_side(std::uint32_t image_side);

}  // namespace raya
