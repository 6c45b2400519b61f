// Memory that machines need for a scene, computed without a device by the preparation steps of a render.
#pragma once
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "host/cli/render_options.hpp"
#include "host/cli/torus_options.hpp"
#include "host/report/scene_report.hpp"

namespace raya {

/// Packs a scene for several machines. Machines with the same format and accelerator share the packed words.
class SceneNeeds {
  public:
    /// All three must outlive this.
    SceneNeeds(const RenderOptions& render, const TorusOptions& torus, const Scene& scene);

    /// The needs with accelerators none, bvh and grid, or with that of --accel only. UserError if the machine does not
    /// support the options' values; a scene that does not fit is not an error.
    MachineNeeds of(const std::string& machine);

    /// The formats of the machines passed to of() so far.
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
    std::map<std::string, Words> words_;                      // key: format and accelerator
    std::optional<std::pair<std::string, PackedJob>> plain_;  // for the latest format, without accelerator
};

}  // namespace raya
