// raya study NAME: measurements over many renders, written as tables. Each study adds its own command here.
#include <fmt/core.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <optional>

#include "host/base/json.hpp"
#include "host/base/progress.hpp"
#include "host/base/say.hpp"
#include "host/base/standard_streams.hpp"
#include "host/base/verbosity.hpp"
#include "host/base/whole_file.hpp"
#include "host/cli/commands.hpp"
#include "host/cli/file_options.hpp"
#include "host/cli/help_formatter.hpp"
#include "host/cli/options.hpp"
#include "host/cli/parse.hpp"
#include "host/cli/scene_input.hpp"
#include "host/cli/studies.hpp"
#include "host/cli/tuned_option.hpp"
#include "host/error.hpp"
#include "host/report/table.hpp"
#include "host/study/formats_report.hpp"
#include "host/study/formats_study.hpp"

namespace raya {
namespace {

namespace fs = std::filesystem;

struct FormatsCommand {
    std::string folder, size = "256", device;
    std::vector<std::string> scenes, formats;
    std::optional<std::uint32_t> lanes;
    std::uint32_t samples = 5;
    bool strict = false, no_tuned = false;
};

// Each format once, in the order given; fp32 is always there.
std::vector<NumberFormat> formats_of(const FormatsCommand& command) {
    if (command.formats.empty()) return reduced_formats();
    std::vector<NumberFormat> formats;
    for (const std::string& name : command.formats) {
        const NumberFormat format = parse_format(name);
        const bool known = format.is_fp32() || std::find(formats.begin(), formats.end(), format) != formats.end();
        if (!known) formats.push_back(format);
    }
    return formats;
}

FormatsSettings formats_settings(const FormatsCommand& command) {
    if (command.samples < 1 || command.samples > 1000)
        throw UserError(fmt::format("--samples {}: must be 1..1000", command.samples));
    if (command.lanes == 0u) throw UserError("--lanes 0: must be 1, 4, 8 or 16");
    const ImageSize size = parse_image_size(command.size);
    FormatsSettings settings;
    settings.width = size.width;
    settings.height = size.height;
    settings.lanes = command.lanes.value_or(0);
    settings.samples = command.samples;
    settings.formats = formats_of(command);
    return settings;
}

std::vector<LabelledScene> scenes_of(const FormatsCommand& command) {
    if (command.scenes.empty()) return embedded_study_scenes();
    std::vector<LabelledScene> scenes;
    for (const std::string& file : command.scenes) scenes.push_back({file, read_scene(file, command.strict).scene});
    return scenes;
}

FormatsStudy run_with_progress(Session& session, const std::vector<LabelledScene>& scenes,
                               const FormatsSettings& settings) {
    ProgressBar bar(true, "study formats");
    return run_formats_study(session, scenes, settings,
                             bar.active() ? [&](double done) { bar.update(done); } : ProgressCallback{});
}

void study_formats(const FormatsCommand& command) {
    const FormatsSettings settings = formats_settings(command);
    const std::vector<LabelledScene> scenes = scenes_of(command);
    const fs::path folder = command.folder;
    const TunedUse tuned = use_tuned(command.no_tuned);
    Session session(choose_device(command.device));  // before the folder: a device that there is not leaves none behind
    const StudyFolder made(folder, {"formats.csv", "formats.json", "formats.md"});
    const FormatsStudy study = run_with_progress(session, scenes, settings);
    write_whole_file(folder / "formats.csv", formats_csv(study));
    write_whole_file(folder / "formats.json", formats_json(study).dump(2) + "\n");
    write_whole_file(folder / "formats.md", formats_markdown(study));
    if (!is_quiet()) fmt::print("{}", printable(text_table(formats_overview_cells(study))));
}

void add_timing_options(CLI::App& command, FormatsCommand& options) {
    const OptionGroup group(command, "What is measured");
    add_value(command, "--samples", options.samples,
              "Timed renders of each scene and format, 1..1000; the least time counts")
        ->type_name("N")
        ->capture_default_str();
    add_value(command, "--lanes", options.lanes,
              "Rays that a work-item traces at once: 1, 4, 8 or 16; default: the device's")
        ->type_name("V");
    add_device_option(command, options.device);
}

void add_formats_study(CLI::App& study) {
    CLI::App* command = study.add_subcommand(
        "formats",
        "PSNR, errors and time of fp32 and the reduced number formats against the double-precision reference");
    add_study_examples(*command);
    const auto options = std::make_shared<FormatsCommand>();
    OptionGroup group(*command, kFiles);
    add_file(*command, FileUse::kWrittenFolder, "-o,--output", options->folder, "DIR",
             "Folder for formats.csv, formats.json and formats.md; made if missing")
        ->required();
    add_file(*command, FileUse::kRead, "SCENE", options->scenes, "SCENE.nff",
             "Scenes in NFF, one of them - for stdin; default: the project's centre, spheres, glass, polygons, cones");
    group.next("What is measured");
    add_value(*command, "--format", options->formats,
              "Formats beside fp32, with commas between: spa22 (e6m15) or eXmY[t]: X = 5..8, Y = 4..21, t "
              "truncates; default: e8m21, e8m18, e8m15, e7m15, e6m15, e6m14, e6m13, without and with t")
        ->delimiter(',')
        ->allow_extra_args(false)  // what follows is a scene
        ->type_name("NAME,...");
    group.next(kPicture);
    add_value(*command, "--size", options->size, "Image size in pixels, 1..16384 a side")
        ->type_name("N|WxH")
        ->capture_default_str();
    add_strict_option(*command, options->strict);
    add_timing_options(*command, *options);
    add_tuned_option(*command, options->no_tuned);
    command->callback([options] { study_formats(*options); });
}

}  // namespace

void add_study_examples(CLI::App& command) {
    const std::string& name = command.get_name();
    add_examples(command,
                 {{fmt::format("raya study {0} -o {0}", name), "On the study's own scenes, into a folder of its own"},
                  {fmt::format("raya study {0} scenes/mirrors.nff --size 64 -o small-{0}", name),
                   "On another scene, in a small size, to see what it is about"}});
}

StudyFolder::StudyFolder(const fs::path& folder, const std::vector<std::string>& files) {
    if (is_standard_stream(folder))
        throw UserError("-o -: a study is many files, which stdout cannot hold; name a folder");
    std::error_code error;
    for (fs::path missing = folder; !missing.empty() && !fs::exists(missing, error); missing = missing.parent_path())
        made_.push_back(missing);
    fs::create_directories(folder, error);
    if (error) throw UserError(fmt::format("-o {}: cannot create directory: {}", folder.string(), error.message()));
    for (const std::string& file : files) check_writable(folder / file);
}

StudyFolder::~StudyFolder() {
    std::error_code error;  // of a folder that has something in it
    for (const fs::path& folder : made_) fs::remove(folder, error);
}

void add_study_command(CLI::App& program) {
    CLI::App* command = program.add_subcommand("study", "Measure over many renders and write tables");
    add_examples(*command, {{"raya study fig7 -o fig7", "One study; open fig7/index.html in a browser"},
                            {"raya study all -o studies", "Every study, and one document of them all"}});
    command->require_subcommand(1);
    add_laboratory_studies(*command);
    add_formats_study(*command);
}

}  // namespace raya
