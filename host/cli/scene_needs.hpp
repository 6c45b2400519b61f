// Computes the memory that machines need for a scene, with those steps of a render that need no device.
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
