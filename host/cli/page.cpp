// raya page REPORT.json -o FILE.html: writes a report as an HTML page.
#include "host/cli/page.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <optional>

#include "host/base/encoding.hpp"
#include "host/base/log.hpp"
#include "host/base/whole_file.hpp"
#include "host/cli/commands.hpp"
#include "host/cli/help.hpp"
#include "host/cli/options.hpp"
#include "host/cli/render_options.hpp"
#include "host/error.hpp"
#include "host/image/image_io.hpp"
#include "host/model/number_format.hpp"
#include "host/report/bench_report.hpp"
#include "host/report/page/page.hpp"
#include "host/report/render_report.hpp"
#include "host/ring/mapping.hpp"
#include "host/ring/ring_renderer.hpp"
#include "host/verify/verify.hpp"
#include "host/version.hpp"

namespace raya {
namespace {

struct PageCommand {
    std::string report, page;
};

// Removes the folders from file names in the report, because users send pages to others.
Json without_folders(Json report) {
    const auto shorten = [](Json& object, const char* key) {
        const Json* const path = find_member(object, key);
        if (path != nullptr && path->is_string())
            object[key] = std::filesystem::path(json_text(*path)).filename().string();
    };
    const Json *const scene = find_member(report, "scene"), *const warnings = find_member(report, "warnings");
    if (scene != nullptr && scene->is_string() && warnings != nullptr) {
        const std::string file = json_text(*scene);
        Json shortened = Json::array();
        for (const std::string& text : json_strings(*warnings))
            shortened.push_back(text.starts_with(file + ':') ? text.substr(file.rfind('/') + 1) : text);
        report["warnings"] = shortened;
    }
    shorten(report, "scene");
    for (const auto& [part, key] : {std::pair{"image", "file"}, {"device", "tuned"}, {"compared", "baseline"}})
        if (report.contains(part)) shorten(report[part], key);
    return report;
}

void check_kind(const Json& report) {
    const Json* const kind = find_member(report, "kind");
    const std::string name = kind != nullptr && kind->is_string() ? json_text(*kind) : "";
    for (const char* known : {kRenderReportKind, kBenchReportKind, kVerifyReportKind, "raya gpu_day"})
        if (name == known) return;
    throw UserError("valid JSON, but not a report of raya render, bench, verify or gpu_day");
}

JsonSource report_source(const std::string& name) {
    return {name, "give a report that this version of raya render, bench or verify wrote with --report FILE.json"};
}

void make_page(const PageCommand& command) {
    check_page_name("-o", command.page);
    const std::string name = input_name(command.report);
    const std::string page = page_of_report(json_file_text(command.report, report_source(name)), name);
    write_whole_file(command.page, page);
    if (!is_quiet())
        fmt::print("page    {} ({:.0f} KB); open it in a browser; it needs no network\n", printable(command.page),
                   static_cast<double>(page.size()) / 1e3);
}

}  // namespace

void check_page_name(const std::string& option, const std::string& file) {
    if (!file.ends_with(".html") && !file.ends_with(".htm") && !file.starts_with("/dev/") && !is_standard_stream(file))
        throw UserError(fmt::format("{} {}: raya writes an HTML page; choose a name that ends in .html", option, file));
}

std::string page_of_report(const std::string& text, const std::string& name) {
    return read_json(text, report_source(name), [](const Json& report) {
        check_kind(report);
        return report_page(without_folders(report));
    });
}

void write_report_and_page(const ReportFiles& files, const Json& report) {
    if (!files.report.empty()) write_whole_file(files.report, json_dump(report, 2) + "\n");
    if (!files.page.empty()) write_whole_file(files.page, report_page(without_folders(report)));
}

void add_page_command(CLI::App& program) {
    CLI::App* command = program.add_subcommand("page", "Make an HTML page from a report of render, bench or verify");
    add_examples(*command,
                 {{"raya render scenes/planes.nff --report planes.json -o planes.png && raya page planes.json -o "
                   "planes.html",
                   "Make a page from the report of a render; render --page writes the page without this step"},
                  {"raya verify --brief --only number --report verify.json && raya page verify.json -o verify.html",
                   "Make a page of the checks of this device"}});
    const auto options = std::make_shared<PageCommand>();
    const OptionGroup group(*command, kFiles);
    add_file(*command, FileUse::kRead, "REPORT REPORT.json", options->report,
             "Report of raya render, bench or verify, written by --report")
        ->required();
    add_file(*command, FileUse::kWritten, "-o,--output FILE.html", options->page,
             "HTML page to write: one file that needs no network")
        ->required();
    command->callback([options] { make_page(*options); });
}

namespace {

/// Returns the argument in single quotes, or unchanged if no shell interprets any of its characters.
std::string quoted(const std::string& argument) {
    const bool plain = !argument.empty() && std::ranges::all_of(argument, [](unsigned char c) {
        return std::isalnum(c) || std::string_view("_-./:=+,%@").find(char(c)) != std::string_view::npos;
    });
    return plain ? argument : '\'' + replaced(argument, "'", "'\\''") + '\'';
}

struct ExploreCommand {
    RenderOptions render;
    std::string page;
};

RingSettings settings_of(const ExploreCommand& command, const Scene& scene) {
    RingSettings settings = ring_settings(command.render, scene);
    if (settings.dynamic)
        throw UserError(
            fmt::format("{}: the mapping is dynamic, but the explorer shows static mappings only; choose cyclic, "
                        "column, rows, blocks, grid, tiles or random{}",
                        command.render.mapping.empty() ? "--machine " + command.render.machine
                                                       : "--mapping " + command.render.mapping,
                        command.render.mapping.empty() ? " with --mapping" : ""));
    settings.record_costs = true;
    return settings;
}

// Returns the scene's file name without its folder. The folder is private, and users send pages to others.
std::string scene_name(const ExploreCommand& command) {
    return std::filesystem::path(input_name(command.render.scene)).filename().string();
}

// Returns the raya command that renders the same image. The page appends --mapping and --pes.
std::string command_of(const ExploreCommand& command, const RingSettings& settings) {
    const RenderOptions& o = command.render;
    std::string text = "raya render " + quoted(scene_name(command)) + " -o image.png";
    const auto add = [&](const char* option, const std::string& value) {
        if (!value.empty()) text += fmt::format(" {} {}", option, quoted(value));
    };
    add("--machine", o.machine == "spa" ? "" : o.machine);
    add("--size", o.size);
    add("--format", o.format);
    add("--bounces", o.bounces ? fmt::format("{}", settings.bounces) : "");
    add("--sampling", o.sampling == Sampling::kCorners ? "corners" : "");
    add("--accel", o.accel);
    add("--split", o.split ? fmt::format("{}", *o.split) : "");
    add("--pe-memory", o.pe_memory ? fmt::format("{}", *o.pe_memory) : "");
    for (const auto& [option, value] : o.view.given_options()) add(option.c_str(), value);
    return text;
}

// The page's data. The data contain no measured times, so that two runs with equal settings write equal pages.
struct Exploration {
    std::string scene, command;
    RingSettings settings{};
    DeviceInfo device{};
    int width = 0, height = 0;  // pixels
    std::string png;
    CostPlanes cost{};
    std::uint32_t parts = 1;  // of the objects
};

// The rates from which the page computes modelled times.
void rate_members(Members& m, const MachineClock& clock) {
    m("cycle_ns", clock.cycle_ns, "Time of one PE cycle, ns.");
    m("cycle_factor", clock.cycle_factor, "Number of the machine's cycles per cycle of the budgets.");
    m("setup_ms", clock.setup_ms, "Set-up time of an exchange of neighbouring pixels, ms.");
    m("link_words_per_s", clock.link_words_per_s, "Words per second over each link of the ring.");
    m("rotation_sync_ms", clock.rotation_sync_ms, "Time of the synchronisation before each rotation, ms.");
}

void machine_members(Members& m, const RingSettings& settings, std::uint32_t parts) {
    const raya_mapping& mapping = settings.mapping;
    const bool has_slots = raya_has_slots(mapping);
    m("name", settings.machine.name, "Name, as given to --machine.");
    m("pes", mapping.pes, "Number of PEs.");
    m("mapping", has_slots ? "cyclic" : mapping_text(mapping), "Mapping of pixels to PEs, as given to --mapping.");
    m("offset", has_slots ? std::optional(mapping.parameter) : std::nullopt,
      "Offset p of the cyclic mapping, pixels; null without an offset.");
    m("fold", has_slots ? std::optional(mapping.kind == RAYA_FOLD_BLOCK ? "block" : "cyclic") : std::nullopt,
      "Assignment of slots to PEs (--fold); null without slots.");
    m("format", format_name(settings.format), kFormatMeaning);
    m("bounces", settings.bounces, "Maximum number of reflections and refractions after the primary ray.");
    m("accel", accel_text(settings.accel), "Acceleration structure, as given to --accel.");
    m.when(parts > 1, "parts", parts, "Number of parts of the objects, which rotate on the ring (--split).");
    m("rates",
      "Rates of the machine, from which the page computes modelled times (host/model/machine.hpp, MachineClock).",
      [&](Members& rates) { rate_members(rates, settings.machine.clock); });
}

}  // namespace

static void members_of(Members& m, const Exploration& e) {
    m("kind", "raya explore", "Identifies the report: `raya explore`.");
    m("raya", raya_version(), kVersionMeaning);
    m("scene", e.scene, kSceneMeaning);
    m("command", e.command, "Command `raya render` of the same picture, without the mapping.");
    m("machine", "Modelled machine that the page shows first.",
      [&](Members& machine) { machine_members(machine, e.settings, e.parts); });
    m("device", "OpenCL device of the render.", [&](Members& device) { device_members(device, e.device); });
    m("image", "Rendered image at full size.", [&](Members& image) {
        image("width", e.width, "Width in pixels.");
        image("height", e.height, "Height in pixels.");
        image("png", base64(e.png), "PNG file in base64.");
    });
    m("cost", e.cost, "Modelled cycles of each pixel, row by row.");
}

Json explore_schema() {
    return schema_of<Exploration>("raya explore",
                                  "Data of the web page that `raya explore` writes: the modelled costs of one render, "
                                  "without measured times.");
}

namespace {

void explore(const ExploreCommand& command) {
    check_page_name("-o", command.page);
    std::optional<ProgressBar> bar(std::in_place, true, "reading the scene");
    SceneInput input = read_scene(command.render.scene, command.render.strict);
    change_view(command.render.view, input.scene);
    constexpr std::uint64_t kMaxPixels = 2'000'000;  // their page has about 2 MB
    if (const ImageSize size = image_size(command.render, input.scene);
        std::uint64_t{size.width} * size.height > kMaxPixels)
        throw UserError(fmt::format("--size {}x{}: too many pixels for a page, maximum {}; remedy: a smaller --size",
                                    size.width, size.height, kMaxPixels));
    const RingSettings settings = settings_of(command, input.scene);
    warn_of_slow_search(input.scene, settings.accel.kind != AccelKind::kNone, input.warnings);
    bar->stage("preparing");
    const ScopedTunedSource tuned = use_tuned(command.render.no_tuned, &input.warnings);
    warn_of_build_options(input.warnings);
    Session session(choose_device(command.render.device), Timing::kOff);
    RingRenderer renderer(session, input.scene, settings);
    warn_of_lost_objects(input.scene, renderer.scale(), settings.format, input.warnings);
    bar->stage("rendering");
    const RingResult result =
        renderer.render(bar->active() ? [&](double fraction) { bar->update(fraction); } : ProgressCallback{});
    bar->stage("writing");
    const std::string page = report_page(to_json(
        Exploration{scene_name(command), command_of(command, settings), settings, session.device(), result.image.width,
                    result.image.height, plain_png(result.image), cost_planes(result.cost().cycles), result.parts}));
    write_whole_file(command.page, page);
    bar.reset();
    if (is_quiet()) return;
    const Load load = static_load(result.cost(), settings.mapping);
    fmt::print("{}: {} x {} pixels; the page opens with {} on {}: u = {:.3f}, speed-up {:.1f}\n",
               printable(input_name(command.render.scene)), settings.mapping.width, settings.mapping.height,
               mapping_text(settings.mapping), counted(settings.mapping.pes, "PE"), load.imbalance, load.speedup);
    fmt::print("page    {} ({:.0f} KB); open it in a browser; it needs no network\n",
               printable(output_name(command.page)), static_cast<double>(page.size()) / 1e3);
}

}  // namespace

void add_explore_command(CLI::App& program) {
    CLI::App* command = program.add_subcommand(
        "explore", "Render once and write an interactive page of loads by mapping, offset and number of PEs");
    add_examples(*command, {{"raya explore scenes/centre.nff -o centre.html",
                             "Write a page that opens with 256 PEs, cyclic mapping, offset 16"},
                            {"raya explore scenes/mirrors.nff --size 128 --pes 64 --mapping blocks -o mirrors.html",
                             "Write a page that opens with 64 PEs and blocks of scan lines"}});
    const auto options = std::make_shared<ExploreCommand>();
    const OptionGroup group(*command, kFiles);
    add_file(*command, FileUse::kRead, "SCENE SCENE", options->render.scene, kSceneHelp)->required();
    add_file(*command, FileUse::kWritten, "-o,--output FILE.html", options->page,
             "HTML page to write: one file that needs no network; -: stdout", "HTML page to write; -: stdout")
        ->required();
    add_render_options(*command, options->render, false);
    command->get_option("--mapping")
        ->description(
            "Mapping that the page shows first: cyclic, cyclic:p, column, rows, blocks, grid:AxB, tiles:WxH, "
            "random:seed; default: the machine's, cyclic on spa");
    command->callback([options] { explore(*options); });
}

}  // namespace raya
