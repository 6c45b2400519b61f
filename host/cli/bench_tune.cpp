#include "host/cli/bench_tune.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <optional>
#include <sstream>
#include <string_view>

#include "host/base/say.hpp"
#include "host/base/utc_time.hpp"
#include "host/base/verbosity.hpp"
#include "host/base/whole_file.hpp"
#include "host/cl/device.hpp"
#include "host/cli/file_options.hpp"
#include "host/cli/options.hpp"
#include "host/cli/scene_input.hpp"
#include "host/error.hpp"
#include "host/model/unit_text.hpp"
#include "host/report/table.hpp"
#include "host/tune/store.hpp"
#include "host/tune/t4_report.hpp"
#include "host/tune/tune.hpp"

namespace raya {
namespace {

constexpr std::array kTuneOnly = {"--exhaustive", "--seconds", "--candidate-seconds"};
constexpr std::array kAlsoWithTune = {"SCENE",    "--strict", "--size",       "--pes",  "--format", "--ways",
                                      "--device", "--report", "--kernel-dir", "--tune", "--quiet",  "--verbose"};

bool is_one_of(const auto& names, const std::string& name) {
    return std::find(names.begin(), names.end(), std::string_view(name)) != names.end();
}

void check_range(const char* option, double value, double least, double most) {
    if (!(value >= least && value <= most))
        throw UserError(fmt::format("{} {}: must be {}..{} seconds", option, value, least, most));
}

std::vector<Workload> workloads_of(const RenderOptions& render, std::vector<std::string> ways) {
    if (ways.empty() && render.format.empty()) return usual_workloads();
    if (ways.empty()) ways = {"none", "grid", "bvh", "torus"};
    std::vector<Workload> all;
    std::istringstream formats(render.format.empty() ? "fp32" : render.format);
    for (std::string format; std::getline(formats, format, ',');)
        for (const std::string& way : ways) {
            all.push_back({way, parse_format(format)});
            all.back().what();  // refuses ways that there are not
        }
    return all;
}

// What the process of a trial needs to render the same on the same device.
std::vector<std::string> trial_arguments(const RenderOptions& render) {
    std::vector<std::string> all = {"bench", "--tune"};
    const auto add = [&](const char* option, const std::string& value) {
        if (!value.empty()) all.insert(all.end(), {option, value});
    };
    if (!render.scene.empty()) all.push_back(render.scene);
    if (render.strict) all.emplace_back("--strict");
    add("--size", render.size);
    add("--pes", render.pes ? std::to_string(*render.pes) : "");
    add("--device", render.device);
    add("--kernel-dir", render.kernel_dir);
    for (const std::string& word : verbosity_words()) all.push_back(word);
    all.emplace_back("--tune-trial");
    return all;
}

ImageSize size_of(const RenderOptions& render, const Scene* scene) {
    return render.size.empty() ? ImageSize{} : image_size(render, scene ? *scene : Scene{});
}

void run_as_trial(const RenderOptions& render, const TuneCommand& tune) {
    std::optional<Scene> given;
    if (!render.scene.empty()) given = read_scene(render.scene, render.strict).scene;
    const Scene* const scene = given ? &*given : nullptr;
    run_trial(tune.lines, render.device, TrialOrder::of(tune.trial), scene, size_of(render, scene),
              render.pes.value_or(WorkloadPicture{}.pes), {.folder = render.kernel_dir});
}

TuneSink sink_for(const Workload& workload, const Space& space) {
    const bool shows = shows_progress();
    return {.running = [=](const TunedValues& values, double seconds) {
        if (shows)
            show_status(fmt::format("tuning {}: {} ... {:.0f} s", workload.name(), change_text(space, values, values),
                                    seconds));
    }};
}

const char* fate_text(Fate fate) {
    switch (fate) {
        case Fate::kCompile:
            return "not built";
        case Fate::kRuntime:
            return "failed";
        case Fate::kCorrectness:
            return "wrong";
        case Fate::kTimeout:
            return "too long";
        default:
            return "right";
    }
}

void print_dropped(const Tuning& tuning) {
    for (const Trial& trial : tuning.trials)
        if (trial.fate != Fate::kCorrect && trial.fate != Fate::kUnfinished)
            fmt::print("dropped: {}: {}: {}: {}\n", tuning.workload.name(),
                       change_text(tuning.space, trial.values, trial.values), fate_text(trial.fate), trial.told);
}

void print_exhaustive(const Tuning& tuning) {
    if (tuning.best_all)
        fmt::print("of all {}: {}: best is {}; the tuned one takes {:.3f} of its time\n", tuning.tried_all + 1,
                   tuning.workload.name(), change_text(tuning.space, *tuning.best_all, *tuning.best_all),
                   tuning.ratio_all);
}

void print_tunings(const std::vector<Tuning>& tunings) {
    std::vector<std::vector<std::string>> table = {
        {"workload", "speed-up", "tried", "of", "dropped", "s", "defaults, and what is better"}};
    for (const Tuning& t : tunings)
        table.push_back({t.workload.name(), fmt::format("{:.2f}", 1 / t.ratio), std::to_string(t.trials.size()),
                         std::to_string(t.space.size()), std::to_string(t.dropped()), fmt::format("{:.1f}", t.seconds),
                         change_text(t.space, t.space.defaults, t.best) + (t.complete ? "" : " (time was over)")});
    fmt::print("{}", text_table(table));
    fmt::print(
        "speed-up: time of a render with the defaults over that with the better values, the median of 9 pairs after "
        "the "
        "search;\ntried: candidates that were rendered and held against the image of the defaults; own: the kernels' "
        "own "
        "default\n");
    if (std::any_of(tunings.begin(), tunings.end(), [](const Tuning& t) { return !t.complete; }))
        fmt::print("time was over: --seconds gives the search more\n");
    for (const Tuning& tuning : tunings) print_dropped(tuning);
    for (const Tuning& tuning : tunings) print_exhaustive(tuning);
}

TunedEntry entry_of(const Tuning& tuning, const std::string& scene) {
    return {tuning.workload.what(), tuning.best, 1 / tuning.ratio, scene};
}

}  // namespace

void add_tune_options(CLI::App& bench, TuneCommand& tune) {
    const OptionGroup group(bench, "Tuning");
    bench.add_flag(
        "--tune", tune.wanted,
        "Search lanes, group and what else only changes the time, for this device: on the ring without accelerator in "
        "fp32 and e6m15, with grid and with bvh, and on the torus, or for the --ways and --format named. Every "
        "candidate runs in a process of its own and must make the image of the defaults. The best are kept in a file "
        "of this device and driver in XDG_CACHE_HOME/raya, or ~/.cache/raya, which render, bench and study take "
        "their defaults from; --report writes all that was tried in the T4 format of Kernel Tuner");
    add_value(bench, "--seconds", tune.seconds, "With --tune: seconds that the search takes, 1..86400")
        ->type_name("S")
        ->capture_default_str();
    add_value(bench, "--candidate-seconds", tune.candidate_seconds,
              "With --tune: seconds, 1..3600, after which a candidate is dropped, with its build")
        ->type_name("S")
        ->capture_default_str();
    bench.add_flag("--exhaustive", tune.exhaustive,
                   "With --tune: try every candidate afterwards, however long that takes, and tell how near the search "
                   "came to the best");
    // For the process of a trial. No group: not in the help.
    add_value(bench, "--tune-trial", tune.trial)->group("");
    add_value(bench, "--lines", tune.lines)->group("");
}

void check_tune_options(const CLI::App& parsed, const TuneCommand& tune) {
    for (const CLI::Option* option : parsed.get_options()) {
        const std::string name = option->get_name();
        if (option->count() == 0 || name.empty()) continue;  // hidden ones have none
        const bool of_tune = is_one_of(kTuneOnly, name);
        if (!tune.wanted && of_tune) throw UserError(fmt::format("{} says how to tune: give --tune as well", name));
        if (tune.wanted && !of_tune && !is_one_of(kAlsoWithTune, name))
            throw UserError(
                fmt::format("{} with --tune, which renders scenes of its own kind and searches lanes and "
                            "group itself: leave it out",
                            name));
    }
    check_range("--seconds", tune.seconds, 1, 86400);
    check_range("--candidate-seconds", tune.candidate_seconds, 1, 3600);
}

void bench_tune(const CLI::App& parsed, const RenderOptions& render, const std::vector<std::string>& ways,
                const std::string& report, const TuneCommand& tune) {
    if (!tune.trial.empty()) return run_as_trial(render, tune);
    const std::vector<Workload> workloads = workloads_of(render, ways);
    if (!render.scene.empty()) read_scene(render.scene, render.strict);  // refuses what every candidate would refuse
    const DeviceInfo device = device_info(choose_device(render.device));
    const std::filesystem::path file = tuned_place(device);
    check_files(parsed, {{"--tune", file}});
    fmt::print("tuning {} ({}, driver {}): {}, {:.0f} s\n", device.name, device.platform, device.driver,
               counted(workloads.size(), "workload"), tune.seconds);
    std::fflush(stdout);
    TuneSettings settings{
        .arguments = trial_arguments(render), .limit_s = tune.candidate_seconds, .exhaustive = tune.exhaustive};
    std::vector<Tuning> tunings;
    double left = tune.seconds;
    const std::string date = utc_text("%Y-%m-%d");
    for (const Workload& workload : workloads) {
        settings.seconds = left / static_cast<double>(workloads.size() - tunings.size());
        tunings.push_back(
            raya::tune(device, workload, settings, sink_for(workload, space_of(device, workload.what()))));
        left = std::max(0.0, left - tunings.back().seconds);
        const std::string scene = render.scene.empty() ? "own" : render.scene;
        keep_tuned(device, {date, {entry_of(tunings.back(), scene)}});
    }
    clear_status();
    print_tunings(tunings);
    if (!report.empty()) write_whole_file(report, t4_text(device, tunings));
    fmt::print("kept in {}: render, bench and study take it, but for --lanes, --group and --no-tuned\n",
               printable(file.string()));
}

}  // namespace raya
