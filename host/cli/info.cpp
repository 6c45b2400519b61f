// raya info: prints the contents of a scene and its memory needs on each machine. Opens no device.
#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <memory>

#include "host/base/log.hpp"
#include "host/base/standard_streams.hpp"
#include "host/cli/command_tree.hpp"
#include "host/cli/commands.hpp"
#include "host/cli/file_options.hpp"
#include "host/cli/options.hpp"
#include "host/cli/scene_input.hpp"
#include "host/cli/scene_needs.hpp"
#include "host/error.hpp"
#include "host/scene/view.hpp"
#include "host/version.hpp"

namespace raya {
namespace {

struct InfoCommand {
    RenderOptions render;
    TorusOptions torus;
    bool json = false;
};

// Options of raya render that raya info does not have, because they do not affect the memory needs of a PE.
constexpr std::array<const char*, 17> kExecutionOptions = {
    "--device",        "--lanes",   "--group",  "--no-tuned", "--kernel-dir", "--exchange",
    "--sampling",      "--points",  "--inject", "--returns",  "--threshold",  "--packet-words",
    "--link-exchange", "--packets", "--replay", "--async",    "--il"};

void add_options(CLI::App& command, InfoCommand& options) {
    add_file(command, FileUse::kRead, "SCENE", options.render.scene, "SCENE", kSceneHelp)->required();
    OptionGroup group(command, kFiles);
    command.add_flag("--json", options.json, "Print JSON");
    add_render_options(command, options.render);
    add_torus_options(command, options.torus);
    for (const char* option : kExecutionOptions) command.remove_option(command.get_option(option));
    command.get_option("--machine")
        ->default_str("")
        ->description("Only this machine, as in raya render; default: all machines");
}

// Returns the memory needs on the machine of --machine. Throws UserError if this machine does not support the options.
// Without --machine, returns the memory needs on all machines; the entry of a machine that does not support the options
// contains the reason. Throws UserError if no ring machine supports the options.
std::vector<MachineNeeds> needs_of_machines(const CLI::App& parser, const InfoCommand& command, SceneNeeds& needs) {
    if (parser.count("--machine") > 0) {
        refuse_options_of_other_machines(parser, machine_named(command.render.machine));
        return {needs.needs_of(command.render.machine)};
    }
    std::vector<MachineNeeds> machine_needs;
    for (const Machine& machine : machines()) try {
            machine_needs.push_back(needs.needs_of(machine.name));
        } catch (const UserError& error) {
            machine_needs.push_back({.machine = machine.name,
                                     .format = {},
                                     .pes = 0,
                                     .memory_bytes = {},
                                     .needs = {},
                                     .refusal = error.what()});
        }
    const bool all_rings_failed = std::ranges::all_of(machine_needs, [](const MachineNeeds& m) {
        return !m.refusal.empty() || machine_named(m.machine).kind == MachineKind::kTorus;
    });
    if (all_rings_failed) throw UserError(machine_needs.front().refusal);
    return machine_needs;
}

void info(const CLI::App& parser, const InfoCommand& command) {
    SceneInput input = read_scene(command.render.scene, command.render.strict);
    change_view(command.render.view, input.scene);
    SceneReport report;
    report.raya = raya_version();
    SceneNeeds needs(command.render, command.torus, input.scene);
    report.machines = needs_of_machines(parser, command, needs);
    report.formats = needs.formats();
    report.file = input_name(command.render.scene);
    report.box = scene_box(input.scene);
    report.skipped = input.remarks;
    report.warnings = input.warnings.texts();
    report.scene = input.scene;
    fmt::print("{}", command.json ? to_json(report).dump(2) + "\n" : printable(summary_text(report)));
}

std::vector<ShortHelp> info_short_help() {
    const char* const options = "Options";
    return {{"--json", options, ""},
            {"--machine", options, ""},
            {"--pe-memory", options, "Memory of a PE or node; default: the machine's"},
            {"--pes", options, "Number of PEs; default: the machine's"},
            {"--mapping", options, "Pixels to PEs: cyclic, column, rows, blocks, ..."},
            {"--size", options, "Size in pixels, 1..16384 a side; default: the scene's"},
            {"--format", options, "Number format: fp32, spa22 (e6m15) or eXmY[t]"},
            {"--accel", options, "Acceleration structure; default: all three"},
            {"--antialias", options, "3 x 3 filter or adaptive supersampling"},
            {"--nodes", options, "Nodes of the torus along x, y and z"},
            {"--voxels", options, "Voxels of the torus; default: one for each node"},
            {"--strict", options, "Refuse what NFF does not define"}};
}

}  // namespace

void add_info_command(CLI::App& program) {
    CLI::App* command = program.add_subcommand(
        "info", "Print the contents of a scene and the machines that can hold it, without rendering or a device");
    add_examples(*command,
                 {{"raya info scenes/centre.nff", "Print objects, lights, extent, and the machines with enough memory"},
                  {"raya info scenes/polygons.nff --machine spa --pe-memory 8192 --json",
                   "Print as JSON whether a PE of 8 KB can hold the scene"}});
    const auto options = std::make_shared<InfoCommand>();
    add_short_help(*command, info_short_help());
    add_options(*command, *options);
    command->callback([command, options] { info(*command, *options); });
}

}  // namespace raya
