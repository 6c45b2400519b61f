// raya render: renders a scene file into an image and a load report.
#include <memory>

#include "host/cli/command_tree.hpp"
#include "host/cli/commands.hpp"
#include "host/cli/options.hpp"
#include "host/cli/parse.hpp"
#include "host/cli/render_command.hpp"

namespace raya {
namespace {

void render(const CLI::App& parser, const RenderCommand& command, Ranks& ranks) {
    refuse_options_of_other_machines(parser, machine_named(command.render.machine));
    if (ranks.is_first()) check_render(parser, command);  // only rank 0 writes files
    RenderRun run(command, ranks);
    render_image(command, run);
}

}  // namespace

void check_render(const CLI::App& parser, const RenderCommand& command) {
    check_trace(parser, command.trace);
    if (command.counters && !command.needs_roofline())
        throw UserError("--counters: the counts are shown with the roofline: add --profile or --page FILE.html");
    check_checkpoint_options(parser, command.checkpoint);
    check_output_files(parser, command);
}

std::optional<Render> render_image(const RenderCommand& command, RenderRun& run) {
    return is_torus(command) ? render_on_torus(command, run) : render_on_ring(command, run);
}

void add_render_command_options(CLI::App& command, RenderCommand& options) {
    OptionGroup group(command, kFiles);
    add_file(command, FileUse::kWritten, "-o,--output", options.image, "IMAGE",
             "Image to write: .png, .tif, .ppm or .jpg (8-bit; JPEG with quality 95, lossy), .exr or .pfm (linear); -: "
             "stdout, as PPM. If a file goes to stdout, the summary goes to stderr",
             "Image to write: .png, .tif, .ppm, .jpg, .exr or .pfm");
    add_render_options(command, options.render);
    group.next(kImageGroup);
    add_value(command, "--exposure", options.exposure,
              "8-bit images: multiply colours by 2^EV, -64..64 stops; the report's hash does not change")
        ->type_name("EV")
        ->default_str("0");
    add_checkpoint_options(command, options.checkpoint);
    add_torus_options(command, options.torus);
    group.next(kDiagnostics);
    attach_note(add_file(command, FileUse::kWritten, "--cost", options.cost, "FILE.exr",
                         "Write the modelled cycles of each pixel as an image, .exr or .pfm; -: stdout, as PFM",
                         "Write the modelled cycles of each pixel"),
                kRingOnlyNote,
                "several nodes work for a pixel, so that no node has its cost; leave it out, or choose a ring: "
                "--machine grande");
    attach_note(add_file(command, FileUse::kWritten, "--mask", options.mask, "IMAGE",
                         "Write the mask of the supersampled pixels, white on black"),
                kRingOnlyNote, kNoNeighbours);
    add_file(command, FileUse::kWritten, "--report", options.report, "FILE.json",
             "Write all counts and measurements as JSON; -: stdout", "Write all counts and measurements; -: stdout");
    add_file(command, FileUse::kWritten, "--page", options.page, "FILE.html",
             "Write an HTML page: image, owners of pixels, loads, times by label, roofline, modelled and measured "
             "times, build options; raya page makes the same page from a report. Like --profile, measures the device's "
             "peak",
             "Write the report as an HTML page");
    attach_note(command.add_flag("--profile", options.profile,
                                 "Print the number of launches and the times of each labelled command, the build "
                                 "times, and which fraction of the device's measured peak each kernel reaches (the "
                                 "roofline)"),
                kBriefNote, "Print times by kernel and the roofline");
    add_trace_options(command, options.trace);
}

CLI::App* declare_render_command(CLI::App& program, const std::shared_ptr<RenderCommand>& options) {
    CLI::App* command = program.add_subcommand(
        "render", "Render a scene (NFF, OBJ, PLY, glTF or STL) on a ring machine or the torus machine");
    add_examples(*command, {{"raya render scenes/centre.nff -o centre.png",
                             "Render on a ring of 256 PEs, in the scene's resolution"},
                            {"raya render scenes/glass.nff --machine torus --size 64 --report glass.json -o glass.png",
                             "Render a small image on a torus of 64 nodes, with a report"}});
    command->callback([options] {});  // keeps the options
    const OptionGroup group(*command, kFiles);
    add_file(*command, FileUse::kRead, "SCENE", options->render.scene, "SCENE", kSceneHelp)->required();
    add_render_command_options(*command, *options);
    command->get_option("--output")->required();
    OptionGroup last_options(*command, kDiagnostics);
    command->add_flag(
        "--counters", options->counters,
        "With --profile or --page, and a CPU as the device: count processor time, page faults and, where "
        "Linux offers them, cycles, instructions, cache misses and branch misses of each kernel. The host "
        "waits for each launch, which makes renders with many launches slower");
    return command;
}

void add_render_command(CLI::App& program, Ranks& ranks) {
    const auto options = std::make_shared<RenderCommand>();
    CLI::App* const command = declare_render_command(program, options);
    command->callback([command, options, &ranks] { render(*command, *options, ranks); });
}

}  // namespace raya
