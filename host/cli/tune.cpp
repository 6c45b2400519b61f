// raya tune: searches for the fastest launch parameters of a device, checks them and stores them.
#include "host/tune/tune.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <memory>

#include "host/base/log.hpp"
#include "host/base/whole_file.hpp"
#include "host/cl/device.hpp"
#include "host/cli/commands.hpp"
#include "host/cli/help.hpp"
#include "host/cli/options.hpp"
#include "host/cli/parse.hpp"
#include "host/cli/render_options.hpp"
#include "host/error.hpp"
#include "host/model/number_format.hpp"
#include "host/report/table.hpp"
#include "host/tune/store.hpp"

namespace raya {
namespace {

struct TuneCommand {
    TrialSetup render;
    RenderOptions image;  // only image.size is an option of tune
    std::vector<std::string> variants, formats;
    double seconds = 60;
};

std::vector<Workload> workloads_of(const TuneCommand& command) {
    if (command.variants.empty() && command.formats.empty()) return default_workloads();
    using Names = std::vector<std::string>;
    std::vector<Workload> workloads;
    for (const std::string& format : command.formats.empty() ? Names{"fp32"} : command.formats)
        for (const std::string& variant :
             command.variants.empty() ? Names{"none", "grid", "bvh", "torus"} : command.variants) {
            workloads.push_back({variant, parse_format(format)});
            workloads.back().key();  // throws for an unknown variant
        }
    return workloads;
}

TrialProgress progress_printer(const Workload& workload) {
    return [=](const TunedValues& values, double seconds) {
        if (shows_progress())
            show_status(
                fmt::format("tuning {}: {} ... {:.0f} s", workload.name(), change_text(values, values), seconds));
    };
}

void print_tunings(const std::vector<Tuning>& tunings) {
    std::vector<std::vector<std::string>> table = {
        {"workload", "speed-up", "tried", "of", "dropped", "s", "defaults -> best"}};
    for (const Tuning& t : tunings)
        table.push_back({t.workload.name(), fmt::format("{:.2f}", 1 / t.ratio), std::to_string(t.tried),
                         std::to_string(t.space.candidates.size()), std::to_string(t.dropped.size()),
                         fmt::format("{:.1f}", t.seconds),
                         change_text(t.space.defaults, t.best) + (t.complete ? "" : " (time limit)")});
    fmt::print("{}", text_table(table));
    fmt::print(
        "speed-up: time of a render with the defaults / time with the best values, median of 9 pairs of renders "
        "after the search;\ntried: candidates whose image was compared with that of the defaults; default: a value "
        "that the kernels choose\n");
    if (std::any_of(tunings.begin(), tunings.end(), [](const Tuning& t) { return !t.complete; }))
        fmt::print("time limit: the limit ended the search; a larger --seconds allows a longer search\n");
    for (const Tuning& t : tunings)
        for (const Trial& trial : t.dropped)
            fmt::print("dropped: {}: {}: {}\n", t.workload.name(), change_text(trial.values, trial.values),
                       trial.error);
}

void tune_device(const CLI::App& parser, TuneCommand& command) {
    Warnings warnings;
    warn_of_build_options(warnings);
    TrialSetup& render = command.render;
    if (is_standard_stream(render.scene))
        throw UserError("tune -: every candidate reads the scene in its own process; name a file");
    if (!command.image.size.empty()) render.size = image_size(command.image, {});
    const std::vector<Workload> workloads = workloads_of(command);
    if (!render.scene.empty())
        read_scene(render.scene, render.strict);  // so that errors in the scene are reported before the first trial
    const DeviceInfo device = device_info(choose_device(render.device));
    const std::filesystem::path file = tuned_path(device);
    check_files(parser, {{"tune", file}});
    fmt::print("tuning {} ({}, driver {}): {}, {:.0f} s\n", device.name, device.platform, device.driver,
               counted(workloads.size(), "workload"), command.seconds);
    std::fflush(stdout);
    TuneSettings settings{.render = render};
    std::vector<Tuning> tunings;
    double remaining_s = command.seconds;
    for (const Workload& workload : workloads) {
        settings.seconds = remaining_s / static_cast<double>(workloads.size() - tunings.size());
        tunings.push_back(tune(device, workload, settings, progress_printer(workload)));
        remaining_s = std::max(0.0, remaining_s - tunings.back().seconds);
        const std::string scene = render.scene.empty() ? "own" : render.scene;
        const Tuning& tuning = tunings.back();
        save_tuned(device, {tuning.workload.key(), tuning.best, 1 / tuning.ratio, scene});
    }
    clear_status();
    print_tunings(tunings);
    fmt::print("stored in {}: render, bench and study use this file, unless --lanes, --group or --no-tuned is given\n",
               printable(file.string()));
}

void add_rendered_options(CLI::App& command, TuneCommand& options) {
    TrialSetup& render = options.render;
    OptionGroup group(command, "Workload");
    add_file(command, FileUse::kRead, "SCENE SCENE", render.scene,
             "Scene in NFF, or mesh (.obj, .ply, .gltf, .glb, .stl), to render with candidates for lanes, group and "
             "other values that change only the time; "
             "default: without accelerator, 30 spheres and a plane; with an accelerator, SPD's balls of 7,381 spheres");
    add_strict_option(command, render.strict);
    add_value(command, "--variants none,grid,bvh,torus", options.variants,
              "Kernels to tune, comma-separated: none, grid, bvh: the ring machine with that --accel; torus: 4x4x4 "
              "nodes; default: none in fp32 and in e6m15; grid, bvh and torus in fp32")
        ->delimiter(',')
        ->allow_extra_args(false);  // so that the scene may follow
    add_value(command, "--format NAME,...", options.formats,
              "Formats, comma-separated: fp32, spa22 (e6m15), eXmY[t]; the values of one reduced format apply to all "
              "reduced formats; default: fp32 for the given variants")
        ->delimiter(',')
        ->allow_extra_args(false);
    add_value(command, "--size N|WxH", options.image.size,
              "Image size in pixels, 1..16384 a side; default: 512; with an accelerator and on the torus: 256");
    add_value(command, "--pes P", render.pes, "Number P of processing elements of the ring, 1..W*H")
        ->capture_default_str();
    add_device_option(command, render.device);
    in_range(add_value(command, "--seconds S", options.seconds, "Duration of the search in seconds, 1..86400"), 1,
             86'400, "seconds")
        ->capture_default_str();
    group.next(kKernels);
    add_kernel_source_options(command, render.kernel_dir);
}

}  // namespace

void add_tune_command(CLI::App& program) {
    CLI::App* command = program.add_subcommand(
        "tune", "Search for this device's fastest launch values and store them for render, bench and study");
    add_examples(*command, {{"raya tune", "Search for a minute and store the best values for this device and driver"},
                            {"raya tune scenes/centre.nff --variants bvh --size 128 --seconds 20",
                             "Tune the BVH for one scene"}});
    const auto options = std::make_shared<TuneCommand>();
    add_rendered_options(*command, *options);
    command->callback([command, options] { tune_device(*command, *options); });
}

}  // namespace raya
