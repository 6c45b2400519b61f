// The options of `raya render`, and the steps that its machines share: checks before the render, output after it.
#pragma once
#include <string>

#include "host/base/log.hpp"
#include "host/base/progress.hpp"
#include "host/base/standard_streams.hpp"
#include "host/cli/checkpoint_options.hpp"
#include "host/cli/frame_options.hpp"
#include "host/cli/render_options.hpp"
#include "host/cli/render_recorder.hpp"
#include "host/cli/render_run.hpp"
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
    CheckpointOptions checkpoint;
    TraceOptions trace;
    bool profile = false, cache_kernels = false, summary = true;
    bool prints = true;                             // the table of --profile
    ProgressCallback progress{};                    // empty: a progress bar on a terminal
    PixelSubset pixels{};                           // torus: the pixels of the primary rays
    bool keep_costs = false, keep_packets = false;  // store them in Render

    /// Options whose files are numbered by --frames, with their values; empty: not given.
    std::vector<std::pair<const char*, std::string>> files() const {
        return {{"--output", image}, {"--cost", cost}, {"--mask", mask}, {"--report", report}};
    }

    /// Commands are timed only if the times are shown: timing slows a GPU's queue down.
    Timing timing() const {
        return profile || reports() || !trace.file.empty() || verbosity() >= kDetailed ? Timing::kOn : Timing::kOff;
    }
    /// Returns true if a report is needed; a page is made from one.
    bool reports() const { return !report.empty() || !page.empty(); }
    /// Returns true if kernels are compared with the device's peak.
    bool roofline() const { return profile || !page.empty(); }
};

/// One render: its report, image and arrays, of a ring machine or of the torus.
struct Render {
    RenderReport report{};
    std::optional<RingResult> ring{};
    std::optional<TorusResult> torus{};
    std::vector<PacketRecord> packets{};  // with RenderCommand::keep_packets
    std::optional<TorusSettings> torus_settings{};
    std::uint32_t lights = 0;                           // of the scene
    std::optional<History> history{};                   // torus with --async
    std::vector<std::uint64_t> cycles{}, link_words{};  // with the packets: [superstep][node] and
                                                        // [superstep][node][RAYA_LINKS]

    const Image& image() const { return ring ? ring->image : torus->image; }
};

/// Renders on a ring machine or on the torus machine and writes the command's files. Empty on ranks other than 0.
std::optional<Render> render_on_ring(const RenderCommand& command, RenderRun& run);
std::optional<Render> render_on_torus(const RenderCommand& command, RenderRun& run);

/// Renders on the command's machine.
std::optional<Render> render_image(const RenderCommand& command, RenderRun& run);

/// Adds all options of `raya render` except SCENE.
void describe_render(CLI::App& command, RenderCommand& options);

/// Checks that the options are compatible and the files writable. UserError.
void check_render(const CLI::App& parsed, const RenderCommand& command);

/// Refuses outputs that --frames does not support: stdout, and files of a single image. UserError.
void check_frames(const RenderCommand& command);

/// Renders the frames that the record (frame_record.hpp) does not list yet: writes their files and the record, prints a
/// line for each frame. `parsed` holds the command's options as given. UserError.
void render_frames(const CLI::App& parsed, const RenderCommand& command, RenderRun& run);

/// Rank 0 reads the scene and applies the view options. Other ranks get its name and resolution without objects, and
/// --accel as rank 0 chose it from the scene.
SceneInput read_scene_once(RenderRecorder& recorder, RenderOptions& options, Ranks& ranks);

/// Checks the names of the output files, and options that depend on them. UserError.
void check_output_files(const CLI::App& parsed, const RenderCommand& command);

/// The tone mapping of an 8-bit image; empty for linear images.
std::optional<ImageCodes> codes_of(const RenderCommand& command);

/// Adds a small image for the report's page, in the tone of the image.
void add_preview(RenderReport& report, const RenderCommand& command, const Image& image);

/// The report's members that all machines share: scene, view, image, device, times. The caller adds the others.
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

/// For --profile: adds build times and the roofline of all kernels. Measures the peak of `device`.
void add_profile(RenderReport& report, RenderRecorder& recorder, const cl::Device& device, const NumberFormat& format,
                 const std::vector<KernelWork>& works, Warnings& warnings);

/// The metadata of a render's image files.
ImageAttributes image_attributes(const RenderReport& report, const std::string& scene);

/// Writes the image with these attributes and those of its tone mapping.
void write_main_image(const RenderCommand& command, const Image& image, ImageAttributes attributes);

/// Writes the report and its page, prints the summary and the profile, as far as requested.
void write_report(const RenderCommand& command, const RenderReport& report);

}  // namespace raya
