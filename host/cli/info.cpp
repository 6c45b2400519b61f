// raya info: prints the contents of a scene and its memory needs on each machine. Opens no device.
#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <memory>

#include "host/base/log.hpp"
#include "host/base/standard_streams.hpp"
#include "host/cl/device.hpp"
#include "host/cl/kernel_options.hpp"
#include "host/cli/command_tree.hpp"
#include "host/cli/commands.hpp"
#include "host/cli/options.hpp"
#include "host/cli/scene_input.hpp"
#include "host/error.hpp"
#include "host/model/machine.hpp"
#include "host/report/table.hpp"
#include "host/scene/scene.hpp"
#include "host/version.hpp"

namespace raya {
namespace {

struct InfoCommand {
    RenderOptions render;
    TorusOptions torus;
    bool json = false;
};

// Options of raya render that raya info does not have, because they do not affect the memory needs of a PE.
constexpr std::array<const char*, 16> kExecutionOptions = {
    "--device", "--lanes",   "--group",     "--no-tuned",     "--kernel-dir", "--exchange", "--sampling", "--points",
    "--inject", "--returns", "--threshold", "--packet-words", "--packets",    "--replay",   "--async",    "--il"};

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

}  // namespace

void add_info_command(CLI::App& program) {
    CLI::App* command = program.add_subcommand(
        "info", "Print the contents of a scene and the machines that can hold it, without rendering or a device");
    add_examples(*command,
                 {{"raya info scenes/centre.nff", "Print objects, lights, extent, and the machines with enough memory"},
                  {"raya info scenes/polygons.nff --machine spa --pe-memory 8192 --json",
                   "Print as JSON whether a PE of 8 KB can hold the scene"}});
    const auto options = std::make_shared<InfoCommand>();
    add_options(*command, *options);
    command->callback([command, options] { info(*command, *options); });
}

namespace {

void print_machine(const Machine& machine) {
    std::vector<std::vector<std::string>> rows = {{"number", "value", "source"}};
    for (const Fact& fact : machine.facts) rows.push_back({fact.what, fact.value, fact.source});
    fmt::print("{}: {}, {}\n{}\n", machine.name, machine.title, machine.topology, text_table(rows));
}

void list_machines(const std::string& name) {
    if (!name.empty()) return print_machine(machine_named(name));
    for (const Machine& machine : machines()) print_machine(machine);
    for (const CitedMachine& cited : cited_machines())
        fmt::print("{}: cited but not modelled, because {}. {}.\n", cited.name, cited.reason, cited.facts);
    fmt::print(
        "\n[P] printed in the machine's paper, [D] derived from printed figures, [T] data sheet of the T805, "
        "[?] assumed.\n");
}

}  // namespace

void add_machines_command(CLI::App& program) {
    CLI::App* command =
        program.add_subcommand("machines", "List the modelled machines, with the source of every number");
    add_examples(*command, {{"raya machines", "List all machines"}, {"raya machines spa", "List the numbers of spa"}});
    const auto name = std::make_shared<std::string>();
    command->add_option("machine", *name, "Name of one machine, as for --machine; default: all")->type_name("NAME");
    command->callback([name] { list_machines(*name); });
}

namespace {

// Lines of at most 80 characters, unless a driver's own names are longer.
std::string device_text(std::size_t number, const DeviceInfo& info) {
    std::string usable = unusable_reason(info).empty() ? "usable" : "not usable: " + unusable_reason(info);
    for (const auto& [has, what] : {std::pair{info.correctly_rounded_divide_sqrt, "exact division and square root"},
                                    {info.fused_multiply_add, "fma"},
                                    {info.profiling, "profiling"}})
        if (has) usable += fmt::format(", {}", what);
    return fmt::format(
        "{}  {}\n   {}, driver {}\n   {}{}{}\n   {}, {} units, {} KB of {} memory, {} MB of global memory\n"
        "   {} lanes and groups of {} by default\n   {}\n\n",
        number, info.name, info.platform, info.driver, info.version, info.il_versions.empty() ? "" : ", IL ",
        info.il_versions, info.type, info.compute_units, info.local_memory_bytes / 1024,
        info.local_memory_is_dedicated ? "local" : "local (in global)", info.global_memory_bytes >> 20,
        default_lanes(info), default_group_size(info), usable);
}

void list_devices() {
    const std::vector<cl::Device> devices = all_devices();
    if (devices.empty()) choose_device("");  // throws the error for a computer without devices
    for (std::size_t i = 0; i < devices.size(); ++i) fmt::print("{}", device_text(i, device_info(devices[i])));
    fmt::print(
        "--device and RAYA_DEVICE take a number, a type, or part of a name or version; --lanes\n"
        "and --group replace the defaults. RAYA_BUILD_OPTIONS=-cl-opt-disable shows whether\n"
        "the compiler's optimiser causes a wrong result.\n");
}

}  // namespace

void add_devices_command(CLI::App& program) {
    CLI::App* command =
        program.add_subcommand("devices", "List every OpenCL device of every platform, with its main properties");
    add_examples(*command, {{"raya devices", "List the devices with their numbers"},
                            {"raya devices >devices.txt", "Write the list to a file"}});
    command->callback(list_devices);
}

}  // namespace raya
