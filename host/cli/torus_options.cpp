#include "host/cli/torus_options.hpp"

#include <fmt/core.h>

#include "host/cli/file_options.hpp"
#include "host/cli/options.hpp"
#include "host/cli/parse.hpp"
#include "host/error.hpp"

namespace raya {
namespace {

using Sides = std::array<std::uint32_t, 3>;

constexpr const char* kPacketsExtension = ".csv.gz";

}  // namespace

void add_torus_options(CLI::App& command, TorusOptions& t) {
    const OptionGroup group(command, kTorusMachine);
    CLI::Option* machine = command.get_option("--machine");
    machine->description(machine->get_description() +
                         "; torus: nodes of 4 MB that hold voxels of the scene, see the options under Torus machine");
    std::vector<std::string> machine_names;
    for (const Machine& known : machines()) machine_names.push_back(known.name);
    offer_choices(machine, machine_names);
    const auto add = [&](const std::string& name, auto& value, const std::string& text, const std::string& type) {
        return add_value(command, name, value, text)->type_name(type);
    };
    add("--nodes", t.nodes, "Number of nodes along x, y and z of the scene, at most 65,536 in total", "IxJxK")
        ->default_str("4x4x4");
    add("--voxels", t.voxels,
        "Number of equal voxels along x, y and z that divide the scene's box, at most 1024 along an axis and 2^24 in "
        "total; more voxels than nodes are assigned cyclically, fewer voxels leave nodes empty; default: one "
        "for each node",
        "AxBxC");
    add("--links", t.links,
        "Links of a node: torus3d: six; torus2d: four, as on a T805, in a 2-D torus with the slabs of nodes side by "
        "side",
        "torus3d|torus2d")
        ->default_str("torus3d");
    add("--inject", t.inject,
        "Source of the primary rays: root: the root creates all rays and sends each to the node where the ray enters "
        "the scene's box; all: each node creates the rays that enter the box at its voxels",
        "root|all")
        ->default_str("all");
    add("--returns", t.returns,
        "Modelled contents of a return packet: terms: one contribution of a ray (ambient term, light from one light, "
        "or background); rays: all contributions of a ray, in 6 words sent after the ray's shadow rays, as in "
        "Yoshitani & Yamazaki",
        "terms|rays")
        ->default_str("terms");
    add("--packet-words", t.packet_words,
        "Modelled size of a ray packet in 32-bit words, 16..4096, for the time of its creation and transfers; the "
        "renderer itself transfers 16 words, Yoshitani & Yamazaki use 22 and more",
        "N")
        ->default_str("16");
    add("--queue", t.queue,
        "Maximum number of packets queued in a node; if the queue is too short, the error gives a sufficient length; "
        "default: as many as fit in memory, at most 8192",
        "N");
    add("--link-exchange", t.link_exchange,
        "How the host moves packets over links, which does not change the result: as copies between buffers or by a "
        "kernel; auto: as raya tune stored it, else the kernel on a CPU, elsewhere the faster method, measured when "
        "the render begins",
        "auto|copies|kernel")
        ->default_str("auto");
    add_file(
        command, FileUse::kWritten, "--packets", t.packets, "FILE.csv.gz",
        "Write every packet between nodes (superstep, source, destination, kind, bytes, ray, parent), compressed; -: "
        "stdout; see docs/packets.md");
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

namespace {

/// An option that does not apply to a machine; the reason completes the error message.
struct InapplicableOption {
    const char *option, *reason;
};

constexpr const char* kNoPixels =
    "its nodes hold voxels of the scene, not pixels; leave it out: --nodes and --voxels set what a node holds";
constexpr const char* kNoNeighbours =
    "its nodes hold no pixels to compare with their neighbours; leave it out, or choose a ring: --machine grande";
constexpr std::array<InapplicableOption, 11> kRingOnlyOptions = {
    {{"--mapping", kNoPixels},
     {"--offset", kNoPixels},
     {"--fold", kNoPixels},
     {"--pes", "its PEs are nodes; set their number with --nodes IxJxK"},
     {"--antialias", kNoNeighbours},
     {"--exchange", kNoNeighbours},
     {"--threshold", kNoNeighbours},
     {"--points", kNoNeighbours},
     {"--mask", kNoNeighbours},
     {"--cost",
      "several nodes work for a pixel, so that no node has its cost; leave it out, or choose a ring: --machine grande"},
     {"--accel", "its voxels are the grid; refine it with --voxels AxBxC"}}};

constexpr const char* kNoNodes =
    "that machine is a ring of PEs without voxels; leave it out, or choose --machine torus";
constexpr std::array<InapplicableOption, 11> kTorusOnlyOptions = {
    {{"--nodes", "its PEs form a ring; set their number with --pes P"},
     {"--voxels", kNoNodes},
     {"--links", kNoNodes},
     {"--inject", kNoNodes},
     {"--returns", kNoNodes},
     {"--packet-words", kNoNodes},
     {"--queue", kNoNodes},
     {"--link-exchange", kNoNodes},
     {"--packets", kNoNodes},
     {"--replay", kNoNodes},
     {"--async", kNoNodes}}};

}  // namespace

void refuse_options_of_other_machines(const CLI::App& command, const Machine& machine) {
    const auto refuse = [&](const InapplicableOption& inapplicable) {
        const CLI::Option* option = command.get_option_no_throw(inapplicable.option);
        if (option == nullptr || option->empty() || option->results().front() == "none") return;
        throw UserError(fmt::format("{} {} with --machine {}: {}", inapplicable.option, option->results().front(),
                                    machine.name, inapplicable.reason));
    };
    if (machine.kind == MachineKind::kTorus)
        for (const InapplicableOption& inapplicable : kRingOnlyOptions) refuse(inapplicable);
    else
        for (const InapplicableOption& inapplicable : kTorusOnlyOptions) refuse(inapplicable);
}

namespace {

Injection parse_injection(const std::string& text) {
    if (text.empty() || text == "all") return Injection::kAll;
    if (text == "root") return Injection::kRoot;
    throw UserError(fmt::format("--inject {}: must be root or all", text));
}

bool returns_whole_rays(const std::string& text) {
    if (text.empty() || text == "terms") return false;
    if (text == "rays") return true;
    throw UserError(fmt::format("--returns {}: must be terms or rays", text));
}

LinkMove parse_link_move(const std::string& text) {
    if (text.empty() || text == "auto") return LinkMove::kAutomatic;
    if (text == "copies") return LinkMove::kCopies;
    if (text == "kernel") return LinkMove::kKernel;
    throw UserError(fmt::format("--link-exchange {}: must be auto, copies or kernel", text));
}

PacketCharge parse_charge(const TorusOptions& t) {
    constexpr std::uint32_t kMaxChargeWords = 4096;
    const PacketCharge charge{t.packet_words.value_or(RAYA_PACKET_WORDS), returns_whole_rays(t.returns)};
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
    settings.links = t.links.empty() ? Links::kTorus3d : parse_links(t.links);
    settings.torus = make_torus(nodes, settings.links);
    settings.voxels = voxels_of(t, nodes);
    settings.inject = parse_injection(t.inject);
    settings.packets = parse_charge(t);
    if (t.queue == 0u) throw UserError("--queue 0: must be 1 packet or more");
    settings.queue = t.queue.value_or(0);
    settings.memory_bytes = pe_memory_of(o, settings.machine);
    settings.bounces = o.bounces.value_or(settings.machine.bounces);
    settings.format = format_of(o, settings.machine);
    settings.sampling = parse_sampling(o.sampling);
    settings.kernels = kernel_choice(o);
    settings.kernels.link_move = parse_link_move(t.link_exchange);
    settings.history = t.async || !t.replay.empty();
    return settings;
}

}  // namespace raya
