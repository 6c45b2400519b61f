// raya study STUDY [SCENE...] -o DIR: starts the Python module raya.lab (tools/lab), which runs studies, divides them
// into shards, merges shards and checks manifests.
#include <fmt/core.h>
#include <fmt/ranges.h>
#include <sys/stat.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <optional>
#include <sstream>
#include <system_error>

#include "host/base/json.hpp"
#include "host/base/log.hpp"
#include "host/base/module.hpp"
#include "host/cli/command_tree.hpp"
#include "host/cli/commands.hpp"
#include "host/cli/options.hpp"
#include "host/cli/parse.hpp"
#include "host/cli/parse_failure.hpp"
#include "host/cli/scene_input.hpp"
#include "host/embedded.hpp"
#include "host/error.hpp"

namespace raya {
namespace {

namespace fs = std::filesystem;

struct StudyCommand {
    std::string study, folder, device, shard, manifest;
    std::vector<std::string> merged, searched;  // folders of shards: to merge, and to search for missing ones
    std::optional<std::uint32_t> size, views;
    std::uint32_t seed = 1;
    std::vector<std::string> scenes;
    std::vector<double> network;  // alpha in microseconds per message, beta in nanoseconds per byte
    bool strict = false, no_tuned = false;
};

// Returns [name, summary] of each study in tools/lab/studies.txt.
std::vector<std::array<std::string, 2>> listed_studies() {
    std::istringstream lines(embedded_files().at("tools/lab/studies.txt"));
    std::vector<std::array<std::string, 2>> studies;
    for (std::string line; std::getline(lines, line);) {
        const std::size_t colon = line.find(": ");
        studies.push_back({line.substr(0, colon), line.substr(colon + 2)});
    }
    return studies;
}

std::vector<std::string> study_names() {
    std::vector<std::string> names;
    for (const auto& [name, summary] : listed_studies()) names.push_back(name);
    names.emplace_back("all");
    return names;
}

// Returns the footer of the command's help: the list of studies.
std::string studies_text() {
    std::string text = "Studies:\n";
    for (const auto& [name, summary] : listed_studies()) text += fmt::format("  {}   {}\n", name, summary);
    return text + '\n';
}

void check_study(const StudyCommand& command) {
    // A manifest contains the study and its settings.
    const bool repeats = !command.searched.empty() || !command.manifest.empty();
    if (!repeats && command.study.empty())
        throw UserError("STUDY is required; raya help study lists the studies; remedy: raya study NAME -o DIR");
    if (command.folder.empty() && command.searched.empty() && command.manifest.empty())
        throw UserError("--output is required; remedy: raya study NAME -o DIR");
    if (!command.folder.empty() && !command.searched.empty())
        throw UserError("--output with --missing: no effect; leave it out");
    if (!command.shard.empty()) parse_shard(command.shard);
    if (command.folder == "-") throw UserError("-o -: a study writes several files, not stdout; name a folder");
    if (repeats && command.study.empty()) return;
    const std::vector<std::string> names = study_names();
    const auto is_study = [&](const std::string& name) { return std::ranges::find(names, name) != names.end(); };
    if (!is_study(command.study) && !command.study.ends_with(".py"))
        throw UserError(
            fmt::format("no study {}{}; raya help study lists the studies; your own study is a file FILE.py",
                        command.study, did_you_mean(command.study, names)));
    std::error_code error;
    if (!is_study(command.study) && !fs::is_regular_file(command.study, error))
        throw UserError(fmt::format("{}: no such file", command.study));
    for (const std::string& scene : command.scenes)
        if (is_study(scene) && !fs::exists(scene, error))
            throw UserError(fmt::format(
                "{} is a study, not a scene; run one study at a time, or all studies with raya study all", scene));
    constexpr std::uint32_t kMinStudySide = 17, kMaxStudySide = 4096;  // the width must exceed the paper's offset, 16
    if (command.size && (*command.size < kMinStudySide || *command.size > kMaxStudySide))
        throw UserError(
            fmt::format("--size {}: must be {}..{} pixels a side", *command.size, kMinStudySide, kMaxStudySide));
    constexpr std::uint32_t kMinViews = 20, kMaxViews = 5'000, kMaxSeed = 90'000;
    if (command.views && (*command.views < kMinViews || *command.views > kMaxViews))
        throw UserError(fmt::format("--views {}: must be {}..{}", *command.views, kMinViews, kMaxViews));
    if (command.seed < 1 || command.seed > kMaxSeed)
        throw UserError(fmt::format("--seed {}: must be 1..{}", command.seed, kMaxSeed));
    const std::vector<double>& times = command.network;
    const auto is_time = [](double time) { return time >= 0 && time <= 1e9; };
    if (!times.empty() && (times.size() != 2 || !std::ranges::all_of(times, is_time)))
        throw UserError(
            fmt::format("--network {}: must be two numbers, 0..10^9: microseconds per message, nanoseconds per byte",
                        fmt::join(times, ",")));
    if (!times.empty() && command.study != "ranks" && command.study != "all")
        throw UserError(
            fmt::format("--network applies to study ranks only, not to study {}; leave it out", command.study));
}

// Returns the settings that tools/lab/__main__.py reads.
Json settings_of(const StudyCommand& command) {
    Json settings = {
        {"study", command.study},   {"scenes", command.scenes},     {"output", command.folder}, {"size", nullptr},
        {"network", nullptr},       {"device", command.device},     {"views", nullptr},         {"seed", command.seed},
        {"strict", command.strict}, {"no_tuned", command.no_tuned}, {"verbosity", verbosity()}, {"shard", nullptr},
        {"merge", command.merged},  {"missing", command.searched},  {"check", command.manifest}};
    if (!command.shard.empty()) {
        const Shard shard = parse_shard(command.shard);
        settings["shard"] = std::vector{shard.number, shard.count};
    }
    if (command.size) settings["size"] = *command.size;
    if (command.views) settings["views"] = *command.views;
    if (!command.network.empty()) settings["network"] = command.network;
    return settings;
}

void add_shard_options(CLI::App& command, StudyCommand& options) {
    add_value(command, "--shard", options.shard,
              "Compute the I-th of N parts of the study's cost images, and write them to the folder of -o; the same "
              "command continues after a stop")
        ->type_name("I/N");
    CLI::Option* const merge = add_file(command, FileUse::kRead, "--merge", options.merged, "DIR...",
                                        "Folders of all N shards of this study, with these scenes: write its results");
    CLI::Option* const missing =
        add_file(command, FileUse::kRead, "--missing", options.searched, "DIR...",
                 "Folders of shards: list the shards that are absent, incomplete or damaged (exit code 4)");
    CLI::Option* const check =
        add_file(command, FileUse::kRead, "--check", options.manifest, "FILE",
                 "Repeat the study of a manifest.json and compare the results (exit code 4: they differ)");
    for (CLI::Option* const option : {merge, missing, check}) option->excludes("--shard");
    merge->excludes(missing)->excludes(check);
    missing->excludes(check);
}

void add_study_options(CLI::App& command, StudyCommand& options) {
    OptionGroup group(command, kFiles);
    CLI::Option* const study =
        add_file(command, FileUse::kRead, "STUDY", options.study, "STUDY|all|FILE.py",
                 "Name of a study in the list below, all for all studies, or a file with your own study; may be left "
                 "out with --missing and --check");
    offer_choices(study, study_names());
    add_file(command, FileUse::kRead, "SCENE", options.scenes, "SCENE",
             "Scenes in NFF, or meshes (.obj, .ply, .gltf, .glb, .stl); one of them may be -: stdin; with `all`, "
             "studies of a single scene take the first scene; "
             "default: the study's own scenes");
    add_file(command, FileUse::kWrittenFolder, "-o,--output", options.folder, "DIR",
             "Folder for index.html, Markdown, CSV, JSON, plots and manifest.json; with --shard, for the shard's "
             "results; created if missing");
    add_shard_options(command, options);
    group.next(kImageGroup);
    add_value(command, "--size", options.size,
              "Image size in pixels a side, 17..4096; default: the study's size, 256 in most studies")
        ->type_name("N");
    add_value(
        command, "--views", options.views,
        "Number of pictures in the ensembles of the studies of load, 20..5000, divided among the nine scene families "
        "and rounded up to as many of each; default: 108")
        ->type_name("N");
    add_value(
        command, "--seed", options.seed,
        "Seed S of the first picture of a family, 1..90000; the next pictures have the seeds S + 1, ...; default: 1")
        ->type_name("S");
    group.next(kMachine);
    add_value(command, "--network", options.network,
              "For study ranks: add a network with a latency ALPHA in microseconds per message and a time BETA in "
              "nanoseconds per byte, such as 30,0.8")
        ->delimiter(',')
        ->allow_extra_args(false)  // so that a scene may follow
        ->type_name("ALPHA,BETA");
    add_strict_option(command, options.strict);
    add_device_option(command, options.device);
    add_tuned_option(command, options.no_tuned);
    for (const char* const repeating :
         {"--merge", "--missing", "--check"})  // their settings are in shards and manifest
        for (const char* const option : {"--size", "--views", "--seed", "--network", "--strict", "--no-tuned"})
            command.get_option(repeating)->excludes(option);
}

// Returns the folder that contains the Python package raya, in the build folder or in the installation of `program`.
// Returns an empty path if neither contains the package.
fs::path package_folder(const fs::path& program) {
    std::error_code error;
    for (const fs::path& folder :
         {program.parent_path() / "python", program.parent_path().parent_path() / "lib/python3/dist-packages"})
        if (fs::is_directory(folder / "raya/lab", error)) return fs::canonical(folder);
    return {};
}

// Refuses a module folder in which other users can change files.
void check_module_folder(const fs::path& folder) {
    struct stat status {};
    ::stat(folder.c_str(), &status);
    const std::string why = unsafe_path_reason(folder / "raya", {::geteuid(), status.st_uid}, Sticky::kRefused);
    if (!why.empty()) throw UserError(fmt::format("refused to run '{}': {}; remedy: chmod go-w", folder.string(), why));
}

[[noreturn]] void start_lab_module(const std::string& settings) {
    const char* const python_variable = std::getenv("RAYA_PYTHON");
    const std::string python =
        python_variable != nullptr && *python_variable != '\0' ? python_variable : "/usr/bin/python3";
    const fs::path program = fs::read_symlink("/proc/self/exe"), folder = package_folder(program);
    if (folder.empty() && python_variable == nullptr)
        throw UserError(
            "study needs the Python module raya, and this program was built without it; remedy: tools/setup, then "
            "build again, or set RAYA_PYTHON to a Python that has the module");
    if (!folder.empty()) {
        check_module_folder(folder);
        const char* const path = std::getenv("PYTHONPATH");
        const std::string further_folders = path != nullptr && *path != '\0' ? fmt::format(":{}", path) : "";
        ::setenv("PYTHONPATH", (folder.string() + further_folders).c_str(), 1);
    }
    ::setenv("PYTHONSAFEPATH", "1", 1);  // Python imports no modules from the working folder
    ::setenv("RAYA_PROGRAM", program.c_str(), 1);
    // Until raya.lab handles signals, Ctrl-C ends Python without a traceback, but not before Python can unblock it.
    constexpr const char* kStart =
        "import runpy, signal; signal.getsignal(2) == signal.SIG_IGN or signal.signal(2, signal.SIG_DFL); "
        "signal.pthread_sigmask(signal.SIG_UNBLOCK, [2]); "
        "runpy.run_module('raya.lab', run_name='__main__', alter_sys=True)";
    sigset_t interruption;
    ::sigemptyset(&interruption);
    ::sigaddset(&interruption, SIGINT);
    ::sigprocmask(SIG_BLOCK, &interruption, nullptr);
    ::execlp(python.c_str(), python.c_str(), "-c", kStart, "--settings", settings.c_str(), nullptr);
    throw UserError(
        fmt::format("study needs Python: cannot start {}: {}; remedy: sudo apt-get install python3, or "
                    "set RAYA_PYTHON to another Python",
                    python, std::generic_category().message(errno)));
}

}  // namespace

void add_study_command(CLI::App& program, const std::function<void(const std::string&)>& run) {
    CLI::App* command = program.add_subcommand("study", "Run series of renders that test the papers' claims");
    add_examples(*command, {{"raya study fig8 scenes/mirrors.nff --size 64 -o mirrors",
                             "Run one study at a small size; open mirrors/index.html in a browser"},
                            {"raya study all -o studies", "Run all studies and write one document"}});
    command->footer(studies_text() + command->get_footer());
    const auto options = std::make_shared<StudyCommand>();
    add_study_options(*command, *options);
    command->callback([options, run] {
        check_study(*options);
        const std::string settings = settings_of(*options).dump();
        run ? run(settings) : start_lab_module(settings);
    });
}

}  // namespace raya
