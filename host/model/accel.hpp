// What decides which objects a ray is tested against inside a PE: never which one it hits.
#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <string>

#include "kernels/shared/accel.h"

namespace raya {

using Divisions = std::array<std::uint32_t, 3>;  // voxels along x, y, z

enum class AccelKind : std::uint32_t {
    kNone = RAYA_ACCEL_NONE,  // every ray is tested against all objects
    kGrid = RAYA_ACCEL_GRID,  // voxels (grid.hpp)
    kBvh = RAYA_ACCEL_BVH,    // a tree of boxes (tree_words.hpp)
};

/// How rays find their nearest hit.
struct Accel {
    AccelKind kind = AccelKind::kNone;
    std::optional<Divisions> divisions{};  // of a grid over the whole scene's box; empty: see accel_partition
};

/// What `--accel` takes: "none", "grid", "grid:4x4x4", "bvh".
std::string accel_text(const Accel& accel);

/// What was made of it, for reports.
struct AccelSummary {
    AccelKind kind = AccelKind::kNone;
    std::uint64_t words = 0;   // of the job that hold it
    Divisions divisions{};     // of a grid
    std::uint64_t copies = 0;  // entries of a grid's lists beyond each object's first
    std::uint32_t apart = 0;   // finite objects in no list and no leaf, which every ray is tested against
    std::uint64_t nodes = 0;   // of a tree
    std::uint64_t leaves = 0;
    std::uint32_t depth = 0;  // nodes on a tree's longest way down
};

}  // namespace raya
