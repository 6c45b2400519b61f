// raya study NAME [SCENE...] -o DIR: the load laboratory: files of one study, or with `all` of every one, and a
// document to read.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>

#include "host/base/progress.hpp"
#include "host/base/say.hpp"
#include "host/base/verbosity.hpp"
#include "host/base/whole_file.hpp"
#include "host/cli/file_options.hpp"
#include "host/cli/options.hpp"
#include "host/cli/parse.hpp"
#include "host/cli/quoted.hpp"
#include "host/cli/scene_input.hpp"
#include "host/cli/studies.hpp"
#include "host/cli/tuned_option.hpp"
#include "host/error.hpp"
#include "host/study/document.hpp"
#include "host/study/page_writer.hpp"
#include "host/study/studies.hpp"
#include "host/version.hpp"

namespace raya {
namespace {

namespace fs = std::filesystem;

struct LaboratoryCommand {
    std::string folder, device;
    std::optional<std::uint32_t> size;
    std::vector<std::string> scenes;
    std::vector<double> network;  // alpha in microseconds, beta in nanoseconds a byte
    bool strict = false, no_tuned = false;
};

std::uint32_t side_of(const LaboratoryCommand& command) {
    constexpr std::uint32_t kSmallest = 17, kLargest = 4096;  // the paper's offset 16 must be one of the image's
    if (!command.size) return 0;
    if (*command.size < kSmallest || *command.size > kLargest)
        throw UserError(fmt::format("--size {}: must be {}..{} pixels a side", *command.size, kSmallest, kLargest));
    return *command.size;
}

std::optional<Network> network_of(const LaboratoryCommand& command) {
    if (command.network.empty()) return {};
    const std::vector<double>& n = command.network;
    const auto is_time = [](double time) { return time >= 0 && time <= 1e9; };
    if (n.size() != 2 || !is_time(n[0]) || !is_time(n[1]))
        throw UserError(
            fmt::format("--network {}: must be two numbers, 0..10^9: microseconds a message, nanoseconds a byte",
                        fmt::join(n, ",")));
    return Network{1e-6 * n[0], 1e-9 * n[1]};
}

bool names_a_study(const std::string& word) {
    return std::any_of(studies().begin(), studies().end(), [&](const Study& study) { return study.name == word; });
}

std::vector<LabelledScene> named_scenes(const LaboratoryCommand& command) {
    std::vector<LabelledScene> scenes;
    for (const std::string& file : command.scenes) {
        std::error_code error;
        if (names_a_study(file) && !fs::exists(file, error))
            throw UserError(fmt::format(
                "{} is a study, no scene: studies run one at a time, all of them with raya study all", file));
        scenes.push_back({file, read_scene(file, command.strict).scene});
    }
    return scenes;
}

void print_page(const StudyPage& page, const PlotOutcome& plots, const fs::path& folder) {
    fmt::print("{}\n", page.title);
    for (const Comparison& c : page.comparisons) {
        fmt::print("  {:<34} {:>12.5g} {:<4}", c.what, c.ours, c.unit);
        if (c.paper) fmt::print(" paper {:.5g}, ratio {:.3f}", *c.paper, c.ours / *c.paper);
        fmt::print("{}\n", c.remark.empty() ? "" : "  (" + c.remark + ")");
    }
    for (const std::string& finding : page.findings) fmt::print("  {}\n", finding);
    if (!plots.drawn) fmt::print("  no plots: {}\n", plots.reason);
    fmt::print("  {}\n", printable((folder / (page.name + ".md")).string()));
}

// What makes the page of one study, wherever it is to be written.
RunRecord record_of(const Study& study, const LaboratoryCommand& command, const DeviceInfo& device) {
    std::string line = "raya study " + study.name;
    for (const std::string& scene : command.scenes) {
        line += ' ' + quoted(scene);
        if (study.one_scene) break;
    }
    if (command.size) line += fmt::format(" --size {}", *command.size);
    if (!command.network.empty()) line += fmt::format(" --network {}", fmt::join(command.network, ","));
    if (command.strict) line += " --strict";
    if (!command.device.empty()) line += " --device " + quoted(command.device);
    if (command.no_tuned) line += " --no-tuned";
    return {raya_version(), line + " -o DIR", device.name, device.platform, device.driver};
}

std::string stage_of(std::span<const Study> wanted, std::size_t at) {
    if (wanted.size() == 1) return "study " + wanted[at].name;
    const std::string next = at + 1 < wanted.size() ? "next " + wanted[at + 1].name : "the last";
    return fmt::format("study {}, {} of {} done, {}", wanted[at].name, at, wanted.size(), next);
}

// What can be run here; one study alone that cannot is refused, of several each is left out, and that is said.
std::vector<Study> runnable(std::span<const Study> wanted) {
    std::vector<Study> some;
    for (const Study& study : wanted) {
        const std::string lack = study.lack ? study.lack() : "";
        if (lack.empty())
            some.push_back(study);
        else if (wanted.size() == 1)
            throw UserError(fmt::format("study {}: {}", study.name, lack));
        else
            warn(fmt::format("study {} is left out: {}", study.name, lack));
    }
    return some;
}

void run_studies(const LaboratoryCommand& command, std::span<const Study> asked) {
    const std::optional<Network> network = network_of(command);
    const std::vector<Study> wanted = runnable(asked);
    if (wanted.size() == 1 && wanted.front().one_scene && command.scenes.size() > 1)
        throw UserError(
            fmt::format("study {} takes one scene, {} were given: run it for each, into a folder of its own",
                        wanted.front().name, command.scenes.size()));
    const std::uint32_t side = side_of(command);
    const std::vector<LabelledScene> scenes = named_scenes(command);
    std::vector<std::string> files;
    for (const Study& study : wanted)
        for (const char* end : {".md", ".json"}) files.push_back(study.name + end);
    files.emplace_back("index.html");
    if (wanted.size() > 1) files.emplace_back("index.md");
    ProgressBar bar(true, "preparing");
    const TunedUse tuned = use_tuned(command.no_tuned);
    Session session(choose_device(command.device));  // before the folder: a device that there is not leaves none behind
    const StudyFolder made(command.folder, files);
    Laboratory laboratory(session, side, network);
    std::vector<StudyPage> pages;
    std::vector<PlotOutcome> plots;
    for (std::size_t i = 0; i < wanted.size(); ++i) {
        bar.stage(stage_of(wanted, i));
        pages.push_back(wanted[i].run(laboratory, scenes));
        pages.back().run = record_of(wanted[i], command, session.device());
        plots.push_back(write_page(command.folder, pages.back()));
        clear_status();
        if (!is_quiet()) print_page(pages.back(), plots.back(), command.folder);
        std::fflush(stdout);  // how far it has come shows in a log too
    }
    write_document(command.folder, pages, plots);
    if (wanted.size() > 1) write_index(command.folder, pages);
    if (!is_quiet()) fmt::print("{}\n", printable((fs::path(command.folder) / "index.html").string()));
}

void add_study(CLI::App& parent, const std::string& name, const std::string& summary, std::span<const Study> wanted) {
    CLI::App* command = parent.add_subcommand(name, summary);
    add_study_examples(*command);
    const auto options = std::make_shared<LaboratoryCommand>();
    OptionGroup group(*command, kFiles);
    add_file(*command, FileUse::kWrittenFolder, "-o,--output", options->folder, "DIR",
             "Folder for index.html, to be read; Markdown, CSV, JSON and plots beside it; made if missing")
        ->required();
    add_file(
        *command, FileUse::kRead, "SCENE", options->scenes, "SCENE.nff",
        wanted.size() > 1
            ? "Scenes in NFF, one of them - for stdin; studies of one scene take the first; default: each study's own"
        : wanted.front().one_scene ? "Scene in NFF; -: stdin; default: centre, the paper's kind"
                                   : "Scenes in NFF, one of them - for stdin; default: the study's own");
    group.next(kPicture);
    add_value(*command, "--size", options->size,
              "Image size in pixels a side, 17..4096; default: the study's, mostly 256")
        ->type_name("N");
    group.next(kMachine);
    if (wanted.front().name == "ranks")
        add_value(*command, "--network", options->network,
                  "A network of yours beside those of the study: what a message takes in microseconds, and a byte in "
                  "nanoseconds; such as 30,0.8")
            ->delimiter(',')
            ->allow_extra_args(false)  // what follows is a scene
            ->type_name("ALPHA,BETA");
    add_strict_option(*command, options->strict);
    add_device_option(*command, options->device);
    add_tuned_option(*command, options->no_tuned);
    command->callback([options, wanted] { run_studies(*options, wanted); });
}

}  // namespace

void add_laboratory_studies(CLI::App& study) {
    for (const Study& one : studies()) add_study(study, one.name, one.summary, {&one, 1});
    add_study(study, "all", "All studies of the load laboratory, and one document of them", studies());
}

}  // namespace raya
