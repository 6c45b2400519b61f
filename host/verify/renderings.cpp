#include "host/verify/renderings.hpp"

#include <fmt/format.h>

#include "host/model/number_format.hpp"
#include "host/torus/topology.hpp"

namespace raya {
namespace {

// Returns the mapping's name in names of checks.
std::string mapping_name(const MappingRule& mapping) {
    if (mapping == column_mapping()) return "column";
    return mapping.kind == RAYA_RANDOM ? "random" : mapping_text(mapping);
}

}  // namespace

std::string Rendering::check_kind() const {
    if (torus)
        return fmt::format("{} {}{}{}", links_name(links), sides_text(nodes), inject == Injection::kRoot ? " root" : "",
                           queue ? fmt::format(", queue {}", queue) : "");
    if (packets) return "packets";
    return accel == AccelKind::kNone ? "ring" : accel_text({.kind = accel});
}

std::string Rendering::name() const {
    std::string text = torus ? check_kind()
                             : fmt::format("{} on {}{}", mapping_name(mapping), pes,
                                           accel == AccelKind::kNone ? "" : ", " + check_kind());
    if (mapping.kind == RAYA_FOLD_BLOCK) text += ", block fold";
    if (work_per_launch) text += ", launches of " + counted(work_per_launch, torus ? "unit" : "test");
    if (pe_bytes) text += fmt::format(", PEs of {} bytes", pe_bytes);
    if (history) text += ", history";
    if (global_words) text += ", global words";
    if (fallback_code) text += ", fallback code";
    if (lanes) text += fmt::format(", {}x{}", lanes, group_size);
    if (!lanes && group_size) text += fmt::format(", groups of {}", group_size);
    return fmt::format("{}: {}", image, text);
}

std::vector<Rendering> standard_renderings() {
    constexpr auto k2d = Links::kTorus2d;
    constexpr auto kRoot = Injection::kRoot;
    return {
        {.image = "glass fp32", .min_depth = Depth::kBrief},
        {.image = "glass fp32 filter", .min_depth = Depth::kBrief, .mapping = cyclic_mapping(5), .pes = 10},
        {.image = "glass fp32 axes", .min_depth = Depth::kBrief, .mapping = rows_mapping(), .pes = 16},
        {.image = "glass fp32 diagonals",
         .min_depth = Depth::kQuick,
         .mapping = grid_mapping(4, 4),
         .pes = 16,
         .work_per_launch = 1},
        {.image = "glass fp32 filter",
         .min_depth = Depth::kQuick,
         .group_size = 8,
         .mapping = cyclic_mapping(8, Fold::kBlock),
         .pes = 7,
         .work_per_launch = 1,
         .pe_bytes = 3300},
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
        {.image = "far fp32", .min_depth = Depth::kQuick, .accel = AccelKind::kGrid},
        {.image = "polygons fp32", .min_depth = Depth::kQuick, .accel = AccelKind::kBvh},
        {.image = "leaves fp32", .min_depth = Depth::kQuick, .lanes = 4, .group_size = 1, .accel = AccelKind::kBvh},
        {.image = "leaves spa22", .min_depth = Depth::kQuick, .lanes = 1, .group_size = 1, .accel = AccelKind::kBvh},
        {.image = "polygons fp32",
         .min_depth = Depth::kQuick,
         .mapping = tiles_mapping(4, 4),
         .pes = 7,
         .accel = AccelKind::kBvh,
         .packets = true},
        {.image = "leaves fp32", .mapping = tiles_mapping(4, 4), .pes = 7, .accel = AccelKind::kBvh, .packets = true},
        {.image = "cones fp32",
         .mapping = tiles_mapping(20, 1),
         .pes = 7,
         .accel = AccelKind::kBvh,
         .packets = true,
         .fallback_code = true},
        {.image = "polygons fp32", .accel = AccelKind::kBvh, .global_words = true, .fallback_code = true},
        {.image = "cones fp32", .lanes = 8, .group_size = 1, .accel = AccelKind::kBvh, .fallback_code = true},
        {.image = "polygons fp32", .lanes = 4, .group_size = 1, .accel = AccelKind::kBvh, .fallback_code = true},
        {.image = "polygons fp32", .min_depth = Depth::kQuick, .torus = true},
        {.image = "polygons fp32", .min_depth = Depth::kQuick, .work_per_launch = 1, .torus = true},
        {.image = "far fp32",
         .min_depth = Depth::kQuick,
         .group_size = 64,
         .torus = true,
         .nodes = {3, 2, 2},
         .voxels = {4, 2, 2},
         .history = true,
         .fallback_code = true},
        {.image = "far fp32",
         .min_depth = Depth::kQuick,
         .group_size = 64,
         .torus = true,
         .nodes = {3, 2, 2},
         .voxels = {4, 2, 2},
         .queue = 40,
         .history = true,
         .fallback_code = true},
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
        {.image = "glass fp32", .torus = true, .nodes = {4, 4, 4}, .links = k2d},
        {.image = "glass fp32", .lanes = 1, .group_size = 1, .torus = true, .queue = 21}};
}

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
            all.push_back({.image = "polygons fp32",
                           .lanes = lanes,
                           .group_size = group,
                           .mapping = tiles_mapping(4, 4),
                           .pes = 7,
                           .accel = AccelKind::kBvh,
                           .packets = true});
            all.push_back({.image = "glass fp32 filter", .lanes = lanes, .group_size = group});
            all.push_back({.image = "mirrors spa22 axes", .lanes = lanes, .group_size = group});
        }
    return all;
}

}  // namespace raya
