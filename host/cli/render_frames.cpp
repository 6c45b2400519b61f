// raya render --frames: renders numbered images of one scene, each with its own camera.
#include <fmt/core.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <set>

#include "host/base/encoding.hpp"
#include "host/base/log.hpp"
#include "host/cl/program.hpp"
#include "host/cli/file_options.hpp"
#include "host/cli/frame_record.hpp"
#include "host/cli/render_command.hpp"
#include "host/error.hpp"
#include "host/model/unit_text.hpp"
#include "host/scene/nff.hpp"

namespace raya {
namespace {

// Returns the command that renders one frame, with numbered file names.
RenderCommand command_of(const RenderCommand& sequence_command, std::uint32_t frame) {
    RenderCommand frame_command = sequence_command;
    for (std::string* file : {&frame_command.image, &frame_command.cost, &frame_command.mask, &frame_command.report})
        *file = numbered(*file, frame);
    frame_command.summary = false;
    return frame_command;
}

std::vector<std::string> files_of(const RenderCommand& frame_command) {
    std::vector<std::string> files;
    for (const auto& [option, file] : frame_command.files())
        if (!file.empty()) files.push_back(file);
    return files;
}

void check_frame_files(const CLI::App& parser, const RenderCommand& command, const std::vector<Frame>& frames) {
    std::vector<NamedFile> outputs = {{"--frames", frame_record_file(command.image)}};
    for (const Frame& frame : frames)
        for (const auto& [option, file] : command.files())
            if (!file.empty()) outputs.push_back({option, numbered(file, frame.number)});
    check_files(parser, outputs);
}

// Returns a text with all that the pixels of the frames depend on, except the camera and the image size: version of
// raya, options, build options, and the scene with its lights.
std::string settings_of(const CLI::App& parser, const Scene& scene) {
    static const std::set<std::string> irrelevant_options = {"SCENE",    "--output", "--cost",   "--mask",
                                                             "--report", "--turn",   "--frames", "--camera-path",
                                                             "--quiet",  "--verbose"};
    std::string text = raya_version();
    for (const CLI::Option* option : parser.get_options())
        if (option->count() > 0 && !irrelevant_options.contains(option->get_name()))
            text += fmt::format("\n{} {}", option->get_name(), fmt::join(option->results(), " "));
    Scene content = scene;
    content.view = {};
    return fmt::format("{}\n{}\n{}\n{}", text, user_build_options(), scene.name, bytes_hash(write_nff(content)));
}

std::string settings_hash(const std::string& settings, const Scene& scene) {
    return bytes_hash(
        fmt::format("{}\n{}x{}\n{}", settings, scene.view.width, scene.view.height, view_json(scene).dump()));
}

FrameEntry entry_of(const RenderReport& report, std::uint32_t number, const std::string& settings) {
    return {number, settings, report.image.hash, report.load.imbalance, report.load.speedup, {}};
}

void print_frame(const RenderCommand& frame_command, const FrameEntry& frame, bool unchanged) {
    if (is_quiet()) return;
    clear_status();
    fmt::print("frame {:4}  u {:.3f}  speed-up {:7.1f}  {}  {}{}\n", frame.number, frame.imbalance, frame.speed_up,
               frame.pixels, printable(frame_command.image), unchanged ? ", unchanged" : "");
    std::fflush(stdout);  // so that a log file shows the progress
}

struct FrameTotals {
    std::size_t frames = 0, rendered = 0;  // numbers of frames
    double min_imbalance = 0, max_imbalance = 0, imbalance_sum = 0;

    void add(double imbalance, bool is_rendered) {
        min_imbalance = frames == 0 ? imbalance : std::min(min_imbalance, imbalance);
        max_imbalance = std::max(max_imbalance, imbalance);
        imbalance_sum += imbalance;
        ++frames;
        rendered += is_rendered;
    }
};

void print_totals(const FrameTotals& totals, const std::string& record) {
    if (is_quiet()) return;
    fmt::print("{}, {} rendered, {} unchanged according to {}; u {:.3f} to {:.3f}, mean {:.3f}\n",
               counted(totals.frames, "frame"), totals.rendered, totals.frames - totals.rendered, printable(record),
               totals.min_imbalance, totals.max_imbalance, totals.imbalance_sum / static_cast<double>(totals.frames));
}

}  // namespace

void check_frames(const RenderCommand& command) {
    for (const auto& [option, file] : command.files())
        if (is_standard_stream(file))
            throw UserError(
                fmt::format("{} -: --frames writes several files, not stdout; name a file: each frame adds its number "
                            "to the name",
                            option));
    const std::pair<const char*, bool> single_image_options[] = {{"--page", !command.page.empty()},
                                                                 {"--trace", !command.trace.file.empty()},
                                                                 {"--profile", command.profile},
                                                                 {"--checkpoint", !command.checkpoint.file.empty()},
                                                                 {"--packets", !command.torus.packets.empty()},
                                                                 {"--replay", !command.torus.replay.empty()}};
    for (const auto& [option, given] : single_image_options)
        if (given)
            throw UserError(fmt::format(
                "{} with --frames: only for a single image; render the frame alone, with the view in its report "
                "(--report)",
                option));
}

void render_frames(const CLI::App& parser, const RenderCommand& command, RenderRun& run) {
    Ranks& ranks = run.ranks;
    std::vector<Frame> frames;
    std::optional<FrameRecord> record;
    std::string settings;
    if (ranks.is_first()) {
        frames = frames_of(command.frames, run.input.scene.view);
        check_frame_files(parser, command, frames);
        record.emplace(frame_record_file(command.image));
        settings = settings_of(parser, run.input.scene);
    }
    auto count = static_cast<std::uint32_t>(frames.size());
    ranks.broadcast(count);
    frames.resize(count);
    run.progress.begin_images(frames.size());
    FrameTotals totals;
    for (const Frame& frame : frames) {
        const RenderCommand frame_command = command_of(command, frame.number);
        if (ranks.is_first()) run.input.scene.view = frame.view;
        const std::string hash = ranks.is_first() ? settings_hash(settings, run.input.scene) : "";
        // With --kernel-dir no frame is reused, because the kernels in that folder may have changed.
        const bool may_reuse = ranks.is_first() && command.render.kernel_dir.empty();
        const FrameEntry* entry = may_reuse ? record->find(frame.number, hash, files_of(frame_command)) : nullptr;
        std::uint32_t must_render = entry == nullptr;
        ranks.broadcast(must_render);
        if (must_render != 0) {
            const std::optional<Render> result = render_image(frame_command, run);
            if (result) entry = &record->add(entry_of(result->report, frame.number, hash), files_of(frame_command));
        }
        if (entry != nullptr) {
            print_frame(frame_command, *entry, must_render == 0);
            totals.add(entry->imbalance, must_render != 0);
        }
        run.progress.next_image();
    }
    if (!ranks.is_first()) return;
    if (totals.rendered > 0) record->write();
    print_totals(totals, frame_record_file(command.image));
}

}  // namespace raya
