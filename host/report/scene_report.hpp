// Report of `raya info`: a struct with data on a scene, written as JSON and as text on the terminal.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "host/base/members.hpp"
#include "host/model/machine.hpp"
#include "host/report/render_report.hpp"
#include "host/scene/nff.hpp"
#include "host/scene/scene.hpp"

namespace raya {

/// Representation of a scene in a number format: the scale of the lengths, or the reason for a refusal.
struct FormatFit {
    std::string format;
    LengthScale scale;
    std::string refusal;  // error message of a render in this format; empty: none
};

/// Memory that a PE of the ring, or the fullest node of the torus, needs for a scene with one accelerator.
struct AccelNeed {
    std::string accel;                // value of --accel; "voxels" on the torus
    bool is_default = false;          // `accel` is the machine's default for this scene
    std::uint64_t words = 0;          // number of 32-bit words of job and accelerator, or of the fullest node
    std::uint32_t parts = 1;          // of the objects, which rotate on the ring; `words` is the sum of all parts
    AccelSummary summary;             // size of the grid or BVH
    std::uint64_t pe_bytes = 0;       // bytes that the render would use in a PE; if they exceed the PE's memory, the
                                      // smallest --pe-memory with which raya renders the scene
    std::uint64_t missing_bytes = 0;  // pe_bytes minus the memory of a PE; 0: the scene fits
    std::string refusal;              // error message of a render; empty: none
};

/// Memory that the PEs of a machine need for the scene.
struct MachineNeeds {
    std::string machine, format;
    std::uint32_t pes = 0;
    std::optional<std::uint64_t> memory_bytes;  // memory of a PE; empty: no limit
    std::vector<AccelNeed> needs;               // one for each accelerator
    std::string refusal;  // error message if the machine refuses the options (`needs` is then empty), else ""
};

struct SceneReport {
    std::string raya;  // version of raya
    std::string file;
    Scene scene;
    Box box;  // bounding box of the finite objects
    std::vector<SceneRemark> skipped;
    std::vector<std::string> warnings;
    std::vector<FormatFit> formats;
    std::vector<MachineNeeds> machines;
};

void members_of(Members& m, const SceneReport& report);

/// Returns the text for the terminal: objects, camera, lights, extent, formats, and a table of machines.
std::string summary_text(const SceneReport& report);

}  // namespace raya
