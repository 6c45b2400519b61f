// raya info: prints the contents of a scene and its memory needs on each machine. Opens no device.
#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <map>
#include <memory>
#include <optional>

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
#include "host/scene/scene.hpp"
#include "host/torus/torus_plan.hpp"
#include "host/version.hpp"

namespace raya {
namespace {

// Computes the memory that machines need for a scene, with those steps of a render that need no device.

/// Packs a scene for several machines. Machines with the same format and accelerator share one packed scene.
class SceneNeeds {
  public:
    /// All arguments must outlive this object.
    SceneNeeds(const RenderOptions& render, const TorusOptions& torus, const Scene& scene);

    /// Returns the machine's memory needs with the accelerator of --accel or, without --accel, with each of none, bvh
    /// and grid. Throws UserError if the machine does not support the options' values. A scene that does not fit is not
    /// an error; the result contains the missing bytes.
    MachineNeeds needs_of(const std::string& machine);

    /// Returns how the scene fits the number formats of the machines for which needs_of() was called.
    std::vector<FormatFit> formats() const { return formats_; }

  private:
    /// Size of the packed scene with an accelerator.
    struct PackedSize {
        std::uint64_t words = 0;  // number of 32-bit words
        AccelSummary accel;
        std::string refusal;  // why the scene cannot be packed; empty if it can
    };

    const FormatFit& fit_of(const NumberFormat& format);
    const PackedSize& size_of(const RingSettings& settings, const LengthScale& scale);
    AccelNeed need_of(const RingSettings& settings, const FormatFit& fit);
    MachineNeeds ring_needs(const RenderOptions& options);
    MachineNeeds torus_needs(const RenderOptions& options);

    const RenderOptions& render_;
    const TorusOptions& torus_;
    const Scene& scene_;
    std::vector<FormatFit> formats_;
    std::map<std::string, PackedSize> sizes_;                       // key: format and accelerator
    std::optional<std::pair<std::string, PackedJob>> last_packed_;  // [format, scene without accelerator]
};

constexpr std::array<AccelKind, 3> kAccelKinds = {AccelKind::kNone, AccelKind::kBvh, AccelKind::kGrid};

void set_missing(AccelNeed& need, const DoesNotFit& refusal) {
    need.pe_bytes = refusal.needed_bytes;
    need.missing_bytes = refusal.needed_bytes - refusal.memory_bytes;
    need.refusal = refusal.what();
}

SceneNeeds::SceneNeeds(const RenderOptions& render, const TorusOptions& torus, const Scene& scene)
    : render_(render), torus_(torus), scene_(scene) {}

const FormatFit& SceneNeeds::fit_of(const NumberFormat& format) {
    const std::string name = format_name(format);
    const auto known = std::ranges::find(formats_, name, &FormatFit::format);
    if (known != formats_.end()) return *known;
    FormatFit fit{name, {}, {}};
    try {
        fit.scale = length_scale(scene_, format);
    } catch (const UserError& error) {
        fit.refusal = error.what();
    }
    return formats_.emplace_back(std::move(fit));
}

const SceneNeeds::PackedSize& SceneNeeds::size_of(const RingSettings& settings, const LengthScale& scale) {
    const std::string format = format_name(settings.format);
    const auto [entry, added] = sizes_.try_emplace(format + ' ' + accel_text(settings.accel));
    PackedSize& size = entry->second;
    if (!added) return size;
    try {
        if (!last_packed_ || last_packed_->first != format)
            last_packed_.emplace(format, pack_for_ring(scene_, settings, scale));
        size.words = last_packed_->second.words().size();
        if (settings.accel.kind == AccelKind::kNone) return size;
        PackedJob job = last_packed_->second;
        size.accel = append_accel(job, settings);
        size.words = job.words().size();
    } catch (const UserError& error) {  // the scene has more words than 32-bit addresses can reach
        size.refusal = error.what();
    }
    return size;
}

AccelNeed SceneNeeds::need_of(const RingSettings& settings, const FormatFit& fit) {
    AccelNeed need;
    need.accel = accel_text(settings.accel);
    need.refusal = fit.refusal;
    if (!need.refusal.empty()) return need;
    const PackedSize& size = size_of(settings, fit.scale);
    need.words = size.words;
    need.summary = size.accel;
    need.refusal = size.refusal;
    if (!need.refusal.empty()) return need;
    try {
        need.pe_bytes = plan_pe_memory(settings.machine, pe_demand(settings, scene_.name, size.words)).bytes();
    } catch (const DoesNotFit& refusal) {
        set_missing(need, refusal);
    }
    return need;
}

MachineNeeds SceneNeeds::ring_needs(const RenderOptions& options) {
    RingSettings settings = ring_settings(options, scene_);
    check_antialias(settings.antialias.method, settings.mapping, settings.dynamic.has_value());
    MachineNeeds machine{.machine = options.machine,
                         .format = format_name(settings.format),
                         .pes = settings.mapping.pes,
                         .memory_bytes = settings.machine.pe_memory_bytes,
                         .needs = {},
                         .refusal = {}};
    const FormatFit fit = fit_of(settings.format);
    const std::string default_accel = accel_text(settings.accel);
    std::vector<Accel> accels;
    for (const AccelKind kind : kAccelKinds)
        if (options.accel.empty()) accels.push_back({kind, {}});
    if (accels.empty()) accels.push_back(settings.accel);
    for (const Accel& accel : accels) {
        settings.accel = accel;
        machine.needs.push_back(need_of(settings, fit));
        machine.needs.back().is_default = options.accel.empty() && machine.needs.back().accel == default_accel;
    }
    return machine;
}

MachineNeeds SceneNeeds::torus_needs(const RenderOptions& options) {
    const TorusSettings settings = torus_settings(options, torus_, scene_);
    MachineNeeds machine{.machine = options.machine,
                         .format = format_name(settings.format),
                         .pes = raya_nodes(settings.torus),
                         .memory_bytes = settings.memory_bytes,
                         .needs = {},
                         .refusal = {}};
    AccelNeed need;
    need.accel = "voxels";
    need.is_default = true;
    need.refusal = fit_of(settings.format).refusal;
    try {
        if (need.refusal.empty()) {
            const NodeNeeds needs = node_needs(scene_, settings);
            need.words = needs.words;
            need.pe_bytes = needs.bytes;
        }
    } catch (const DoesNotFit& refusal) {
        set_missing(need, refusal);
    } catch (const UserError& error) {
        need.refusal = error.what();
    }
    machine.needs.push_back(need);
    return machine;
}

MachineNeeds SceneNeeds::needs_of(const std::string& machine) {
    RenderOptions options = render_;
    options.machine = machine;
    return machine_named(machine).kind == MachineKind::kTorus ? torus_needs(options) : ring_needs(options);
}

struct InfoCommand {
    RenderOptions render;
    TorusOptions torus;
    bool json = false;
};

// Options of raya render that raya info does not have, because they do not affect the memory needs of a PE.
constexpr std::array kExecutionOptions = {"--device",    "--lanes",        "--group",   "--no-tuned", "--kernel-dir",
                                          "--exchange",  "--sampling",     "--points",  "--inject",   "--returns",
                                          "--threshold", "--packet-words", "--packets", "--async",    "--il"};

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
