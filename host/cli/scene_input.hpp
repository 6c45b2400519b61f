// Reading of the scene that the command line names, and warnings.
#pragma once
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "host/cli/render_options.hpp"
#include "host/cli/torus_options.hpp"
#include "host/model/number_format.hpp"
#include "host/report/scene_report.hpp"
#include "host/scene/nff.hpp"
#include "host/scene/scene.hpp"

namespace CLI {
class App;
}

namespace raya {

/// Prints each new warning on stderr and stores it for the report. Ignores repeated warnings.
class Warnings {
  public:
    void add(const std::string& text);
    const std::vector<std::string>& texts() const { return texts_; }

  private:
    std::vector<std::string> texts_;
};

/// Adds --strict, with which raya refuses contents that are not NFF or cannot be traced, instead of skipping or
/// changing these contents.
void add_strict_option(CLI::App& command, bool& strict);

/// Help of the argument SCENE.
inline constexpr const char* kSceneHelp =
    "Scene in NFF, the format of the SPD programs, or a mesh: .obj, .ply, .gltf, .glb, .stl; -: NFF from stdin";

struct SceneInput {
    Scene scene;
    std::vector<SceneRemark> remarks;  // contents of the file that were skipped or changed
    Warnings warnings;
};

/// Reads a scene from a file or stdin ("-"). Warns of skipped and changed contents. Throws UserError as
/// read_scene_file() does.
SceneInput read_scene(const std::string& file, bool strict);

/// Warns of options in the environment variable RAYA_BUILD_OPTIONS that may change pixels and counts.
void warn_of_build_options(Warnings& warnings);

/// Warns if every ray is tested against 100,000 objects or more, because no accelerator is used.
void warn_of_slow_search(const Scene& scene, bool accelerated, Warnings& warnings);

/// Warns if objects are too small to be visible in this format. The limit depends on the scene's largest length.
void warn_of_lost_objects(const Scene& scene, const LengthScale& scale, const NumberFormat& format, Warnings& warnings);

// Computes the memory that machines need for a scene, with those steps of a render that need no device.

/// Packs a scene for several machines. Machines with the same format and accelerator share one packed scene.
class SceneNeeds {
  public:
    /// All arguments must outlive this object.
    SceneNeeds(const RenderOptions& render, const TorusOptions& torus, const Scene& scene);

    /// Returns the machine's memory needs with the accelerator of --accel or, without --accel, with each of none, bvh
    /// and grid. Throws UserError if the machine does not support the options' values. A scene that does not fit is not
    /// an error; the result contains the missing bytes.
    MachineNeeds needs_of(const std::string& machine);

    /// Returns how the scene fits the number formats of the machines for which needs_of() was called.
    std::vector<FormatFit> formats() const { return formats_; }

  private:
    /// Size of the packed scene with an accelerator.
    struct PackedSize {
        std::uint64_t words = 0;  // number of 32-bit words
        AccelSummary accel;
        std::string refusal;  // why the scene cannot be packed; empty if it can
    };

    const FormatFit& fit_of(const NumberFormat& format);
    const PackedSize& size_of(const RingSettings& settings, const LengthScale& scale);
    AccelNeed need_of(const RingSettings& settings, const FormatFit& fit);
    MachineNeeds ring_needs(const RenderOptions& options);
    MachineNeeds torus_needs(const RenderOptions& options);

    const RenderOptions& render_;
    const TorusOptions& torus_;
    const Scene& scene_;
    std::vector<FormatFit> formats_;
    std::map<std::string, PackedSize> sizes_;                       // key: format and accelerator
    std::optional<std::pair<std::string, PackedJob>> last_packed_;  // [format, scene without accelerator]
};

}  // namespace raya
