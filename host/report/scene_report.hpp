// What `raya info` tells of a scene: plain data, as JSON for programs and as a few lines for people.
#pragma once

#include <Imath/ImathBox.h>

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "host/base/json.hpp"
#include "host/model/machine.hpp"
#include "host/scene/length_scale.hpp"
#include "host/scene/nff.hpp"
#include "host/scene/scene.hpp"

namespace raya {

/// How a number format holds a scene.
struct FormatFit {
    std::string format;
    LengthScale scale;
    std::string refusal;  // of a render in it; empty: it can be rendered
};

/// What a PE, of the torus the fullest node, must hold of a scene with one accelerator.
struct AccelNeed {
    std::string accel;           // as --accel takes it; "voxels" of the torus
    bool is_default = false;     // of the machine, for this scene
    std::uint64_t words = 0;     // of the job, of 4 bytes, with the accelerator's; of the torus the fullest node's
    AccelSummary made;           // of a grid or a tree
    std::uint64_t pe_bytes = 0;  // with rays, pixels and buffers; where that does not fit, what it takes at the least
    std::uint64_t missing_bytes = 0;  // 0: it fits
    std::string refusal;              // what a render would say; empty: it can be rendered
};

/// A machine and what its PEs must hold.
struct MachineNeeds {
    std::string machine, format;
    std::uint32_t pes = 0;
    std::optional<std::uint64_t> memory_bytes;  // of a PE; empty: no limit
    std::vector<AccelNeed> needs;
    std::string refusal;  // of the options, by this machine; then there are no needs
};

struct SceneReport {
    std::string raya;  // version
    std::string file;
    Scene scene;
    Imath::Box3d box;  // of the finite objects
    std::vector<NffRemark> skipped;
    std::vector<std::string> warnings;
    std::vector<FormatFit> formats;
    std::vector<MachineNeeds> machines;
};

/// The keys are fixed; more may be added.
Json to_json(const SceneReport& report);

/// Objects, camera, lights, extent, formats, and a table of machines.
std::string human_summary(const SceneReport& report);

Json vector_json(const Vec3& v);

/// Camera, background and lights, each with the colour that it emits: what --from, --at, --up, --angle, --background
/// and
/// --light take to make the picture again.
Json view_json(const Scene& scene);

}  // namespace raya
