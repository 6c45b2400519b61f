#include "host/cli/render_options.hpp"

#include <fmt/core.h>

#include "host/accel/bvh.hpp"
#include "host/cli/options.hpp"
#include "host/error.hpp"
#include "host/ring/mapping.hpp"

namespace raya {
namespace {

constexpr const char* kRingOnlyNote = "ring only";

void add_antialias_options(CLI::App& command, RenderOptions& o) {
    ring_only(add_choice(
        command, "--antialias", o.antialias, kAntialiasChoices,
        "filter: mean of each pixel's 3 x 3 neighbourhood; supersample: four more samples for pixels that differ "
        "from a neighbour. PEs exchange border pixels as --exchange sets",
        "3 x 3 filter or adaptive supersampling"));
    ring_only(add_choice(
        command, "--exchange", o.exchange,
        Choices<ExchangeMethod>{{"ring", ExchangeMethod::kRing},
                                {"bus", ExchangeMethod::kBus},
                                {"bus-broadcast", ExchangeMethod::kBroadcast}},
        "How PEs get the neighbours of their pixels: ring: all PEs send a block to the next PE at once; bus: one "
        "PE at a time sends to one other PE; bus-broadcast: one PE at a time sends to all PEs. All three give "
        "the same image; default: ring"));
    ring_only(
        in_range(add_value(command, "--threshold T", o.threshold,
                           "Supersample pixels whose colour, clamped to 0..1, differs from a neighbour's by T or more, "
                           "0..1; default: 0.125"),
                 0, 1));
    ring_only(add_choice(
        command, "--points", o.points,
        Choices<raya_u32>{{"axes", RAYA_POINTS_AXES}, {"diagonals", RAYA_POINTS_DIAGONALS}},
        "Positions of the four samples: axes: half a pixel left, right, above and below; diagonals: half a pixel "
        "away on both axes; default: axes"));
}

}  // namespace

CLI::Option* ring_only(CLI::Option* option) { return attach_note(option, kRingOnlyNote, "x"); }

void add_render_options(CLI::App& command, RenderOptions& o, bool antialiasing) {
    add_strict_option(command, o.strict);
    OptionGroup group(command, kImageGroup);
    add_value(command, "--size N|WxH", o.size, "Image size in pixels, 1..16384 a side; default: the scene's resolution",
              "Size in pixels, 1..16384 a side; default: the scene's");
    add_value(command, "--bounces N", o.bounces,
              "Maximum number of reflections and refractions after the primary ray, 0..31; default: 8",
              "Reflections and refractions, 0..31; default: 8");
    add_choice(command, "--sampling", o.sampling,
               Choices<Sampling>{{"centres", Sampling::kCentres}, {"corners", Sampling::kCorners}},
               "Primary rays pass through pixel centres, or through pixel corners as in SPD");
    if (antialiasing) add_antialias_options(command, o);
    add_view_options(command, o.view);
    group.next(kMachine);
    add_value(
        command, "--machine NAME", o.machine,
        "spa: 256 PEs of 32 KB; grande: a PE for each image column, no memory limit; spa1: one PE of 32 KB; "
        "cap (256 PEs), pixel-machine (64), links (256): the published arrays of these names, but with spa's PEs and "
        "no memory limit; for comparing loads",
        "spa (256 PEs of 32 KB), grande, torus and others; raya machines")
        ->capture_default_str();
    ring_only(add_value(command, "--pes P", o.pes,
                        "Number P of processing elements, 1..W*H; default: the machine's, or A*B of a grid",
                        "Number of PEs; default: the machine's"));
    ring_only(in_range(
        add_value(command, "--split G", o.split,
                  "Number G of parts of the objects, which rotate on the ring; a divisor of P; 1: every PE stores all "
                  "objects; default: the smallest number with which the scene fits a PE",
                  "Parts of the objects, which rotate on the ring"),
        1));
    ring_only(in_range(add_value(command, "--display-rate R", o.display_rate,
                                 "Pixels that the modelled machine displays in a second; default: the machine's"),
                       1, 1e12));
    ring_only(
        add_value(command, "--offset p", o.offset,
                  "Offset p of the cyclic mapping in pixels, 0..W-1; default: 16 (modulo W) on spa and grande, 0 on "
                  "the other machines",
                  "Offset of the cyclic mapping; default: 16"));
    ring_only(add_value(
        command, "--mapping NAME", o.mapping,
        "Assignment of pixels to PEs: cyclic (slots of a sheared image, --offset), cyclic:p, column (cyclic with "
        "offset 0: whole columns), rows (scan lines round robin), blocks (contiguous scan lines), grid:AxB (A rows "
        "of B PEs; a PE has every B-th pixel of every A-th line), tiles:WxH (tiles of W x H pixels round robin), "
        "random:seed (default seed 1); dynamic:CHUNK[,OVERHEAD[,ROOT]]: PEs request CHUNK pixels at a time, each "
        "request costs the PE OVERHEAD cycles and occupies the root, which answers one at a time, for ROOT cycles; "
        "hybrid:CHUNK[,OVERHEAD[,SHARE[,ROOT]]]: PEs request pixels after rendering a fraction SHARE (0.5) of "
        "their "
        "cyclic pixels; the loads of dynamic and hybrid are simulated; default: the machine's, cyclic on spa",
        "Pixels to PEs: cyclic, column, rows, blocks, grid:AxB, tiles:WxH, random, dynamic:CHUNK, hybrid:CHUNK"));
    ring_only(add_choice(command, "--fold", o.fold, kFoldChoices,
                         "PE of slot c if P is not W: cyclic (c mod P) or block (c P div W); default: cyclic"));
    ring_only(add_value(command, "--accel none|bvh|grid[:AxBxC]", o.accel,
                        "Acceleration structure in each PE's memory, which does not change the hits: none: every ray "
                        "is tested against "
                        "all objects; bvh: faster from a few hundred objects on; grid: a uniform grid of A x B x C "
                        "voxels along x, y, "
                        "z, by default a few voxels per object; default: none; on grande bvh if it is faster, from "
                        "about 100 spheres "
                        "or 30 polygons on",
                        "Acceleration structure in each PE's memory"));
    in_range(
        add_value(command, "--pe-memory BYTES", o.pe_memory,
                  "Memory in bytes of a PE, or of a torus node with all its buffers; default: the machine's, 32768 "
                  "on spa, 4194304 on torus, no limit on grande"),
        1);
    group.next(kKernels);
    add_value(
        command, "--format NAME", o.format,
        "Number format of the kernels: fp32, spa22 (e6m15), or eXmY[t]: X = 5..8 exponent bits, Y = 4..21 "
        "fraction bits, t truncates; default: the machine's, fp32 on grande and torus, e6m15 on the other machines",
        "Number format: fp32, spa22 (e6m15) or eXmY[t]");
    add_device_option(command, o.device);
    add_choice(command, "--lanes", o.lanes, Choices<std::uint32_t>{{"1", 1}, {"4", 4}, {"8", 8}, {"16", 16}},
               "Number V of rays per work-item: 1, 4, 8 or 16; default: as raya tune stored it, else the width of the "
               "device's float vectors")
        ->type_name("V");
    in_range(add_value(command, "--group L", o.group,
                       "Number L of work-items in the work-group that simulates a PE, 1..1024; default: as raya tune "
                       "stored it, else 1 on a CPU, 128 elsewhere"),
             1, 1024);
    add_tuned_option(command, o.no_tuned);
    add_kernel_source_options(command, o.kernel_dir);
}

namespace {

Antialias antialias_settings(const RenderOptions& o) {
    Antialias antialias;
    antialias.method = o.antialias;
    antialias.points = o.points.value_or(antialias.points);
    antialias.exchange = o.exchange.value_or(antialias.exchange);
    if (antialias.method != AntialiasMethod::kSupersample && (o.threshold || o.points))
        throw UserError("--threshold and --points require supersampling: add --antialias supersample");
    if (antialias.method == AntialiasMethod::kNone && o.exchange)
        throw UserError("--exchange requires anti-aliasing: add --antialias filter or supersample");
    antialias.threshold = o.threshold.value_or(antialias.threshold) + 0.0;  // + 0.0 turns -0 into 0
    return antialias;
}

// --offset and --fold apply only to mappings with slots. Throws UserError if one of them is given for another mapping,
// if --offset contradicts the mapping's own offset (--mapping cyclic:8 --offset 16), or if --offset is out of range.
void check_slot_options(const RenderOptions& o, const MappingText& mapping, const ImageSize& image) {
    const bool has_slots = mapping.rule.has_slots();
    if (!has_slots && o.offset)
        throw UserError(
            fmt::format("--offset {} with --mapping {}: {} has no offset; leave out --offset, or choose cyclic",
                        *o.offset, mapping.text, mapping.name()));
    if (!has_slots && o.fold)
        throw UserError(fmt::format(
            "--fold with --mapping {}: {} has no slots to fold; leave out --fold, or choose cyclic or column",
            mapping.text, mapping.name()));
    if (o.offset && !mapping.takes_offset_option && *o.offset != mapping.rule.parameter)
        throw UserError(fmt::format("--offset {} with --mapping {}: the mapping's offset is {}; leave out one of them",
                                    *o.offset, mapping.text, mapping.rule.parameter));
    if (o.offset && *o.offset >= image.width)
        throw UserError(
            fmt::format("--offset {}: must be 0..{}, less than the image's width", *o.offset, image.width - 1));
}

// Returns the mapping's rule with offset and fold. For "cyclic" without p, the offset is --offset or, if it is not
// given, the machine's offset modulo the image's width.
MappingRule rule_of(const MappingText& mapping, const RenderOptions& o, const Machine& machine, std::uint32_t width) {
    if (!mapping.rule.has_slots()) return mapping.rule;
    const std::uint32_t default_offset = machine.mapping.has_slots() ? machine.mapping.parameter % width : 0;
    const std::uint32_t offset =
        mapping.takes_offset_option ? o.offset.value_or(default_offset) : mapping.rule.parameter;
    return cyclic_mapping(offset, o.fold.value_or(Fold::kCyclic));
}

// Sets settings.mapping, and settings.dynamic if the mapping is dynamic or hybrid.
void set_mapping(RingSettings& settings, const RenderOptions& o, const ImageSize& image) {
    const Machine& machine = settings.machine;
    if (o.mapping.empty())
        settings.dynamic = machine.dynamic;
    else if (is_dynamic(o.mapping))
        settings.dynamic = parse_dynamic(o.mapping, machine.dynamic.value_or(DynamicPlan{}));
    // The host only simulates a dynamic or hybrid mapping, while the device traces with the cyclic mapping. A hybrid
    // mapping assigns its static part cyclically, too.
    MappingText mapping{mapping_text(machine.mapping), machine.mapping, false};
    if (o.mapping.empty() ? machine.mapping.has_slots() : is_dynamic(o.mapping))
        mapping = parse_mapping("cyclic");
    else if (!o.mapping.empty())
        mapping = parse_mapping(o.mapping);
    check_slot_options(o, mapping, image);
    const std::uint32_t pes = o.pes.value_or(mapping.rule.pes().value_or(machine.pes.value_or(image.width)));
    settings.mapping = make_mapping(rule_of(mapping, o, machine, image.width), image, pes);
}

/// Returns --format, by default the machine's format.
NumberFormat format_of(const RenderOptions& o, const Machine& machine) {
    return o.format.empty() ? machine.format : parse_format(o.format);
}

/// Returns --lanes and --group (0: not given) and --kernel-dir.
KernelChoice kernel_choice(const RenderOptions& o) {
    KernelChoice choice;
    choice.lanes = o.lanes.value_or(0);
    choice.group_size = o.group.value_or(0);
    choice.sources.folder = o.kernel_dir;
    return choice;
}

/// Returns --pe-memory, the memory of a PE in bytes, by default the machine's. Empty: no limit.
std::optional<std::uint64_t> pe_memory_of(const RenderOptions& o, const Machine& machine) {
    return o.pe_memory ? o.pe_memory : machine.pe_memory_bytes;
}

}  // namespace

ImageSize image_size(const RenderOptions& o, const Scene& scene) {
    ImageSize size = {static_cast<std::uint32_t>(scene.view.width), static_cast<std::uint32_t>(scene.view.height)};
    if (!o.size.empty()) size = parse_image_size(o.size);
    if (size.width > kMaxSide || size.height > kMaxSide)
        throw UserError(
            fmt::format("--size {}x{}: both sides must be 1..{} pixels", size.width, size.height, kMaxSide));
    return size;
}

RingSettings ring_settings(const RenderOptions& o, const Scene& scene) {
    RingSettings settings;
    settings.machine = machine_named(o.machine);
    if (settings.machine.kind == MachineKind::kTorus)
        throw UserError(fmt::format(
            "--machine {}: its nodes hold voxels of the scene, not pixels; only raya render supports this machine; "
            "choose a ring: spa",
            o.machine));
    settings.format = format_of(o, settings.machine);
    settings.sampling = o.sampling;
    set_mapping(settings, o, image_size(o, scene));
    settings.bounces = o.bounces.value_or(settings.machine.bounces);
    settings.antialias = antialias_settings(o);
    settings.split = o.split.value_or(0);
    if (o.display_rate) settings.machine.clock.display_pixels_per_s = *o.display_rate;
    // A machine's BVH is left out if the objects are in parts, or so few that it costs more time than it saves.
    const bool pays = settings.machine.accel.kind != AccelKind::kBvh || bvh_pays(scene, settings.format);
    settings.accel = !o.accel.empty()                   ? parse_accel(o.accel)
                     : pays && o.split.value_or(0) <= 1 ? settings.machine.accel
                                                        : Accel{};
    settings.machine.pe_memory_bytes = pe_memory_of(o, settings.machine);
    settings.kernels = kernel_choice(o);
    return settings;
}

void add_torus_options(CLI::App& command, TorusOptions& t) {
    const OptionGroup group(command, kTorusMachine);
    CLI::Option* machine = command.get_option("--machine");
    machine->description(machine->get_description() +
                         "; torus: nodes of 4 MB that hold voxels of the scene, see the options under Torus machine");
    add_value(command, "--nodes IxJxK", t.nodes,
              "Number of nodes along x, y and z of the scene, at most 65,536 in total",
              "Nodes of the torus along x, y and z")
        ->default_str("4x4x4");
    add_value(
        command, "--voxels AxBxC", t.voxels,
        "Number of equal voxels along x, y and z that divide the scene's box, at most 1024 along an axis and 2^24 in "
        "total; more voxels than nodes are assigned cyclically, fewer voxels leave nodes empty; default: one "
        "for each node");
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
    in_range(add_value(
                 command, "--packet-words N", t.packet_words,
                 "Modelled size of a ray packet in 32-bit words, 16..4096, for the time of its creation and transfers; "
                 "the renderer itself transfers 16 words, Yoshitani & Yamazaki use 22 and more"),
             RAYA_PACKET_WORDS, 4096)
        ->default_str("16");
    in_range(
        add_value(
            command, "--queue N", t.queue,
            "Maximum number of packets queued in a node; if queues deadlock, the render is repeated with twice the "
            "length, with a warning; default: as many as fit in memory, at most 8192"),
        1);
    command.add_flag("--async", t.async,
                     "Also simulate the machine without supersteps, whose nodes compute while links transfer: raya "
                     "reports this modelled time, the lower bound and the time with supersteps");
}

void refuse_options_of_other_machines(const CLI::App& command, const Machine& machine) {
    const bool ring = machine.kind == MachineKind::kRing;
    for (const CLI::Option* option : command.get_options()) {
        const bool refused = ring ? option->get_group() == kTorusMachine : !note_of(*option, kRingOnlyNote).empty();
        if (refused && !option->empty() && option->results().front() != "none")
            throw UserError(fmt::format(
                "{} {} with --machine {}: an option of {}; leave it out, or choose --machine {}", option->get_name(),
                option->results().front(), machine.name, ring ? "the torus" : "rings", ring ? "torus" : "grande"));
    }
}

TorusSettings torus_settings(const RenderOptions& o, const TorusOptions& t, const Scene& scene) {
    TorusSettings settings;
    settings.machine = machine_named(o.machine);
    const ImageSize size = image_size(o, scene);
    settings.width = size.width;
    settings.height = size.height;
    const std::array<std::uint32_t, 3> nodes =
        t.nodes.empty() ? kDefaultNodes : parse_three_sides("--nodes", t.nodes, "at most 65,536 in total");
    settings.links = t.links;
    settings.torus = make_torus(nodes, settings.links);
    settings.voxels = nodes;
    if (!t.voxels.empty()) settings.voxels = parse_three_sides("--voxels", t.voxels, "at most 2^24 in total");
    // Each side is at most 10^6, so the 64-bit product does not overflow.
    if (std::uint64_t{settings.voxels[0]} * settings.voxels[1] * settings.voxels[2] > kMaxPartitionVoxels)
        throw UserError(fmt::format("--voxels {}: must be at most 2^24 in total", t.voxels));
    settings.inject = t.inject;
    settings.packets = {t.packet_words.value_or(RAYA_PACKET_WORDS), t.one_return_per_ray};
    settings.queue = t.queue.value_or(0);
    settings.memory_bytes = pe_memory_of(o, settings.machine);
    settings.bounces = o.bounces.value_or(settings.machine.bounces);
    settings.format = format_of(o, settings.machine);
    settings.sampling = o.sampling;
    settings.kernels = kernel_choice(o);
    settings.history = t.async;
    return settings;
}

}  // namespace raya
