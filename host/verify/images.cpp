// Checks of layer "image": renders the reference images with settings that must not change any bit of the image.
#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <vector>

#include "host/model/machine.hpp"
#include "host/model/number_format.hpp"
#include "host/ring/mapping.hpp"
#include "host/ring/ring_renderer.hpp"
#include "host/torus/history.hpp"
#include "host/torus/topology.hpp"
#include "host/torus/torus_renderer.hpp"
#include "host/verify/reference_images.hpp"
#include "host/verify/verify.hpp"

namespace raya {
namespace {

// kGrid, kBvh: the ring with it; kPackets: of rays, with a BVH.
enum class Renderer { kRing, kGrid, kBvh, kPackets, kTorus };
constexpr auto kGrid = Renderer::kGrid, kBvh = Renderer::kBvh, kPackets = Renderer::kPackets, kTorus = Renderer::kTorus;

/// A reference image and the settings that must not change any bit of it.
struct Rendering {
    std::string image;
    Depth depth = Depth::kFull;               // verify() includes the rendering at this and greater depths
    std::uint32_t lanes = 0, group_size = 0;  // 0: the device's default
    MappingRule mapping = cyclic_mapping(8);  // mapping of pixels to PEs of the ring
    std::uint32_t pes = kReferenceSide;
    std::uint32_t work_per_launch = 0;  // see RingSettings and TorusSettings; 0: default
    Renderer renderer = Renderer::kRing;
    std::array<std::uint32_t, 3> nodes = {2, 2, 2};
    // More voxels than nodes, so that some nodes have several.
    std::array<std::uint32_t, 3> voxels = {nodes[0] + 1, nodes[1] + 2, nodes[2]};
    Links links = Links::kTorus3d;
    Injection inject = Injection::kAll;
    std::uint32_t queue = 0;     // capacity of the queues of the torus, packets; 0: default
    std::uint32_t pe_bytes = 0;  // memory of a PE of the ring; 0: no limit
    std::uint32_t split = 1;     // RingSettings::split
    bool history = false;        // record the cycles of each packet and check their sum in each node
    bool global_words = false;   // job words are in global memory, as if local memory were too small
    bool fallback_code = false;  // as if the device did not round division, square root and fma correctly, and the
                                 // compiler had none of the builtins that raya uses

    /// Returns the name of the renderer with its accelerator, parts or torus, such as "ring", "bvh", "2 parts" or
    /// "torus2d 3x2x2 root".
    /// It is the key in StoredImage::counts: renderings of an image by the same renderer have equal counts.
    std::string check_kind() const;

    std::string name() const;
};

std::string Rendering::check_kind() const {
    if (split > 1) return fmt::format("{} parts", split);
    if (renderer != kTorus) return std::array{"ring", "grid", "bvh", "packets"}[static_cast<std::size_t>(renderer)];
    return fmt::format("{} {}{}{}", links_name(links), sides_text(nodes), inject == Injection::kRoot ? " root" : "",
                       queue ? fmt::format(", queue {}", queue) : "");
}

std::string Rendering::name() const {
    std::string text = check_kind();
    const std::string mapping_name = mapping == column_mapping()   ? "column"
                                     : mapping.kind == RAYA_RANDOM ? "random"
                                                                   : mapping_text(mapping);
    if (renderer != kTorus) text = fmt::format("{} on {}{}", mapping_name, pes, text == "ring" ? "" : ", " + text);
    if (mapping.kind == RAYA_FOLD_BLOCK) text += ", block fold";
    if (work_per_launch) text += ", launches of " + counted(work_per_launch, renderer == kTorus ? "unit" : "test");
    if (pe_bytes) text += fmt::format(", PEs of {} bytes", pe_bytes);
    if (history) text += ", history";
    if (global_words) text += ", global words";
    if (fallback_code) text += ", fallback code";
    if (lanes) text += fmt::format(", {}x{}", lanes, group_size);
    if (!lanes && group_size) text += fmt::format(", groups of {}", group_size);
    return fmt::format("{}: {}", image, text);
}

// Returns renderings that together use every kernel and option. Building kernels takes most of a rendering's time, so
// renderings with equal build options are adjacent and use the same build. For the same reason some renderings of
// depth kQuick combine several features, such as global words and fallback code. The renderings of depth kBrief need
// three builds: one for each machine and one for a reduced format.
std::vector<Rendering> standard_renderings() {
    constexpr auto k2d = Links::kTorus2d;
    constexpr auto kRoot = Injection::kRoot;
    constexpr auto kBrief = Depth::kBrief, kQuick = Depth::kQuick;
    return {
        {.image = "glass fp32", .depth = kBrief},
        {.image = "glass fp32 filter", .depth = kBrief, .mapping = cyclic_mapping(5), .pes = 10},
        {.image = "glass fp32 axes", .depth = kBrief, .mapping = rows_mapping(), .pes = 16},
        {.image = "glass fp32 diagonals",
         .depth = kQuick,
         .mapping = grid_mapping(4, 4),
         .pes = 16,
         .work_per_launch = 1},
        {.image = "glass fp32 filter",
         .depth = kQuick,
         .group_size = 8,
         .mapping = cyclic_mapping(8, Fold::kBlock),
         .pes = 7,
         .work_per_launch = 1,
         .pe_bytes = 3300},
        {.image = "glass fp32", .depth = kQuick, .mapping = tiles_mapping(5, 4), .pes = 7},
        {.image = "glass fp32", .global_words = true},
        {.image = "glass fp32", .fallback_code = true},
        {.image = "glass fp32", .lanes = 1, .group_size = 1, .pes = 1},
        {.image = "glass fp32", .lanes = 4, .group_size = 32, .mapping = random_mapping(1), .pes = 5},
        {.image = "glass fp32", .depth = kQuick, .split = 5},
        {.image = "glass fp32 axes",
         .depth = kQuick,
         .mapping = rows_mapping(),
         .pes = 10,
         .pe_bytes = 5000,
         .split = 2},
        {.image = "ties fp32", .depth = kQuick, .pe_bytes = 2000, .split = kReferenceSide},
        {.image = "ties fp32",
         .depth = kQuick,
         .mapping = blocks_mapping(),
         .pes = 5,
         .global_words = true,
         .fallback_code = true},
        {.image = "ties fp32"},
        {.image = "ties fp32", .renderer = kGrid},
        {.image = "ties fp32", .renderer = kBvh},
        {.image = "ties fp32", .renderer = kTorus},
        {.image = "polygons fp32", .mapping = tiles_mapping(5, 4), .pes = 7},
        {.image = "polygons fp32", .depth = kQuick, .renderer = kGrid},
        {.image = "polygons fp32", .renderer = kGrid, .global_words = true, .fallback_code = true},
        {.image = "far fp32", .depth = kQuick, .renderer = kGrid},
        {.image = "polygons fp32", .depth = kQuick, .renderer = kBvh},
        {.image = "leaves fp32", .depth = kQuick, .lanes = 4, .group_size = 1, .renderer = kBvh},
        {.image = "leaves spa22", .depth = kQuick, .lanes = 1, .group_size = 1, .renderer = kBvh},
        {.image = "polygons fp32", .depth = kQuick, .mapping = tiles_mapping(4, 4), .pes = 7, .renderer = kPackets},
        {.image = "leaves fp32", .mapping = tiles_mapping(4, 4), .pes = 7, .renderer = kPackets},
        {.image = "cones fp32", .mapping = tiles_mapping(20, 1), .pes = 7, .renderer = kPackets, .fallback_code = true},
        {.image = "polygons fp32", .renderer = kBvh, .global_words = true, .fallback_code = true},
        {.image = "cones fp32", .lanes = 8, .group_size = 1, .renderer = kBvh, .fallback_code = true},
        {.image = "polygons fp32", .lanes = 4, .group_size = 1, .renderer = kBvh, .fallback_code = true},
        {.image = "polygons fp32", .depth = kQuick, .renderer = kTorus},
        {.image = "polygons fp32", .depth = kQuick, .work_per_launch = 1, .renderer = kTorus},
        {.image = "far fp32",
         .depth = kQuick,
         .group_size = 64,
         .renderer = kTorus,
         .nodes = {3, 2, 2},
         .voxels = {4, 2, 2},
         .history = true,
         .fallback_code = true},
        {.image = "far fp32",
         .depth = kQuick,
         .group_size = 64,
         .renderer = kTorus,
         .nodes = {3, 2, 2},
         .voxels = {4, 2, 2},
         .queue = 40,
         .history = true,
         .fallback_code = true},
        {.image = "polygons fp32", .renderer = kTorus, .global_words = true},
        {.image = "polygons fp32",
         .depth = kBrief,
         .renderer = kTorus,
         .nodes = {3, 2, 2},
         .links = k2d,
         .inject = kRoot},
        {.image = "cones fp32", .mapping = blocks_mapping(), .pes = 5, .global_words = true},
        {.image = "mirrors spa22", .depth = kBrief, .mapping = column_mapping(), .pes = kReferenceSide},
        {.image = "mirrors spa22 filter", .depth = kQuick, .mapping = cyclic_mapping(16), .pes = kReferenceSide},
        {.image = "cones e5m10", .depth = kQuick, .fallback_code = true},
        {.image = "mirrors spa22", .fallback_code = true},
        {.image = "polygons spa22", .renderer = kTorus, .fallback_code = true},
        {.image = "mirrors spa22 axes", .mapping = cyclic_mapping(3), .pes = 100},
        {.image = "mirrors spa22", .split = kReferenceSide, .global_words = true},
        {.image = "planes fp32 corners", .renderer = kGrid},
        {.image = "spheres e8m12t", .depth = kQuick},
        {.image = "glass e8m21"},
        {.image = "mirrors spa22", .renderer = kTorus, .links = k2d},
        {.image = "polygons spa22", .renderer = kGrid},
        {.image = "polygons spa22", .depth = kQuick, .renderer = kBvh},
        {.image = "spheres e8m12t", .renderer = kBvh},
        {.image = "polygons spa22", .renderer = kTorus, .nodes = {1, 3, 2}, .inject = kRoot},
        {.image = "glass fp32", .renderer = kTorus, .nodes = {4, 4, 4}, .links = k2d},
        {.image = "glass fp32", .lanes = 1, .group_size = 1, .renderer = kTorus, .queue = 21}};
}

// Returns renderings with every number of lanes and groups of 1 and 32 work-items, on both machines, in fp32 and
// reduced formats.
std::vector<Rendering> renderings_of_all_builds() {
    const std::vector<Rendering> renderings = {
        {.image = "glass fp32"},
        {.image = "polygons fp32"},
        {.image = "mirrors spa22"},
        {.image = "cones e5m10"},
        {.image = "spheres e8m12t"},
        {.image = "polygons fp32", .renderer = kGrid},
        {.image = "polygons fp32", .renderer = kBvh},
        {.image = "polygons fp32", .renderer = kTorus},
        {.image = "polygons spa22", .renderer = kGrid},
        {.image = "polygons spa22", .renderer = kBvh},
        {.image = "polygons spa22", .renderer = kTorus},
        {.image = "polygons fp32", .mapping = tiles_mapping(4, 4), .pes = 7, .renderer = kPackets},
        {.image = "glass fp32 filter"},
        {.image = "mirrors spa22 axes"}};
    std::vector<Rendering> all;
    for (const std::uint32_t lanes : {1u, 4u, 8u, 16u})
        for (const std::uint32_t group : {1u, 32u})
            for (const Rendering& r : renderings) {
                all.push_back(r);
                all.back().lanes = lanes;
                all.back().group_size = group;
            }
    return all;
}

KernelChoice kernels_for(KernelChoice choice, const Rendering& r) {
    choice.local_words = !r.global_words;
    choice.exact_arithmetic = !r.fallback_code;
    if (r.fallback_code) choice.sources.more_options.emplace_back(kNoBuiltins);
    return choice;
}

struct Rendered {
    Image image;
    std::string options;  // build options of the kernels
    std::string counts;   // text of counts_text()
    std::string fault{};  // another wrong result; empty: none
};

// Returns a fault if the cycles of a node differ from the sum of the cycles of its tasks.
std::string history_fault(const TorusResult& result, const History& history) {
    std::vector<std::uint64_t> cycles(result.load.per_pe.size());
    for (const HistoryTask& task : history.tasks) cycles[task.node] += task.cycles;
    const auto [got, expected] = std::ranges::mismatch(cycles, result.load.per_pe);
    if (got == cycles.end()) return "";
    return fmt::format("node {}: its packets took {} cycles, the node {}", got - cycles.begin(), *got, *expected);
}

Rendered render_on_ring(const KernelChoice& kernels, Session& session, const Rendering& r) {
    const ReferenceImage& image = reference_image_named(r.image);
    RingSettings settings = reference_settings(image);
    settings.mapping = make_mapping(r.mapping, image.size, r.pes);
    const bool is_plain = r.renderer == Renderer::kRing, packets = r.renderer == kPackets;
    settings.accel.kind = is_plain ? AccelKind::kNone : r.renderer == kGrid ? AccelKind::kGrid : AccelKind::kBvh;
    settings.work_per_launch = r.work_per_launch;
    settings.split = r.split;
    settings.kernels = kernels_for(kernels, r);
    settings.packets = packets;
    settings.record_costs = !packets;
    if (r.pe_bytes) settings.machine.pe_memory_bytes = r.pe_bytes;
    RingResult result = RingRenderer(session, scene_of(image), settings).render();
    std::vector<std::pair<const char*, std::uint64_t>> cycles = {{"cycles", sum_of(result.load.per_pe)}};
    if (!packets) cycles.emplace_back("pixel_cycles", sum_of(result.cost().cycles));
    if (r.split > 1) {
        std::uint64_t barrier_cycles = 0;
        for (const Phase& phase : result.phases) barrier_cycles += phase.barrier_cycles();
        cycles.insert(cycles.end(),
                      {{"rotations", result.communication.rotations}, {"barrier_cycles", barrier_cycles}});
    }
    const std::string counts = counts_text(result.events, cycles);
    return {std::move(result.image), result.build_options, counts};
}

Rendered render_on_torus(const KernelChoice& kernels, Session& session, const Rendering& r) {
    const ReferenceImage& image = reference_image_named(r.image);
    TorusSettings s = default_torus(image.size);
    s.torus = make_torus(r.nodes, r.links);
    s.links = r.links;
    s.voxels = r.voxels;
    s.inject = r.inject;
    s.packets.one_return_per_ray = r.inject == Injection::kRoot;  // so that the checks cover both values
    s.bounces = kReferenceBounces;
    s.format = parse_format(image.format);
    s.sampling = image.sampling;
    s.work_per_launch = r.work_per_launch;
    s.kernels = kernels_for(kernels, r);
    s.history = r.history;
    s.queue = r.queue;
    HistoryRecorder recorder(s.torus, s.packets);
    RenderObservers observers;
    if (r.history) observers.work = [&](const NodeWork& work) { recorder.add(work); };
    TorusResult result = TorusRenderer(session, scene_of(image), s).render({}, observers);
    std::vector<std::pair<const char*, std::uint64_t>> counts = {
        {"cycles", sum_of(result.load.per_pe)}, {"packets", sum_of(result.made)}, {"hops", result.hops}};
    // With a short queue, the supersteps depend on the number of packets that a node processes at a time.
    if (r.queue == 0 || (r.lanes == 1 && r.group_size == 1)) {
        std::uint64_t busiest_cycles = 0, busiest_words = 0;
        for (const Superstep& step : result.supersteps) {
            busiest_cycles += step.max_node_cycles;
            busiest_words += step.max_link_words;
        }
        counts.insert(counts.end(), {{"supersteps", result.supersteps.size()},
                                     {"queue_max", result.queue_max},
                                     {"busiest_cycles", busiest_cycles},
                                     {"busiest_words", busiest_words}});
    }
    const std::string fault = r.history ? history_fault(result, recorder.finish()) : "";
    return {std::move(result.image), result.build_options, counts_text(result.events, counts), fault};
}

Rendered render(const KernelChoice& kernels, Session& session, const Rendering& r) {
    return r.renderer == kTorus ? render_on_torus(kernels, session, r) : render_on_ring(kernels, session, r);
}

Verdict check_rendering(const Verification& v, Session& session, const Rendering& r) {
    const StoredImage& stored = stored_image(reference_image_named(r.image));
    const Rendered got = render(v.kernels(r.lanes, r.group_size), session, r);
    Verdict verdict = compare_images(stored.image, got.image);
    if (verdict.outcome == Outcome::kPass)
        verdict = check_counts(stored.counts.at(r.check_kind()), got.counts, verdict.result);
    if (verdict.outcome == Outcome::kPass && !got.fault.empty()) verdict = failed(got.fault, {});
    return with_options(verdict, got.options);
}

// Asks the driver for the binaries of a rendering's kernels, as programs that store kernels do. PoCL compiles all of
// them once more then, without knowing the size of a group; PoCL 6.0 aborts (docs/defects.md).
Verdict check_binaries(const Verification& v, Session& session, const Rendering& r) {
    KernelBuilds builds;
    session.observe(builds);
    render(v.kernels(r.lanes, r.group_size), session, r);
    session.ignore(builds);
    if (builds.all.empty()) throw std::logic_error("check_binaries: no build was recorded");
    for (const KernelBuild& build : builds.all) {
        const auto sizes = guarded("querying the binary of " + build.name,
                                   [&] { return build.program.getInfo<CL_PROGRAM_BINARY_SIZES>(); });
        if (sizes.empty() || sizes[0] == 0) return failed(build.name + " has no binary", {.options = build.options});
    }
    return passed(counted(builds.all.size(), "program"));
}

}  // namespace

std::map<std::string, std::string> counts_by_check_kind(Session& session, const ReferenceImage& image) {
    std::map<std::string, std::string> counts;
    std::vector<Rendering> all = standard_renderings();
    all.push_back({.image = image.name});  // so that every image has the counts of the ring
    for (const Rendering& r : all)
        if (r.image == image.name && !counts.contains(r.check_kind()))
            counts[r.check_kind()] = render({.lanes = 1, .group_size = 1}, session, r).counts;
    return counts;
}

void verify_images(Verification& v) {
    std::vector<Rendering> renderings = standard_renderings();
    if (v.full()) {
        const std::vector<Rendering> more = renderings_of_all_builds();
        renderings.insert(renderings.end(), more.begin(), more.end());
    }
    const auto has_given_lanes = [&](const Rendering& r) {
        return r.lanes == 0 || v.settings().lanes == 0 || r.lanes == v.settings().lanes;
    };
    for (const Rendering& r : renderings)
        if (v.settings().depth >= r.depth && has_given_lanes(r))
            v.check(
                "image", r.name(), [&](Session& session) { return check_rendering(v, session, r); }, r.group_size);
    if (!v.full()) return;
    for (const Rendering& r : {Rendering{.image = "glass fp32"}, Rendering{.image = "polygons fp32", .renderer = kGrid},
                               Rendering{.image = "polygons fp32", .renderer = kBvh},
                               Rendering{.image = "polygons fp32", .renderer = kTorus}})
        v.check("image", "binaries of " + r.name(), [&](Session& session) { return check_binaries(v, session, r); });
}

}  // namespace raya
