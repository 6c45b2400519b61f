// The memory that machines need for a scene. Uses the preparation steps of a render, which need no device.
#pragma once
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "host/cli/render_options.hpp"
#include "host/cli/torus_options.hpp"
#include "host/report/scene_report.hpp"

namespace raya {

/// Packs a scene for several machines. Machines with the same format and accelerator share one packed scene.
class SceneNeeds {
  public:
    /// All arguments must outlive this object.
    SceneNeeds(const RenderOptions& render, const TorusOptions& torus, const Scene& scene);

    /// Returns the machine's memory needs with accelerators none, bvh and grid, or only with the accelerator of
    /// --accel. Throws UserError if the machine does not support the options' values. It is no error if the scene
    /// does not fit.
    MachineNeeds needs_of(const std::string& machine);

    /// Returns the formats of the machines for which needs_of() was called.
    std::vector<FormatFit> formats() const { return formats_; }

  private:
    struct Words {
        std::uint64_t words = 0;  // of the packed scene with its accelerator
        AccelSummary made;        // the accelerator
        std::string refusal;      // why the scene could not be packed; else empty
    };

    const FormatFit& fit_of(const NumberFormat& format);
    const Words& words_of(const RingSettings& settings, const LengthScale& scale);
    AccelNeed need_of(const RingSettings& settings, const FormatFit& fit);
    MachineNeeds of_ring(const RenderOptions& options);
    MachineNeeds of_torus(const RenderOptions& options);

    const RenderOptions& render_;
    const TorusOptions& torus_;
    const Scene& scene_;
    std::vector<FormatFit> formats_;
    std::map<std::string, Words> words_;                      // key: format and accelerator
    std::optional<std::pair<std::string, PackedJob>> plain_;  // [format, scene]: last one packed without accelerator
};

}  // namespace raya
