// What machines need to hold a scene, found without a device by what a render does first.
#pragma once
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "host/cli/render_options.hpp"
#include "host/cli/torus_options.hpp"
#include "host/report/scene_report.hpp"

namespace raya {

/// Packs a scene for one machine after another. What machines have in common, the words of a format and accelerator, is
/// made once.
class SceneNeeds {
  public:
    /// All three outlive this.
    SceneNeeds(const RenderOptions& render, const TorusOptions& torus, const Scene& scene);

    /// With the accelerators none, bvh and grid, or that of --accel alone. UserError where the machine cannot be what
    /// the options ask for; what does not fit is no error.
    MachineNeeds of(const std::string& machine);

    /// The formats of all machines asked for so far.
    std::vector<FormatFit> formats() const { return formats_; }

  private:
    struct Words {
        std::uint64_t words = 0;
        AccelSummary made;
        std::string refusal;
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
    std::map<std::string, Words> words_;                      // by format and accelerator
    std::optional<std::pair<std::string, PackedJob>> plain_;  // of the latest format, without accelerator
};

}  // namespace raya
