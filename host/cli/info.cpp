// raya info: what is in a scene, and which machines can hold it. No device is opened.
#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <memory>

#include "host/base/say.hpp"
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

// What a render takes that says how it is run, and nothing of what a PE holds.
constexpr std::array<const char*, 16> kOfRunning = {
    "--device", "--lanes",   "--group",     "--no-tuned",     "--kernel-dir",    "--exchange", "--sampling", "--points",
    "--inject", "--returns", "--threshold", "--packet-words", "--link-exchange", "--packets",  "--replay",   "--async"};

void add_options(CLI::App& command, InfoCommand& options) {
    add_file(command, FileUse::kRead, "SCENE", options.render.scene, "SCENE.nff",
             "Scene in NFF, as the SPD programs write it; -: stdin")
        ->required();
    OptionGroup group(command, kFiles);
    command.add_flag("--json", options.json, "Print it as JSON, for programs");
    add_render_options(command, options.render);
    add_torus_options(command, options.torus);
    for (const char* option : kOfRunning) command.remove_option(command.get_option(option));
    command.get_option("--machine")
        ->default_str("")
        ->description("This machine alone, as raya render takes it; default: all of them");
}

// Of all machines one that cannot be what the options ask for says so in its line; one that was named is refused.
std::vector<MachineNeeds> needs_of_machines(const CLI::App& parsed, const InfoCommand& command, SceneNeeds& needs) {
    if (parsed.count("--machine") > 0) {
        refuse_options_of_other_machines(parsed, machine_named(command.render.machine));
        return {needs.of(command.render.machine)};
    }
    std::vector<MachineNeeds> all;
    for (const Machine& machine : machines()) try {
            all.push_back(needs.of(machine.name));
        } catch (const UserError& error) {
            all.push_back({.machine = machine.name,
                           .format = {},
                           .pes = 0,
                           .memory_bytes = {},
                           .needs = {},
                           .refusal = error.what()});
        }
    const bool mistaken = std::ranges::all_of(all, [](const MachineNeeds& m) {
        return !m.refusal.empty() || machine_named(m.machine).kind == MachineKind::kTorus;
    });
    if (mistaken) throw UserError(all.front().refusal);
    return all;
}

void info(const CLI::App& parsed, const InfoCommand& command) {
    SceneInput input = read_scene(command.render.scene, command.render.strict);
    change_view(command.render.view, input.scene);
    SceneReport report;
    report.raya = raya_version();
    SceneNeeds needs(command.render, command.torus, input.scene);
    report.machines = needs_of_machines(parsed, command, needs);
    report.formats = needs.formats();
    report.file = input_name(command.render.scene);
    report.box = scene_box(input.scene);
    report.skipped = input.remarks;
    report.warnings = input.warnings.texts();
    report.scene = input.scene;
    fmt::print("{}", command.json ? to_json(report).dump(2) + "\n" : printable(human_summary(report)));
}

}  // namespace

void add_info_command(CLI::App& program) {
    CLI::App* command = program.add_subcommand(
        "info", "Tell what is in a scene and which machines can hold it, without rendering it or asking for a device");
    add_examples(*command, {{"raya info scenes/centre.nff",
                             "Objects, lights, extent, and which of all machines have room for them"},
                            {"raya info scenes/polygons.nff --machine spa --pe-memory 8192 --json",
                             "Whether a PE of 8 KB would hold the scene, as JSON"}});
    const auto options = std::make_shared<InfoCommand>();
    add_options(*command, *options);
    command->callback([command, options] { info(*command, *options); });
}

}  // namespace raya
