// raya render: a scene file in, an image and a load report out.
#include <memory>

#include "host/cli/command_tree.hpp"
#include "host/cli/commands.hpp"
#include "host/cli/file_options.hpp"
#include "host/cli/options.hpp"
#include "host/cli/parse.hpp"
#include "host/cli/render_command.hpp"

namespace raya {
namespace {

void render(const CLI::App& parsed, const RenderCommand& command, Ranks& ranks) {
    refuse_options_of_other_machines(parsed, machine_named(command.render.machine));
    if (ranks.first()) check_render(parsed, command);  // who writes; elsewhere the folders need not be there
    RenderRun run(command, ranks);
    if (command.frames.given())
        render_frames(parsed, command, run);
    else
        render_image(command, run);
    if (command.keep_kernels && ranks.first()) run.session().keep_binaries();
}

}  // namespace

void check_render(const CLI::App& parsed, const RenderCommand& command) {
    check_trace(parsed, command.trace);
    check_keep(parsed, command.keep);
    if (command.frames.given()) check_frames(command);
    check_targets(parsed, command);
}

std::optional<Render> render_image(const RenderCommand& command, RenderRun& run) {
    const bool torus = machine_named(command.render.machine).kind == MachineKind::kTorus;
    return torus ? render_on_torus(command, run) : render_on_ring(command, run);
}

void describe_render(CLI::App& command, RenderCommand& options) {
    OptionGroup group(command, kFiles);
    add_file(
        command, FileUse::kWritten, "-o,--output", options.image, "IMAGE",
        "Image to write: .png, .tif, .ppm or .jpg (8-bit codes; JPEG of quality 95, lossy), .exr or .pfm (linear); "
        "-: stdout, as PPM. What goes to stdout, of this or another file, leaves the summary to stderr");
    add_render_options(command, options.render);
    add_tone_options(command, options.tone);
    add_frame_options(command, options.frames);
    add_keep_options(command, options.keep);
    add_torus_options(command, options.torus);
    group.next(kCloserLook);
    add_file(command, FileUse::kWritten, "--cost", options.cost, "FILE.exr",
             "Write the modelled cycles of each pixel as an image, .exr or .pfm; -: stdout, as PFM");
    add_file(command, FileUse::kWritten, "--mask", options.mask, "IMAGE",
             "Write which pixels were supersampled, white on black");
    add_file(command, FileUse::kWritten, "--report", options.report, "FILE.json",
             "Write everything that was counted and measured; -: stdout");
    add_file(command, FileUse::kWritten, "--page", options.page, "FILE.html",
             "Write the render as a page for a browser: picture, owners of pixels, loads, times by label, roofline, "
             "model beside measurement, build options; it is what raya page makes of the report. Measures the device's "
             "peak, as --profile does");
    command.add_flag("--profile", options.profile,
                     "Print launches and times of every labelled command, the builds, and how near each kernel came "
                     "to the device's measured peak (the roofline)");
    add_trace_options(command, options.trace);
}

void add_render_command(CLI::App& program, Ranks& ranks) {
    CLI::App* command = program.add_subcommand("render", "Render an NFF scene on a ring machine or the torus machine");
    add_examples(*command, {{"raya render scenes/centre.nff -o centre.png",
                             "The paper's kind of scene on a ring of 256 PEs, in the scene's own size"},
                            {"raya render scenes/glass.nff --machine torus --size 64 --report glass.json -o glass.png",
                             "A small picture on a torus of 64 nodes, and all that was counted as JSON"}});
    const auto options = std::make_shared<RenderCommand>();
    const OptionGroup group(*command, kFiles);
    add_file(*command, FileUse::kRead, "SCENE", options->render.scene, "SCENE.nff",
             "Scene in NFF, as the SPD programs write it; -: stdin")
        ->required();
    describe_render(*command, *options);
    command->get_option("--output")->required();
    const OptionGroup kernels(*command, kKernels);
    command->add_flag("--keep-kernels", options->keep_kernels,
                      "Keep the binaries of this render's kernels beside the program: later renders of such scenes with "
                      "these options, on this device and driver, compile none");
    command->callback([command, options, &ranks] { render(*command, *options, ranks); });
}

}  // namespace raya
