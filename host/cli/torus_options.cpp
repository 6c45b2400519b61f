#include "host/cli/torus_options.hpp"

#include <fmt/core.h>

#include "host/cli/file_options.hpp"
#include "host/cli/options.hpp"
#include "host/cli/parse.hpp"
#include "host/error.hpp"

namespace raya {
namespace {

using Sides = std::array<std::uint32_t, 3>;

constexpr const char* kPacketsEnd = ".csv.gz";

}  // namespace

void add_torus_options(CLI::App& command, TorusOptions& t) {
    const OptionGroup group(command, kTorusMachine);
    CLI::Option* machine = command.get_option("--machine");
    machine->description(machine->get_description() +
                         "; torus: nodes of 4 MB that hold voxels of the scene, see below");
    std::vector<std::string> names;
    for (const Machine& one : machines()) names.push_back(one.name);
    offer_words(machine, names);
    const auto add = [&](const std::string& name, auto& value, const std::string& text, const std::string& type) {
        return add_value(command, name, value, text)->type_name(type);
    };
    add("--nodes", t.nodes, "Nodes along x, y and z of the scene, at most 65,536 together", "IxJxK")
        ->default_str("4x4x4");
    add("--voxels", t.voxels,
        "Equal voxels that the scene's box is cut into, at most 1024 along an axis and 2^24 together; more than "
        "nodes are laid out cyclically, fewer leave nodes empty; default: one for each node",
        "AxBxC");
    add("--links", t.links, "Links of a node: six, or four as a T805 has them: slabs of nodes beside one another",
        "torus3d|torus2d")
        ->default_str("torus3d");
    add("--inject", t.inject,
        "Who makes the primary rays: the root, which sends them to where they enter the box, or all nodes, each those "
        "that enter at its voxels",
        "root|all")
        ->default_str("all");
    add("--returns", t.returns,
        "What a return packet brings home in the model: one term of a ray, its ambient light, a light or the "
        "background; or all of a ray in 6 words, when its shadow rays are done, as Yoshitani & Yamazaki have it",
        "terms|rays")
        ->default_str("terms");
    add("--packet-words", t.packet_words,
        "Words that a ray packet is charged for in the model, in its making and on links; 16 are moved, Yoshitani & "
        "Yamazaki name 22 and more; 16..4096",
        "N")
        ->default_str("16");
    add("--queue", t.queue,
        "Packets that wait in a node at most; a queue that is too short is refused with the length that would do; "
        "default: what the memory leaves, at most 8192",
        "N");
    add("--link-exchange", t.link_exchange,
        "How packets come over the links of a device, the same ones either way: as copies between its buffers or by a "
        "kernel; auto: as raya tune found for this device, else the kernel on a CPU, elsewhere what is sooner, "
        "measured when the render begins",
        "auto|copies|kernel")
        ->default_str("auto");
    add_file(
        command, FileUse::kWritten, "--packets", t.packets, "FILE.csv.gz",
        "Write every packet between nodes (superstep, source, destination, kind, bytes, ray, parent), compressed; -: "
        "stdout; see docs/packets.md");
    offer_words(
        add("--replay", t.replay,
            "Beside the packets, write the render's history for SimGrid: FILE.xml, the platform, and FILE.replay, for "
            "simgrid_replay; see docs/packets.md",
            "simgrid"),
        {"simgrid"});
    command.add_flag("--async", t.async,
                     "Simulate the machine without supersteps too, whose nodes compute while its links carry: one "
                     "modelled time beside the two bounds");
}

namespace {

struct Foreign {
    const char *option, *reason;
};

constexpr const char* kNoPixels =
    "its nodes hold voxels of the scene, not pixels; leave it out, --nodes and --voxels say what a node holds";
constexpr const char* kNoNeighbours =
    "no node holds pixels that it could compare with their neighbours; leave it out, or choose a ring: --machine "
    "grande";
constexpr std::array<Foreign, 12> kOfRings = {
    {{"--mapping", kNoPixels},
     {"--offset", kNoPixels},
     {"--fold", kNoPixels},
     {"--pes", "its PEs are nodes; say how many with --nodes IxJxK"},
     {"--antialias", kNoNeighbours},
     {"--exchange", kNoNeighbours},
     {"--threshold", kNoNeighbours},
     {"--points", kNoNeighbours},
     {"--mask", kNoNeighbours},
     {"--cost",
      "many nodes work for a pixel, and none of them knows its cost; leave it out, or choose a ring: --machine grande"},
     {"--accel", "its voxels are the grid; cut the scene finer with --voxels AxBxC"},
     {"--keep",
      "its packets are on their way between nodes at any moment; leave it out, or choose a ring, whose picture is the "
      "same: --machine grande"}}};

constexpr const char* kNoNodes =
    "that machine is a ring of PEs without voxels; leave it out, or choose --machine torus";
constexpr std::array<Foreign, 11> kOfTorus = {{{"--nodes", "its PEs stand on a ring; say how many with --pes P"},
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
    const auto refuse = [&](const Foreign& foreign) {
        const CLI::Option* option = command.get_option_no_throw(foreign.option);
        if (option == nullptr || option->empty() || option->results().front() == "none") return;
        throw UserError(fmt::format("{} {} with --machine {}: {}", foreign.option, option->results().front(),
                                    machine.name, foreign.reason));
    };
    if (machine.kind == MachineKind::kTorus)
        for (const Foreign& foreign : kOfRings) refuse(foreign);
    else
        for (const Foreign& foreign : kOfTorus) refuse(foreign);
}

namespace {

Injection parse_injection(const std::string& text) {
    if (text.empty() || text == "all") return Injection::kAll;
    if (text == "root") return Injection::kRoot;
    throw UserError(fmt::format("--inject {}: must be root or all", text));
}

bool is_return_a_ray(const std::string& text) {
    if (text.empty() || text == "terms") return false;
    if (text == "rays") return true;
    throw UserError(fmt::format("--returns {}: must be terms or rays", text));
}

LinkMove parse_link_move(const std::string& text) {
    if (text.empty() || text == "auto") return LinkMove::kOfDevice;
    if (text == "copies") return LinkMove::kCopies;
    if (text == "kernel") return LinkMove::kKernel;
    throw UserError(fmt::format("--link-exchange {}: must be auto, copies or kernel", text));
}

PacketCharge parse_charge(const TorusOptions& t) {
    constexpr std::uint32_t kMostChargeWords = 4096;
    const PacketCharge charge{t.packet_words.value_or(RAYA_PACKET_WORDS), is_return_a_ray(t.returns)};
    if (charge.ray_words < RAYA_PACKET_WORDS || charge.ray_words > kMostChargeWords)
        throw UserError(fmt::format("--packet-words {}: must be {}..{}", charge.ray_words,
                                    std::uint32_t{RAYA_PACKET_WORDS}, kMostChargeWords));
    return charge;
}

Sides voxels_of(const TorusOptions& t, const Sides& nodes) {
    if (t.voxels.empty()) return nodes;
    const Sides voxels = parse_three_sides("--voxels", t.voxels, "at most 2^24 together");
    // The sides are 10^6 at most: no product overflows.
    if (std::uint64_t{voxels[0]} * voxels[1] * voxels[2] > kMostCutVoxels)
        throw UserError(fmt::format("--voxels {}: must be at most 2^24 together", t.voxels));
    return voxels;
}

}  // namespace

ReplayFiles::ReplayFiles(const std::string& packets) {
    const std::string stem = packets.substr(0, packets.rfind(kPacketsEnd));
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
        t.nodes.empty() ? kUsualNodes : parse_three_sides("--nodes", t.nodes, "at most 65,536 together");
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
