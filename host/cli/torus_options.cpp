#include "host/cli/torus_options.hpp"

#include <fmt/core.h>

#include "host/cli/options.hpp"
#include "host/cli/parse.hpp"
#include "host/error.hpp"

namespace raya {
namespace {

using Sides = std::array<std::uint32_t, 3>;

constexpr const char* kPacketsExtension = ".csv.gz";
constexpr const char* kNoNodes =
    "that machine is a ring of PEs without voxels; leave it out, or choose --machine torus";

}  // namespace

void add_torus_options(CLI::App& command, TorusOptions& t) {
    const OptionGroup group(command, kTorusMachine);
    CLI::Option* machine = command.get_option("--machine");
    machine->description(machine->get_description() +
                         "; torus: nodes of 4 MB that hold voxels of the scene, see the options under Torus machine");
    std::vector<std::string> machine_names;
    for (const Machine& known : machines()) machine_names.push_back(known.name);
    offer_choices(machine, machine_names);
    const auto add = [&](const std::string& name, auto& value, const std::string& text, const std::string& type,
                         const std::string& brief = "") {
        return add_value(command, name, value, text, brief)->type_name(type);
    };
    add("--nodes", t.nodes, "Number of nodes along x, y and z of the scene, at most 65,536 in total", "IxJxK",
        "Nodes of the torus along x, y and z")
        ->default_str("4x4x4");
    add("--voxels", t.voxels,
        "Number of equal voxels along x, y and z that divide the scene's box, at most 1024 along an axis and 2^24 in "
        "total; more voxels than nodes are assigned cyclically, fewer voxels leave nodes empty; default: one "
        "for each node",
        "AxBxC");
    add_choice(
        command, "--links", t.links, Choices<Links>{{"torus3d", Links::kTorus3d}, {"torus2d", Links::kTorus2d}},
        "Links of a node: torus3d: six; torus2d: four, as on a T805, in a 2-D torus with the slabs of nodes side "
        "by side");
    add_choice(command, "--inject", t.inject, Choices<Injection>{{"root", Injection::kRoot}, {"all", Injection::kAll}},
               "Source of the primary rays: root: the root creates all rays and sends each to the node where the ray "
               "enters the scene's box; all: each node creates the rays that enter the box at its voxels");
    add_choice(command, "--returns", t.one_return_per_ray, Choices<bool>{{"terms", false}, {"rays", true}},
               "Modelled contents of a return packet: terms: one contribution of a ray (ambient term, light from one "
               "light, or background); rays: all contributions of a ray, in 6 words sent after the ray's shadow rays, "
               "as in Yoshitani & Yamazaki");
    add("--packet-words", t.packet_words,
        "Modelled size of a ray packet in 32-bit words, 16..4096, for the time of its creation and transfers; the "
        "renderer itself transfers 16 words, Yoshitani & Yamazaki use 22 and more",
        "N")
        ->default_str("16");
    add("--queue", t.queue,
        "Maximum number of packets queued in a node; if queues deadlock, the render is repeated with twice the length, "
        "with a warning; default: as many as fit in memory, at most 8192",
        "N");
    add_file(command, FileUse::kWritten, "--packets", t.packets, "FILE.csv.gz",
             "Write every packet between nodes (superstep, source, destination, kind, bytes, ray, parent), "
             "compressed; -: "
             "stdout; see docs/packets.md",
             "Write every packet between nodes of the torus");
    offer_choices(
        add("--replay", t.replay,
            "With --packets: write the render's history for simgrid_replay: FILE.xml (the platform) and FILE.replay; "
            "see docs/packets.md",
            "simgrid"),
        {"simgrid"});
    command.add_flag("--async", t.async,
                     "Also simulate the machine without supersteps, whose nodes compute while links transfer: raya "
                     "reports this modelled time, the lower bound and the time with supersteps");
}

void refuse_options_of_other_machines(const CLI::App& command, const Machine& machine) {
    for (CLI::Option* option : const_cast<CLI::App&>(command).get_options()) {
        std::string reason = note_of(*option, kRingOnlyNote);
        if (machine.kind == MachineKind::kRing) {
            reason = option->get_group() == kTorusMachine ? kNoNodes : "";
            if (option->get_name() == "--nodes") reason = "its PEs form a ring; set their number with --pes P";
        }
        if (!reason.empty() && !option->empty() && option->results().front() != "none")
            throw UserError(fmt::format("{} {} with --machine {}: {}", option->get_name(), option->results().front(),
                                        machine.name, reason));
    }
}

namespace {

PacketCharge parse_charge(const TorusOptions& t) {
    constexpr std::uint32_t kMaxChargeWords = 4096;
    const PacketCharge charge{t.packet_words.value_or(RAYA_PACKET_WORDS), t.one_return_per_ray};
    if (charge.ray_words < RAYA_PACKET_WORDS || charge.ray_words > kMaxChargeWords)
        throw UserError(fmt::format("--packet-words {}: must be {}..{}", charge.ray_words,
                                    std::uint32_t{RAYA_PACKET_WORDS}, kMaxChargeWords));
    return charge;
}

Sides voxels_of(const TorusOptions& t, const Sides& nodes) {
    if (t.voxels.empty()) return nodes;
    const Sides voxels = parse_three_sides("--voxels", t.voxels, "at most 2^24 in total");
    // Each side is at most 10^6, so the 64-bit product does not overflow.
    if (std::uint64_t{voxels[0]} * voxels[1] * voxels[2] > kMaxPartitionVoxels)
        throw UserError(fmt::format("--voxels {}: must be at most 2^24 in total", t.voxels));
    return voxels;
}

}  // namespace

ReplayFiles::ReplayFiles(const std::string& packets) {
    const std::string stem = packets.substr(0, packets.rfind(kPacketsExtension));
    platform = stem + ".xml";
    replay = stem + ".replay";
}

TorusSettings torus_settings(const RenderOptions& o, const TorusOptions& t, const Scene& scene) {
    TorusSettings settings;
    settings.machine = machine_named(o.machine);
    const ImageSize size = image_size(o, scene);
    settings.width = size.width;
    settings.height = size.height;
    const Sides nodes =
        t.nodes.empty() ? kDefaultNodes : parse_three_sides("--nodes", t.nodes, "at most 65,536 in total");
    settings.links = t.links;
    settings.torus = make_torus(nodes, settings.links);
    settings.voxels = voxels_of(t, nodes);
    settings.inject = t.inject;
    settings.packets = parse_charge(t);
    if (t.queue == 0u) throw UserError("--queue 0: must be 1 packet or more");
    settings.queue = t.queue.value_or(0);
    settings.memory_bytes = pe_memory_of(o, settings.machine);
    settings.bounces = o.bounces.value_or(settings.machine.bounces);
    settings.format = format_of(o, settings.machine);
    settings.sampling = o.sampling;
    settings.kernels = kernel_choice(o);
    settings.history = t.async || !t.replay.empty();
    return settings;
}

}  // namespace raya
