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
RenderCommand command_of(const RenderCommand& all, std::uint32_t frame) {
    RenderCommand one = all;
    for (std::string* file : {&one.image, &one.cost, &one.mask, &one.report}) *file = numbered(*file, frame);
    one.summary = false;
    return one;
}

std::vector<std::string> files_of(const RenderCommand& one) {
    std::vector<std::string> files;
    for (const auto& [option, file] : one.files())
        if (!file.empty()) files.push_back(file);
    return files;
}

void check_files_of(const CLI::App& parsed, const RenderCommand& command, const std::vector<Frame>& frames) {
    std::vector<NamedFile> outputs = {{"--frames", frame_record_file(command.image)}};
    for (const Frame& frame : frames)
        for (const auto& [option, file] : command.files())
            if (!file.empty()) outputs.push_back({option, numbered(file, frame.number)});
    check_files(parsed, outputs);
}

// Returns a text with everything that determines a frame, except its camera: scene, lights, options, program.
std::string settings_of(const CLI::App& parsed, const Scene& scene) {
    static const std::set<std::string> neutral = {"SCENE",  "--output", "--cost",        "--mask",  "--report",
                                                  "--turn", "--frames", "--camera-path", "--quiet", "--verbose"};
    std::string text = raya_version();
    for (const CLI::Option* option : parsed.get_options())
        if (option->count() > 0 && !neutral.contains(option->get_name()))
            text += fmt::format("\n{} {}", option->get_name(), fmt::join(option->results(), " "));
    Scene objects = scene;
    objects.view = {};
    return fmt::format("{}\n{}\n{}\n{}", text, user_build_options(), scene.name, bytes_hash(write_nff(objects)));
}

std::string settings_hash(const std::string& settings, const Scene& scene) {
    return bytes_hash(
        fmt::format("{}\n{}x{}\n{}", settings, scene.view.width, scene.view.height, view_json(scene).dump()));
}

FrameEntry entry_of(const RenderReport& report, std::uint32_t number, const std::string& settings) {
    return {number, settings, report.image.hash, report.load.imbalance, report.load.speedup, {}};
}

void print_frame(const RenderCommand& one, const FrameEntry& frame, bool unchanged) {
    if (is_quiet()) return;
    clear_status();
    fmt::print("frame {:4}  u {:.3f}  speed-up {:7.1f}  {}  {}{}\n", frame.number, frame.imbalance, frame.speed_up,
               frame.pixels, printable(one.image), unchanged ? ", unchanged" : "");
    std::fflush(stdout);  // so that a log file shows the progress
}

struct Sums {
    std::size_t frames = 0, rendered = 0;
    double min = 0, max = 0, sum = 0;

    void add(double imbalance, bool now) {
        min = frames == 0 ? imbalance : std::min(min, imbalance);
        max = std::max(max, imbalance);
        sum += imbalance;
        ++frames;
        rendered += now;
    }
};

void print_sums(const Sums& sums, const std::string& record) {
    if (is_quiet()) return;
    fmt::print("{}, {} rendered, {} unchanged according to {}; u {:.3f} to {:.3f}, mean {:.3f}\n",
               counted(sums.frames, "frame"), sums.rendered, sums.frames - sums.rendered, printable(record), sums.min,
               sums.max, sums.sum / static_cast<double>(sums.frames));
}

}  // namespace

void check_frames(const RenderCommand& command) {
    for (const auto& [option, file] : command.files())
        if (is_standard_stream(file))
            throw UserError(
                fmt::format("{} -: --frames writes several files, not stdout; name a file: each frame adds its number "
                            "to the name",
                            option));
    const std::pair<const char*, bool> of_one_image[] = {{"--page", !command.page.empty()},
                                                         {"--trace", !command.trace.file.empty()},
                                                         {"--profile", command.profile},
                                                         {"--checkpoint", !command.checkpoint.file.empty()},
                                                         {"--packets", !command.torus.packets.empty()},
                                                         {"--replay", !command.torus.replay.empty()}};
    for (const auto& [option, given] : of_one_image)
        if (given)
            throw UserError(fmt::format(
                "{} with --frames: only for a single image; render the frame alone, with the view in its report "
                "(--report)",
                option));
}

void render_frames(const CLI::App& parsed, const RenderCommand& command, RenderRun& run) {
    Ranks& ranks = run.ranks;
    std::vector<Frame> frames;
    std::optional<FrameRecord> record;
    std::string settings;
    if (ranks.first()) {
        frames = frames_of(command.frames, run.input.scene.view);
        check_files_of(parsed, command, frames);
        record.emplace(frame_record_file(command.image));
        settings = settings_of(parsed, run.input.scene);
    }
    auto count = static_cast<std::uint32_t>(frames.size());
    ranks.broadcast(count);
    frames.resize(count);
    run.progress.begin_images(frames.size());
    Sums sums;
    for (const Frame& frame : frames) {
        const RenderCommand one = command_of(command, frame.number);
        if (ranks.first()) run.input.scene.view = frame.view;
        const std::string hash = ranks.first() ? settings_hash(settings, run.input.scene) : "";
        // With --kernel-dir no frame is reused, because the kernels in that folder may have changed.
        const bool may_reuse = ranks.first() && command.render.kernel_dir.empty();
        const FrameEntry* entry = may_reuse ? record->find(frame.number, hash, files_of(one)) : nullptr;
        std::uint32_t renders = entry == nullptr;
        ranks.broadcast(renders);
        if (renders != 0) {
            const std::optional<Render> made = render_image(one, run);
            if (made) entry = &record->add(entry_of(made->report, frame.number, hash), files_of(one));
        }
        if (entry != nullptr) {
            print_frame(one, *entry, renders == 0);
            sums.add(entry->imbalance, renders != 0);
        }
        run.progress.next_image();
    }
    if (!ranks.first()) return;
    if (sums.rendered > 0) record->write();
    print_sums(sums, frame_record_file(command.image));
}

}  // namespace raya
