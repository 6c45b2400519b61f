// What a number format costs in quality and gains or loses in time: renders in many formats against the
// double-precision reference.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "host/cl/commands.hpp"
#include "host/model/number_format.hpp"
#include "host/ring/ring_renderer.hpp"
#include "host/scene/scene.hpp"
#include "host/study/image_difference.hpp"
#include "host/study/scenes.hpp"

namespace raya {

/// What a shown image can tell apart: one step of 8 bits.
inline constexpr double kShownStep = 1.0 / 255;

/// The reduced formats of the study: e8m21 down to e6m13 (e6m15 is the SPA's), each rounding to nearest, then
/// truncating.
std::vector<NumberFormat> reduced_formats();

struct FormatsSettings {
    std::uint32_t width = 256, height = 256;                // pixels, 1..16384
    std::uint32_t lanes = 0;                                // V; 0: chosen from the device
    int samples = 5;                                        // timed renders of each scene and format, >= 1
    std::vector<NumberFormat> formats = reduced_formats();  // beside fp32, which always comes first
};

/// One scene in one format.
struct FormatRow {
    NumberFormat format;
    ImageDifference difference;  // from the reference; limit kShownStep
    std::string image_hash;      // pixel_hash()
    double kernel_s = 0;         // measured: least time of the trace kernel for one image
    double ratio_to_fp32 = 0;    // measured: kernel_s over that of fp32
};

struct SceneRows {
    std::string label;
    std::size_t objects = 0;
    std::vector<FormatRow> rows;  // fp32, then the settings' formats in their order
};

struct FormatsStudy {
    std::uint32_t width = 0, height = 0, bounces = 0;
    std::string machine;
    std::uint32_t pes = 0, offset = 0;
    DeviceInfo device;
    std::uint32_t lanes = 0, group_size = 0;
    int samples = 0;
    std::vector<SceneRows> scenes;
};

/// Renders each scene by the reference and in every format on `grande`, whose memory has no limit and which has a PE
/// for each column (P = W). The formats take turns in being timed, so that what else the device does meets them alike;
/// the least time of each counts. A device that does not time its commands is timed by the host's clock, transfers
/// included. `progress` is called with the share of the steps that are done, 0..1. Throws UserError for a size or lanes
/// out of range, DeviceError.
FormatsStudy run_formats_study(Session& session, const std::vector<LabelledScene>& scenes,
                               const FormatsSettings& settings, const ProgressCallback& progress = {});

}  // namespace raya
