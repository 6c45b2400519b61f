// The report of one render: plain data, as JSON for programs and as a few lines for people.
#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "host/base/json.hpp"
#include "host/cl/profile.hpp"
#include "host/model/machine.hpp"
#include "host/model/time_model.hpp"
#include "host/report/roofline.hpp"
#include "host/report/torus_report.hpp"
#include "host/scene/nff.hpp"

namespace raya {

/// How the image was smoothed over ring or bus.
struct Antialiasing {
    std::string method;             // "filter" or "supersample"
    std::string exchange;           // how neighbours' pixels came: "ring", "bus", "bus-broadcast"
    std::string points;             // of supersampling: "axes" or "diagonals"
    double threshold = 0;           // of supersampling, 0..1
    std::uint64_t recomputed = 0;   // pixels supersampled
    double recomputed_share = 0;    // of all pixels
    std::uint32_t band_pixels = 0;  // pixels of a PE that move at a time
};

/// How linear colours became the codes of an 8-bit picture.
struct ImageCodes {
    double exposure = 0;          // stops: colours were multiplied by 2^exposure
    std::string tone;             // "clip" or "reinhard"
    std::optional<double> gamma;  // empty: the sRGB curve
};

/// The build of one program, on the host.
struct ProgramBuild {
    std::string name;
    double seconds = 0;
};

struct RenderReport {
    std::string raya;  // version
    std::string scene;
    std::vector<std::string> warnings;  // what was said on stderr
    std::vector<NffRemark> skipped;     // what the scene's file has and the scene has not

    Json view;  // as it was rendered, by the scene or the command line (view_json.hpp)

    struct {
        int width = 0, height = 0;  // pixels
        std::string file, hash;     // hash of the linear pixel values: equal for equal pixels
        std::optional<ImageCodes> codes{};
        struct {
            int width = 0, height = 0;  // pixels
            std::string png;            // the file's bytes; empty: none was made
        } preview{};                    // for the page of the report (host/image/preview.hpp)
    } image;

    struct {
        std::string name, topology;
        std::string mapping;              // "cyclic" or "column", else the whole text: "grid:16x16"
        std::optional<std::string> fold;  // of a mapping with slots
        std::string format;
        std::uint32_t pes = 0;
        std::optional<std::uint32_t> offset;  // p of a mapping with slots
        std::uint32_t bounces = 0;
        int length_exponent = 0;  // lengths of the scene are multiplied by 2^this (host/scene/length_scale.hpp)
        std::uint64_t pe_memory_bytes = 0;  // 0: no limit
        std::uint64_t pe_memory_used_bytes = 0;
    } machine;

    struct {
        std::string name, platform, version, driver, build_options;
        std::uint32_t lanes = 0, group_size = 0;
        std::string tuned;  // where lanes, group and what goes with them come from: "defaults", "options", "FILE, DATE"
    } device;

    EventCounts events{};
    std::optional<std::uint64_t> requests;            // for pixels, where loads are a simulated dynamic distribution's
    Load load;                                        // of all phases together
    std::vector<std::pair<std::string, Load>> loads;  // of each phase, by its name
    std::optional<Antialiasing> antialias;
    std::optional<AccelSummary> accel;  // empty: every ray is tested against all objects
    Communication communication;
    std::optional<ModelledTime> modelled;  // empty: the machine's rates are not known
    std::optional<TorusReport> torus;      // of a machine that divides the scene, in place of the four above

    std::vector<Json> ranks;  // of each rank what it had, did and sent; empty where there is one

    struct {
        double build_s = 0, render_s = 0;
        std::vector<LabelSummary> commands;
        std::vector<ProgramBuild> builds{};  // of --profile, as the next
        std::optional<Roofline> roofline{};
        double earlier_s = 0;  // of render_s: of runs whose state this one went on with
    } measured;
};

/// By which a report of a render is known again: its member "kind".
inline constexpr const char* kRenderReportKind = "raya render";

/// Rays of all kinds.
std::uint64_t ray_count(const EventCounts& events);

/// Tests of rays against objects of all kinds.
std::uint64_t test_count(const EventCounts& events);

/// The keys are fixed; more may be added.
Json to_json(const RenderReport& report);

/// Rays, u, efficiency and times in a few lines.
std::string human_summary(const RenderReport& report);

}  // namespace raya
