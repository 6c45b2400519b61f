// raya render: renders a scene file into an image and a load report.
#include <memory>

#include "host/cli/command_tree.hpp"
#include "host/cli/commands.hpp"
#include "host/cli/file_options.hpp"
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

std::vector<ShortHelp> render_short_help() {
    const char *const options = "Options", *const image = "Image", *const machine = "Machine", *const output = "Output";
    return {{"--output", options, "Image to write: .png, .tif, .ppm, .jpg, .exr or .pfm"},
            {"--size", options, "Size in pixels, 1..16384 a side; default: the scene's"},
            {"--machine", options,
             "spa (256 PEs of 32 KB), grande (a PE per image column), torus (nodes hold voxels), and others"},
            {"--pes", options, "Number of PEs; default: the machine's"},
            {"--mapping", options,
             "Pixels to PEs: cyclic, column, rows, blocks, grid:AxB, tiles:WxH, random, dynamic:CHUNK, hybrid:CHUNK"},
            {"--offset", options, "Offset of the cyclic mapping; default: 16"},
            {"--format", options, "Number format: fp32, spa22 (e6m15) or eXmY[t]"},
            {"--accel", options, "Acceleration structure in each PE's memory"},
            {"--antialias", options, "3 x 3 filter or adaptive supersampling"},
            {"--device", options, "OpenCL device: its number, type or part of its name"},
            {"--report", options, "Write all counts and measurements; -: stdout"},
            {"--bounces", image, "Reflections and refractions, 0..31; default: 8"},
            {"--exposure", image, "Brighten 8-bit images by 2^EV"},
            {"--from", image, "Eye point; also --at, --up, --angle; default: scene's"},
            {"--light", image, "Replace the scene's lights; once for each light"},
            {"--pe-memory", machine, "Memory of a PE or node; default: the machine's"},
            {"--fold", machine, "Assignment of slots to PEs"},
            {"--nodes", machine, "Nodes of the torus along x, y and z"},
            {"--voxels", machine, "Voxels of the torus; default: one for each node"},
            {"--packets", machine, "Write every packet between nodes of the torus"},
            {"--page", output, "Write the report as an HTML page"},
            {"--profile", output, "Print times by kernel and the roofline"},
            {"--trace", output, "Write a trace for ui.perfetto.dev"},
            {"--cost", output, "Write the modelled cycles of each pixel"},
            {"--checkpoint", output, "Save the progress of a long render to this file"},
            {"--resume", output, "Continue from the file of --checkpoint"}};
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
    const bool torus = machine_named(command.render.machine).kind == MachineKind::kTorus;
    return torus ? render_on_torus(command, run) : render_on_ring(command, run);
}

void add_render_command_options(CLI::App& command, RenderCommand& options) {
    OptionGroup group(command, kFiles);
    add_file(command, FileUse::kWritten, "-o,--output", options.image, "IMAGE",
             "Image to write: .png, .tif, .ppm or .jpg (8-bit; JPEG with quality 95, lossy), .exr or .pfm (linear); -: "
             "stdout, as PPM. If a file goes to stdout, the summary goes to stderr");
    add_render_options(command, options.render);
    add_tone_options(command, options.tone);
    add_checkpoint_options(command, options.checkpoint);
    add_torus_options(command, options.torus);
    group.next(kDiagnostics);
    add_file(command, FileUse::kWritten, "--cost", options.cost, "FILE.exr",
             "Write the modelled cycles of each pixel as an image, .exr or .pfm; -: stdout, as PFM");
    add_file(command, FileUse::kWritten, "--mask", options.mask, "IMAGE",
             "Write the mask of the supersampled pixels, white on black");
    add_file(command, FileUse::kWritten, "--report", options.report, "FILE.json",
             "Write all counts and measurements as JSON; -: stdout");
    add_file(command, FileUse::kWritten, "--page", options.page, "FILE.html",
             "Write an HTML page: image, owners of pixels, loads, times by label, roofline, modelled and measured "
             "times, build options; raya page makes the same page from a report. Like --profile, measures the device's "
             "peak");
    command.add_flag("--profile", options.profile,
                     "Print the number of launches and the times of each labelled command, the build times, and which "
                     "fraction of the device's measured peak each kernel reaches (the roofline)");
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
    add_short_help(*command, render_short_help());
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
