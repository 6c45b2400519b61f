// What `raya render` was asked for, and what its machines have in common: files that are checked before, and written
// after.
#pragma once
#include <string>

#include "host/base/progress.hpp"
#include "host/base/say.hpp"
#include "host/base/standard_streams.hpp"
#include "host/cli/frame_options.hpp"
#include "host/cli/keep_options.hpp"
#include "host/cli/render_options.hpp"
#include "host/cli/render_run.hpp"
#include "host/cli/render_watch.hpp"
#include "host/cli/scene_input.hpp"
#include "host/cli/tone_options.hpp"
#include "host/cli/torus_options.hpp"
#include "host/image/image_io.hpp"
#include "host/ranks/ranks.hpp"
#include "host/report/render_report.hpp"
#include "host/report/scene_report.hpp"
#include "host/ring/ring_result.hpp"
#include "host/torus/history.hpp"
#include "host/torus/torus_result.hpp"
#include "host/version.hpp"

namespace raya {

struct RenderCommand {
    RenderOptions render;
    TorusOptions torus;
    std::string image, cost, mask, report, page;
    ToneOptions tone;
    FrameOptions frames;
    KeepOptions keep;
    TraceOptions trace;
    bool profile = false, keep_kernels = false, summary = true;
    bool prints = true;                             // what --profile shows
    ProgressCallback progress{};                    // of a caller that shows it; empty: a bar on a terminal
    PixelSubset pixels{};                           // of the torus: that its primary rays are of
    bool keep_costs = false, keep_packets = false;  // for a caller that reads them from Render

    /// Options whose files are numbered where there are frames, with their values; empty: not given.
    std::vector<std::pair<const char*, std::string>> files() const {
        return {{"--output", image}, {"--cost", cost}, {"--mask", mask}, {"--report", report}};
    }

    /// Commands are timed where somebody will read the times: a GPU's queue is faster without.
    Timing timing() const {
        return profile || reports() || !trace.file.empty() || verbosity() >= kDetailed ? Timing::kOn : Timing::kOff;
    }
    /// A page is made of the report.
    bool reports() const { return !report.empty() || !page.empty(); }
    /// Whether kernels are held against the device's peak.
    bool roofline() const { return profile || !page.empty(); }
};

/// One render: its report, and the pixels and arrays that it counted, of a ring machine or of the torus.
struct Render {
    RenderReport report{};
    std::optional<RingResult> ring{};
    std::optional<TorusResult> torus{};
    std::vector<PacketRecord> packets{};  // where RenderCommand::keep_packets asks for them
    std::optional<TorusSettings> torus_settings{};
    std::uint32_t lights = 0;                           // of the scene
    std::optional<History> history{};                   // of the torus, with --async
    std::vector<std::uint64_t> cycles{}, link_words{};  // of every superstep, [node] and [node][RAYA_LINKS]; with the
                                                        // packets

    const Image& image() const { return ring ? ring->image : torus->image; }
};

/// Renders on a ring machine, on the torus machine, and writes the files that the command names. Empty in other ranks
/// than 0.
std::optional<Render> render_on_ring(const RenderCommand& command, RenderRun& run);
std::optional<Render> render_on_torus(const RenderCommand& command, RenderRun& run);

/// On the machine that the command names.
std::optional<Render> render_image(const RenderCommand& command, RenderRun& run);

/// Adds all options of `raya render`, but not SCENE.
void describe_render(CLI::App& command, RenderCommand& options);

/// Refuses options that do not go together, and files that cannot be written. UserError.
void check_render(const CLI::App& parsed, const RenderCommand& command);

/// Refuses what frames cannot be written to, or what is of one image alone. UserError.
void check_frames(const RenderCommand& command);

/// The frames of a sequence, but for those that are there already: their files, a line for each on stdout, and the
/// record (frame_record.hpp). `parsed` holds the command's options as they were given. UserError.
void render_frames(const CLI::App& parsed, const RenderCommand& command, RenderRun& run);

/// The scene, seen as the options say, which rank 0 alone reads. Elsewhere it has a name and a resolution, and no
/// object; `options` name what rank 0 would choose from what it has read.
SceneInput read_scene_once(RenderWatch& watch, RenderOptions& options, Ranks& ranks);

/// Refuses names of files that the command cannot write, and what follows from them. UserError.
void check_targets(const CLI::App& parsed, const RenderCommand& command);

/// How the picture's codes are made; empty of a picture without.
std::optional<ImageCodes> codes_of(const RenderCommand& command);

/// A small picture for the report's page, in the picture's tone.
void add_preview(RenderReport& report, const RenderCommand& command, const Image& image);

/// What any machine's result tells: scene, view, image, device, times. The rest is the caller's.
template <class Result>
RenderReport begin_report(const RenderCommand& command, const SceneInput& input, const DeviceInfo& device,
                          const Result& result) {
    RenderReport report;
    report.raya = raya_version();
    report.scene = input_name(command.render.scene);
    report.view = view_json(input.scene);
    report.skipped = input.remarks;
    report.image = {result.image.width, result.image.height, output_name(command.image), pixel_hash(result.image),
                    codes_of(command)};
    if (command.reports()) add_preview(report, command, result.image);
    report.device = {device.name,          device.platform, device.version,    device.driver,
                     result.build_options, result.lanes,    result.group_size, result.tuned};
    report.measured = {result.build_s, result.render_s, result.commands, {}, {}};
    return report;
}

/// For --profile: the builds, and the works of all kernels against the peak of `device`, which is measured now.
void add_profile(RenderReport& report, RenderWatch& watch, const cl::Device& device, const NumberFormat& format,
                 const std::vector<KernelWork>& works, Warnings& warnings);

/// What every picture of a render says about itself.
ImageAttributes image_attributes(const RenderReport& report, const std::string& scene);

/// Writes the image with that, and with how its codes were made.
void write_main_image(const RenderCommand& command, const Image& image, ImageAttributes attributes);

/// The report's file, its page, the summary and the profile, as far as they were asked for.
void write_report(const RenderCommand& command, const RenderReport& report);

}  // namespace raya
