// Checks of layer "image": renders the reference images with settings that must not change any bit of the image.
#include <fmt/core.h>

#include <bit>
#include <numeric>
#include <optional>

#include "host/ring/mapping.hpp"
#include "host/ring/ring_renderer.hpp"
#include "host/torus/torus_renderer.hpp"
#include "host/verify/reference_images.hpp"
#include "host/verify/verify.hpp"

namespace raya {
namespace {

// Returns the mapping's name in names of checks.
std::string mapping_name(const MappingRule& mapping) {
    if (mapping == column_mapping()) return "column";
    return mapping.kind == RAYA_RANDOM ? "random" : mapping_text(mapping);
}

// A reference image and the settings that must not change any bit of it.
struct Rendering {
    std::string image;
    Depth min_depth = Depth::kFull;           // verify() includes the rendering at this and greater depths
    std::uint32_t lanes = 0, group_size = 0;  // 0: the device's default
    MappingRule mapping = cyclic_mapping(8);  // mapping of pixels to PEs of the ring
    std::uint32_t pes = kReferenceSide;
    std::uint32_t work_per_launch = 0;  // see RingSettings and TorusSettings; 0: default
    AccelKind accel = AccelKind::kNone;
    bool torus = false;
    std::array<std::uint32_t, 3> nodes = {2, 2, 2};
    Links links = Links::kTorus3d;
    Injection inject = Injection::kAll;
    LinkMove link_move = LinkMove::kCopies;
    bool global_words = false;   // job words are in global memory, as if local memory were too small
    bool fallback_code = false;  // as if the device did not round division, square root and fma correctly, and the
                                 // compiler had none of the builtins that raya uses

    // Returns the name of the renderer with its accelerator or torus, such as "ring", "bvh" or "torus2d 3x2x2 root". It
    // is the key in StoredImage::counts: renderings of an image by the same renderer have equal counts.
    std::string check_kind() const {
        if (torus)
            return fmt::format("{} {}{}", links_name(links), sides_text(nodes),
                               inject == Injection::kRoot ? " root" : "");
        return accel == AccelKind::kNone ? "ring" : accel_text({.kind = accel});
    }

    std::string name() const {
        std::string text = torus ? check_kind()
                                 : fmt::format("{} on {}{}", mapping_name(mapping), pes,
                                               accel == AccelKind::kNone ? "" : ", " + check_kind());
        if (mapping.kind == RAYA_FOLD_BLOCK) text += ", block fold";
        if (work_per_launch) text += fmt::format(", launches of {} {}", work_per_launch, torus ? "units" : "tests");
        if (link_move == LinkMove::kKernel) text += ", links by a kernel";
        if (global_words) text += ", global words";
        if (fallback_code) text += ", fallback code";
        if (lanes) text += fmt::format(", {}x{}", lanes, group_size);
        if (!lanes && group_size) text += fmt::format(", groups of {}", group_size);
        return fmt::format("{}: {}", image, text);
    }
};

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
};

std::uint64_t sum(std::span<const std::uint64_t> numbers) {
    return std::accumulate(numbers.begin(), numbers.end(), std::uint64_t{0});
}

Rendered render_on_ring(const KernelChoice& kernels, Session& session, const Rendering& r) {
    const ReferenceImage& image = reference_image_named(r.image);
    RingSettings settings = reference_settings(image);
    settings.mapping = make_mapping(r.mapping, {kReferenceSide, kReferenceSide}, r.pes);
    settings.accel.kind = r.accel;
    settings.work_per_launch = r.work_per_launch;
    settings.kernels = kernels_for(kernels, r);
    settings.record_costs = true;
    RingResult result = RingRenderer(session, scene_of(image), settings).render();
    const std::string counts = counts_text(
        result.all.events, {{"cycles", sum(result.all.load.per_pe)}, {"pixel_cycles", sum(result.cost().cycles)}});
    return {std::move(result.image), result.build_options, counts};
}

Rendered render_on_torus(const KernelChoice& kernels, Session& session, const Rendering& r) {
    const ReferenceImage& image = reference_image_named(r.image);
    TorusSettings s;
    s.machine = machine_named("torus");
    s.width = s.height = kReferenceSide;
    s.torus = make_torus(r.nodes, r.links);
    s.links = r.links;
    s.voxels = {r.nodes[0] + 1, r.nodes[1] + 2, r.nodes[2]};  // more voxels than nodes, so that some nodes have several
    s.inject = r.inject;
    s.packets.one_return_per_ray = r.inject == Injection::kRoot;  // so that the checks cover both values
    s.bounces = kReferenceBounces;
    s.format = parse_format(image.format);
    s.sampling = image.sampling;
    s.work_per_launch = r.work_per_launch;
    s.kernels = kernels_for(kernels, r);
    s.kernels.link_move = r.link_move;
    TorusResult result = TorusRenderer(session, scene_of(image), s).render();
    const std::string counts = counts_text(
        result.events, {{"cycles", sum(result.load.per_pe)}, {"packets", sum(result.made)}, {"hops", result.hops}});
    return {std::move(result.image), result.build_options, counts};
}

Rendered render(const KernelChoice& kernels, Session& session, const Rendering& r) {
    return r.torus ? render_on_torus(kernels, session, r) : render_on_ring(kernels, session, r);
}

// Renders the image with reference_settings() and without compiler optimisation. Returns nullopt if that fails.
std::optional<Image> unoptimised_image(const Verification& v, Session& session, const ReferenceImage& image) {
    RingSettings settings = reference_settings(image);
    settings.kernels.sources = v.kernels(1, 1).sources;
    settings.kernels.sources.more_options = {"-cl-opt-disable"};
    try {
        return RingRenderer(session, scene_of(image), settings).render().image;
    } catch (const std::exception&) {
        return {};
    }
}

// Returns remedies for a wrong image. The remedies depend on whether unoptimised_image() is correct on this device.
std::vector<std::string> image_remedies(const Verification& v, Session& session, const ReferenceImage& image) {
    const std::optional<Image> unoptimised = unoptimised_image(v, session, image);
    if (unoptimised && pixel_hash(*unoptimised) == stored_image(image).hash)
        return {
            "with one lane, groups of one and -cl-opt-disable the image is right: render with\n"
            "RAYA_BUILD_OPTIONS=-cl-opt-disable --lanes 1 --group 1, and report the error to the driver's vendor",
            "a newer driver"};
    return {"if checks of \"number\" or \"geometry\" fail too, start with those",
            "the image is also wrong with one lane and -cl-opt-disable: try another driver, or another OpenCL\n"
            "implementation for this device (raya devices)"};
}

Verdict check_rendering(const Verification& v, Session& session, const Rendering& r) {
    if (r.group_size > v.device().max_group_size)
        return skipped(fmt::format("needs groups of {} work-items, the device allows {}", r.group_size,
                                   v.device().max_group_size));
    const ReferenceImage& image = reference_image_named(r.image);
    const StoredImage& stored = stored_image(image);
    const Rendered got = render(v.kernels(r.lanes, r.group_size), session, r);
    const Verdict pixels = compare_images(stored.image, got.image);
    if (pixels.outcome == Outcome::kPass)
        return check_counts(stored.counts.at(r.check_kind()), got.counts, pixels.result, got.options);
    return with_remedies(pixels, got.options, image_remedies(v, session, image));
}

// Returns renderings that together use every kernel and option. Building kernels takes most of a rendering's time, so
// renderings with equal build options are adjacent and use the same build. For the same reason some renderings of depth
// kQuick combine several features, such as global words and fallback code. The renderings of depth kBrief need three
// builds: one for each machine and one for a reduced format.
std::vector<Rendering> standard_renderings() {
    constexpr auto k2d = Links::kTorus2d;
    constexpr auto kRoot = Injection::kRoot;
    return {{.image = "glass fp32", .min_depth = Depth::kBrief},
            {.image = "glass fp32 filter", .min_depth = Depth::kBrief, .mapping = cyclic_mapping(5), .pes = 10},
            {.image = "glass fp32 axes", .min_depth = Depth::kBrief, .mapping = rows_mapping(), .pes = 16},
            {.image = "glass fp32 diagonals", .min_depth = Depth::kQuick, .mapping = grid_mapping(4, 4), .pes = 16},
            {.image = "glass fp32",
             .min_depth = Depth::kQuick,
             .mapping = cyclic_mapping(8, Fold::kBlock),
             .pes = 7,
             .work_per_launch = 40},
            {.image = "glass fp32", .min_depth = Depth::kQuick, .mapping = tiles_mapping(5, 4), .pes = 7},
            {.image = "glass fp32", .global_words = true},
            {.image = "glass fp32", .fallback_code = true},
            {.image = "glass fp32", .lanes = 1, .group_size = 1, .pes = 1},
            {.image = "glass fp32", .lanes = 4, .group_size = 32, .mapping = random_mapping(1), .pes = 5},
            {.image = "ties fp32",
             .min_depth = Depth::kQuick,
             .mapping = blocks_mapping(),
             .pes = 5,
             .global_words = true,
             .fallback_code = true},
            {.image = "ties fp32"},
            {.image = "ties fp32", .accel = AccelKind::kGrid},
            {.image = "ties fp32", .accel = AccelKind::kBvh},
            {.image = "ties fp32", .torus = true},
            {.image = "polygons fp32", .mapping = tiles_mapping(5, 4), .pes = 7},
            {.image = "polygons fp32", .min_depth = Depth::kQuick, .accel = AccelKind::kGrid},
            {.image = "polygons fp32", .accel = AccelKind::kGrid, .global_words = true, .fallback_code = true},
            {.image = "polygons fp32", .min_depth = Depth::kQuick, .accel = AccelKind::kBvh},
            {.image = "polygons fp32", .accel = AccelKind::kBvh, .global_words = true, .fallback_code = true},
            {.image = "cones fp32", .lanes = 8, .group_size = 1, .accel = AccelKind::kBvh, .fallback_code = true},
            {.image = "polygons fp32", .lanes = 4, .group_size = 1, .accel = AccelKind::kBvh, .fallback_code = true},
            {.image = "cones fp32", .min_depth = Depth::kQuick, .accel = AccelKind::kBvh},
            {.image = "polygons fp32", .min_depth = Depth::kQuick, .torus = true},
            {.image = "polygons fp32",
             .min_depth = Depth::kQuick,
             .work_per_launch = 3,
             .torus = true,
             .link_move = LinkMove::kKernel},
            {.image = "polygons fp32", .min_depth = Depth::kQuick, .group_size = 32, .torus = true},
            {.image = "polygons fp32", .torus = true, .global_words = true},
            {.image = "polygons fp32",
             .min_depth = Depth::kBrief,
             .torus = true,
             .nodes = {3, 2, 2},
             .links = k2d,
             .inject = kRoot},
            {.image = "cones fp32", .mapping = blocks_mapping(), .pes = 5, .global_words = true},
            {.image = "mirrors spa22", .min_depth = Depth::kBrief, .mapping = column_mapping(), .pes = kReferenceSide},
            {.image = "mirrors spa22 filter",
             .min_depth = Depth::kQuick,
             .mapping = cyclic_mapping(16),
             .pes = kReferenceSide},
            {.image = "cones e5m10", .min_depth = Depth::kQuick, .fallback_code = true},
            {.image = "mirrors spa22", .fallback_code = true},
            {.image = "polygons spa22", .torus = true, .fallback_code = true},
            {.image = "mirrors spa22 axes", .mapping = cyclic_mapping(3), .pes = 100},
            {.image = "planes fp32 corners", .accel = AccelKind::kGrid},
            {.image = "spheres e8m12t", .min_depth = Depth::kQuick},
            {.image = "glass e8m21"},
            {.image = "mirrors spa22", .torus = true, .links = k2d},
            {.image = "polygons spa22", .accel = AccelKind::kGrid},
            {.image = "polygons spa22", .min_depth = Depth::kQuick, .accel = AccelKind::kBvh},
            {.image = "spheres e8m12t", .accel = AccelKind::kBvh},
            {.image = "polygons spa22", .torus = true, .nodes = {1, 3, 2}, .inject = kRoot},
            {.image = "glass fp32", .torus = true, .nodes = {4, 4, 4}, .links = k2d}};
}

// Returns renderings with every number of lanes and groups of 1 and 32 work-items, on both machines, in fp32 and
// reduced formats.
std::vector<Rendering> renderings_of_all_builds() {
    std::vector<Rendering> all;
    for (const std::uint32_t lanes : {1u, 4u, 8u, 16u})
        for (const std::uint32_t group : {1u, 32u}) {
            for (const char* image : {"glass fp32", "polygons fp32", "mirrors spa22", "cones e5m10", "spheres e8m12t"})
                all.push_back({.image = image, .lanes = lanes, .group_size = group});
            for (const char* image : {"polygons fp32", "polygons spa22"}) {
                all.push_back({.image = image, .lanes = lanes, .group_size = group, .accel = AccelKind::kGrid});
                all.push_back({.image = image, .lanes = lanes, .group_size = group, .accel = AccelKind::kBvh});
                all.push_back({.image = image, .lanes = lanes, .group_size = group, .torus = true});
            }
            all.push_back({.image = "glass fp32 filter", .lanes = lanes, .group_size = group});
            all.push_back({.image = "mirrors spa22 axes", .lanes = lanes, .group_size = group});
        }
    return all;
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
        return r.lanes == 0 || v.given_lanes() == 0 || r.lanes == v.given_lanes();
    };
    for (const Rendering& r : renderings)
        if (v.depth() >= r.min_depth && has_given_lanes(r))
            v.check("image", r.name(), [&](Session& session) { return check_rendering(v, session, r); });
}

}  // namespace raya
