// raya render: a scene file in, an image and a load report out.
#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <set>

#include "cli/commands.hpp"
#include "cli/parse.hpp"
#include "cli/render_options.hpp"
#include "error.hpp"
#include "image/image_io.hpp"
#include "machine/budget.hpp"
#include "report/progress.hpp"
#include "report/render_report.hpp"
#include "report/whole_file.hpp"
#include "ring/mapping.hpp"
#include "scene/nff_reader.hpp"

namespace raya {
namespace {

struct RenderCommand {
    RenderOptions render;
    std::string image, cost, mask, report;
    bool profile = false, quiet = false;
};

// A file that is named twice would be written over by the other one.
void check_distinct(const std::vector<std::string>& files) {
    std::set<std::filesystem::path> seen;
    for (const std::string& file : files)
        if (!file.empty() && !file.starts_with("/dev/") && !seen.insert(std::filesystem::weakly_canonical(file)).second)
            throw UserError(fmt::format(
                "{}: named twice; scene, image, cost image, mask and report must be different files", file));
}

void check_targets(const RenderCommand& command) {
    check_distinct({command.render.scene, command.image, command.cost, command.mask, command.report});
    check_writable_target(command.image, kImageExtensions);
    if (!command.cost.empty()) check_writable_target(command.cost, kGreyImageExtensions);
    if (!command.mask.empty()) check_writable_target(command.mask, kImageExtensions);
    if (!command.mask.empty() && command.render.antialias != "supersample")
        throw UserError("--mask shows which pixels were supersampled: give --antialias supersample as well");
    if (!command.report.empty()) check_writable(command.report);
}

RingResult render_with_progress(RingRenderer& renderer, bool wanted) {
    ProgressBar bar(wanted);
    return renderer.render(bar.active() ? [&](double done) { bar.update(done); } : ProgressCallback{});
}

std::optional<Antialiasing> antialiasing(const RingSettings& settings, const RingResult& result) {
    const Antialias& a = settings.antialias;
    if (a.method == AntialiasMethod::kNone) return {};
    Antialiasing report;
    report.method = antialias_name(a.method);
    report.band_pixels = result.pe_memory.band_pixels;
    if (a.method == AntialiasMethod::kFilter) return report;
    report.points = points_name(a.points);
    report.threshold = a.threshold;
    report.recomputed = result.recomputed;
    report.recomputed_share = static_cast<double>(result.recomputed) / (1.0 * result.image.width * result.image.height);
    return report;
}

std::optional<ModelledTime> modelled(const RingSettings& settings, const RingResult& result) {
    std::vector<Load> loads;
    for (const Phase& phase : result.phases) loads.push_back(phase.load);
    return modelled_time(settings.machine, loads, result.communication, 1,
                         smoothing_cycles(settings.antialias.method, largest_share(settings.mapping)));
}

RenderReport make_report(const RenderCommand& command, const RingSettings& settings, const DeviceInfo& device,
                         const RingResult& result) {
    RenderReport report;
    report.scene = command.render.scene;
    report.image = {result.image.width, result.image.height, command.image, pixel_hash(result.image)};
    report.machine = {.name = settings.machine.name,
                      .topology = settings.machine.topology,
                      .mapping = mapping_text(settings.mapping),
                      .fold = {},
                      .format = format_name(settings.format),
                      .pes = settings.mapping.pes,
                      .offset = {},
                      .bounces = settings.bounces,
                      .pe_memory_bytes = settings.machine.pe_memory_bytes.value_or(0),
                      .pe_memory_used_bytes = result.pe_memory.bytes()};
    if (settings.dynamic) {
        report.machine.mapping = dynamic_text(*settings.dynamic);
    } else if (raya_has_slots(settings.mapping)) {
        const bool column = command.render.mapping == "column";
        report.machine.mapping = column ? "column" : "cyclic";
        report.machine.fold = settings.mapping.kind == RAYA_FOLD_BLOCK ? "block" : "cyclic";
        report.machine.offset = settings.mapping.parameter;
    }
    report.device = {device.name,          device.platform, device.version,
                     result.build_options, result.lanes,    result.group_size};
    report.events = result.all.events;
    report.load = result.all.load;
    report.requests = result.requests;
    for (const Phase& phase : result.phases) report.loads.emplace_back(phase.name, phase.load);
    report.antialias = antialiasing(settings, result);
    report.communication = result.communication;
    report.modelled = modelled(settings, result);
    report.measured = {result.build_s, result.render_s, result.commands};
    return report;
}

// Floats hold whole numbers up to 2^24; beyond, the file has the nearest they hold.
GreyImage grey(const CostImage& cost) {
    return {static_cast<int>(cost.width), static_cast<int>(cost.height), {cost.cycles.begin(), cost.cycles.end()}};
}

ImageAttributes image_attributes(const RenderReport& report, const std::string& scene) {
    ImageAttributes attributes = {{"scene", scene},
                                  {"machine", report.machine.name},
                                  {"mapping", report.machine.mapping},
                                  {"format", report.machine.format},
                                  {"u", fmt::format("{:.6f}", report.load.imbalance)}};
    if (report.machine.offset) attributes.emplace_back("offset", std::to_string(*report.machine.offset));
    return attributes;
}

void render(const RenderCommand& command) {
    check_targets(command);
    const Scene scene = read_nff(command.render.scene);
    const RingSettings settings = ring_settings(command.render, scene);
    Session session(choose_device(command.render.device));
    RingRenderer renderer(session, scene, settings);
    const RingResult result = render_with_progress(renderer, !command.quiet);

    const RenderReport report = make_report(command, settings, session.device(), result);
    const ImageAttributes attributes = image_attributes(report, scene.name);
    write_image(command.image, result.image, attributes);
    if (!command.cost.empty()) write_image(command.cost, grey(result.all.cost), attributes);
    if (!command.mask.empty()) write_image(command.mask, result.mask, attributes);
    if (!command.report.empty()) write_whole_file(command.report, to_json(report).dump(2) + "\n");
    if (!command.quiet) fmt::print("{}", human_summary(report));
    if (command.profile) fmt::print("\n{}", profile_table(report.measured.commands));
}

}  // namespace

void add_render_command(CLI::App& program) {
    CLI::App* command = program.add_subcommand("render", "Render an NFF scene on the ring machine");
    const auto options = std::make_shared<RenderCommand>();
    command->add_option("SCENE", options->render.scene, "Scene in NFF, as the SPD programs write it")
        ->required()
        ->type_name("SCENE.nff");
    command->add_option("-o,--output", options->image, "Image to write: .png (sRGB), .exr or .pfm (linear)")
        ->required()
        ->type_name("IMAGE");
    add_render_options(*command, options->render);
    command->add_option("--cost", options->cost, "Write the modelled cycles of each pixel as an image, .exr or .pfm")
        ->type_name("FILE.exr");
    command->add_option("--mask", options->mask, "Write which pixels were supersampled, white on black")
        ->type_name("IMAGE");
    command->add_option("--report", options->report, "Write everything that was counted and measured")
        ->type_name("FILE.json");
    command->add_flag("--profile", options->profile, "Print launches and times of every labelled command");
    command->add_flag("--quiet", options->quiet, "Print neither summary nor progress bar");
    refuse_odd_values(*command);
    command->callback([options] { render(*options); });
}

}  // namespace raya
