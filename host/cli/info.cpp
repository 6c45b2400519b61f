// raya info: prints the contents of a scene and its memory needs on each machine. Opens no device.
#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <map>
#include <memory>

#include "host/base/log.hpp"
#include "host/base/whole_file.hpp"
#include "host/cl/device.hpp"
#include "host/cl/kernel_options.hpp"
#include "host/cli/commands.hpp"
#include "host/cli/help.hpp"
#include "host/cli/options.hpp"
#include "host/cli/render_options.hpp"
#include "host/error.hpp"
#include "host/model/machine.hpp"
#include "host/report/scene_report.hpp"
#include "host/report/table.hpp"
#include "host/ring/ring_plan.hpp"
#include "host/ring/turns.hpp"
#include "host/scene/scene.hpp"
#include "host/torus/torus_plan.hpp"
#include "host/version.hpp"

namespace raya {
namespace {

// Computes the memory that machines need for a scene, with those steps of a render that need no device. A scene that
// does not fit is not an error; the result contains the missing bytes.

// Size of the packed scene with an accelerator.
struct PackedSize {
    std::uint64_t words = 0;  // number of 32-bit words
    AccelSummary accel;
    std::string refusal;  // why the scene cannot be packed; empty if it can
};

// What machines share: how the scene fits their formats, and its sizes.
struct SceneSizes {
    std::vector<FormatFit> formats;
    std::map<std::string, PackedSize> packed;  // by format and accelerator
};

void set_missing(AccelNeed& need, const DoesNotFit& refusal) {
    need.pe_bytes = refusal.needed_bytes;
    need.missing_bytes = refusal.needed_bytes - refusal.memory_bytes;
    need.refusal = refusal.what();
}

const FormatFit& fit_of(SceneSizes& sizes, const Scene& scene, const NumberFormat& format) {
    const std::string name = format_name(format);
    const auto known = std::ranges::find(sizes.formats, name, &FormatFit::format);
    if (known != sizes.formats.end()) return *known;
    FormatFit fit{name, {}, {}};
    try {
        fit.scale = length_scale(scene, format);
    } catch (const UserError& error) {
        fit.refusal = error.what();
    }
    return sizes.formats.emplace_back(std::move(fit));
}

const PackedSize& size_of(SceneSizes& sizes, const Scene& scene, const RingSettings& settings,
                          const LengthScale& scale) {
    const auto [entry, added] =
        sizes.packed.try_emplace(format_name(settings.format) + ' ' + accel_text(settings.accel));
    PackedSize& size = entry->second;
    if (added) try {
            PackedJob job = pack_for_ring(scene, settings, scale);
            if (settings.accel.kind != AccelKind::kNone) size.accel = append_accel(job, settings);
            size.words = job.words().size();
        } catch (const UserError& error) {  // the scene has more words than 32-bit addresses can reach
            size.refusal = error.what();
        }
    return size;
}

// Sets the memory that a PE needs for the scene or, if it does not fit, for a part of it. Throws DoesNotFit.
void plan_memory(AccelNeed& need, const Scene& scene, const RingSettings& settings, const FormatFit& fit) {
    if (settings.split <= 1) try {
            need.pe_bytes = plan_pe_memory(settings.machine, pe_demand(settings, scene.name, need.words)).bytes();
            return;
        } catch (const DoesNotFit&) {
            if (settings.accel.kind != AccelKind::kNone || settings.split == 1) throw;
        }
    const PackedJob job = pack_for_ring(scene, settings, fit.scale);
    const StoredScene stored = store_scene(job, settings, scene.name);
    need.pe_bytes = stored.memory.bytes();
    need.words = stored.words(job).size() + stored.parts->words.size();
    need.parts = stored.parts->parts;
}

AccelNeed need_of(SceneSizes& sizes, const Scene& scene, const RingSettings& settings, const FormatFit& fit) {
    AccelNeed need;
    need.accel = accel_text(settings.accel);
    need.refusal = fit.refusal;
    if (!need.refusal.empty()) return need;
    const PackedSize& size = size_of(sizes, scene, settings, fit.scale);
    need.words = size.words;
    need.summary = size.accel;
    need.refusal = size.refusal;
    if (need.refusal.empty()) try {
            plan_memory(need, scene, settings, fit);
        } catch (const DoesNotFit& refusal) {
            set_missing(need, refusal);
        }
    return need;
}

// With the accelerator of --accel or, without --accel, with each of none, bvh and grid.
MachineNeeds ring_needs(SceneSizes& sizes, const Scene& scene, const RenderOptions& options) {
    RingSettings settings = ring_settings(options, scene);
    check_split(settings);
    check_antialias(settings.antialias.method, settings.mapping, settings.dynamic.has_value());
    MachineNeeds machine{.machine = options.machine,
                         .format = format_name(settings.format),
                         .pes = settings.mapping.pes,
                         .memory_bytes = settings.machine.pe_memory_bytes,
                         .needs = {},
                         .refusal = {}};
    const FormatFit fit = fit_of(sizes, scene, settings.format);
    const std::string default_accel = accel_text(settings.accel);
    std::vector<Accel> accels = {settings.accel};
    if (options.accel.empty() && settings.split <= 1)
        accels = {{AccelKind::kNone, {}}, {AccelKind::kBvh, {}}, {AccelKind::kGrid, {}}};
    for (const Accel& accel : accels) {
        settings.accel = accel;
        machine.needs.push_back(need_of(sizes, scene, settings, fit));
        machine.needs.back().is_default = options.accel.empty() && machine.needs.back().accel == default_accel;
    }
    return machine;
}

MachineNeeds torus_needs(SceneSizes& sizes, const Scene& scene, const RenderOptions& options,
                         const TorusOptions& torus) {
    const TorusSettings settings = torus_settings(options, torus, scene);
    AccelNeed need;
    need.accel = "voxels";
    need.is_default = true;
    need.refusal = fit_of(sizes, scene, settings.format).refusal;
    if (need.refusal.empty()) try {
            const NodeNeeds needs = node_needs(scene, settings);
            need.words = needs.words;
            need.pe_bytes = needs.bytes;
        } catch (const DoesNotFit& refusal) {
            set_missing(need, refusal);
        } catch (const UserError& error) {
            need.refusal = error.what();
        }
    return {.machine = options.machine,
            .format = format_name(settings.format),
            .pes = raya_nodes(settings.torus),
            .memory_bytes = settings.memory_bytes,
            .needs = {need},
            .refusal = {}};
}

struct InfoCommand {
    RenderOptions render;
    TorusOptions torus;
    bool json = false;
};

// Options of raya render that raya info does not have, because they do not affect the memory needs of a PE.
constexpr std::array kExecutionOptions = {"--device",    "--lanes",        "--group",  "--no-tuned", "--kernel-dir",
                                          "--exchange",  "--sampling",     "--points", "--inject",   "--returns",
                                          "--threshold", "--packet-words", "--async",  "--il"};

void add_options(CLI::App& command, InfoCommand& options) {
    add_file(command, FileUse::kRead, "SCENE SCENE", options.render.scene, kSceneHelp)->required();
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
std::vector<MachineNeeds> needs_of_machines(const CLI::App& parser, const InfoCommand& command, SceneSizes& sizes,
                                            const Scene& scene) {
    const auto needs_of = [&](const Machine& machine) {
        RenderOptions options = command.render;
        options.machine = machine.name;
        return machine.kind == MachineKind::kTorus ? torus_needs(sizes, scene, options, command.torus)
                                                   : ring_needs(sizes, scene, options);
    };
    if (parser.count("--machine") > 0) {
        const Machine& machine = machine_named(command.render.machine);
        refuse_options_of_other_machines(parser, machine);
        return {needs_of(machine)};
    }
    std::vector<MachineNeeds> all;
    bool all_rings_failed = true;
    for (const Machine& machine : machines()) try {
            all.push_back(needs_of(machine));
            all_rings_failed = all_rings_failed && machine.kind == MachineKind::kTorus;
        } catch (const UserError& error) {
            all.push_back({.machine = machine.name,
                           .format = {},
                           .pes = 0,
                           .memory_bytes = {},
                           .needs = {},
                           .refusal = error.what()});
        }
    if (all_rings_failed) throw UserError(all.front().refusal);
    return all;
}

void info(const CLI::App& parser, const InfoCommand& command) {
    SceneInput input = read_scene(command.render.scene, command.render.strict);
    change_view(command.render.view, input.scene);
    SceneReport report;
    report.raya = raya_version();
    SceneSizes sizes;
    report.machines = needs_of_machines(parser, command, sizes, input.scene);
    report.formats = sizes.formats;
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

void list_machines(const std::string& name) {
    for (const Machine& machine : name.empty() ? machines() : std::vector<Machine>{machine_named(name)}) {
        std::vector<std::vector<std::string>> rows = {{"number", "value", "source"}};
        for (const Fact& fact : machine.facts) rows.push_back({fact.what, fact.value, fact.source});
        fmt::print("{}: {}, {}\n{}\n", machine.name, machine.title, machine.topology, text_table(rows));
    }
    if (!name.empty()) return;
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
    add_value(*command, "machine NAME", *name, "Name of one machine, as for --machine; default: all");
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
