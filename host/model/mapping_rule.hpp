// Image sizes, and mapping rules: mappings of pixels to PEs that do not depend on the size of the image yet
// (kernels/shared/mapping.h defines mappings).
#pragma once
#include <cmath>
#include <cstdint>
#include <optional>

#include "kernels/shared/mapping.h"

namespace raya {

inline constexpr std::uint32_t kLargestSide = 16384;  // pixels

struct ImageSize {
    std::uint32_t width = 0, height = 0;  // pixels

    std::uint64_t pixels() const { return std::uint64_t{width} * height; }
    bool operator==(const ImageSize&) const = default;
};

/// The assignment of slots to PEs if their numbers differ.
enum class Fold : std::uint32_t { kCyclic = RAYA_FOLD_CYCLIC, kBlock = RAYA_FOLD_BLOCK };

/// Create it by the functions below.
struct MappingRule {
    std::uint32_t kind = RAYA_FOLD_CYCLIC;  // as in raya_mapping
    std::uint32_t parameter = 0;            // as in raya_mapping

    bool has_slots() const { return kind <= RAYA_FOLD_BLOCK; }
    /// The number of PEs of a grid; empty for mappings to any number of PEs.
    std::optional<std::uint32_t> pes() const {
        if (kind != RAYA_GRID) return {};
        return raya_first_of(parameter) * raya_second_of(parameter);
    }
    bool operator==(const MappingRule&) const = default;
};

/// Each row is shifted by `offset` slots relative to the row above.
inline MappingRule cyclic_mapping(std::uint32_t offset, Fold fold = Fold::kCyclic) {
    return {static_cast<std::uint32_t>(fold), offset};
}
/// Offset 0: Kohata & Ito's column split.
inline MappingRule column_mapping(Fold fold = Fold::kCyclic) { return cyclic_mapping(0, fold); }
/// Scan lines dealt cyclically; contiguous blocks of scan lines.
inline MappingRule rows_mapping() { return {RAYA_ROWS, 0}; }
inline MappingRule blocks_mapping() { return {RAYA_BLOCKS, 0}; }
/// `down` rows of `across` PEs: every `down`-th line, every `across`-th pixel of it. Both below 2^16.
inline MappingRule grid_mapping(std::uint32_t down, std::uint32_t across) {
    return {RAYA_GRID, raya_pair(down, across)};
}
/// Tiles of `width` x `height` pixels dealt cyclically. Both below 2^16.
inline MappingRule tiles_mapping(std::uint32_t width, std::uint32_t height) {
    return {RAYA_TILES, raya_pair(width, height)};
}
/// Random pixels, with equal shares.
inline MappingRule random_mapping(std::uint32_t seed) { return {RAYA_RANDOM, seed}; }

inline constexpr std::uint32_t kLargestChunk = kLargestSide * kLargestSide;  // pixels: the largest image
inline constexpr std::uint64_t kLargestOverhead = 1'000'000'000;  // cycles; times the largest image's pixels: < 2^58

/// A dynamic distribution: PEs request pixels at run time.
struct DynamicPlan {
    std::uint32_t chunk = 1;     // pixels per request, 1..kLargestChunk
    std::uint64_t overhead = 0;  // cycles of a PE per request, 0..kLargestOverhead
    double static_share = 0;     // share of its own pixels that a PE renders first, 0..1; hybrid if above 0

    bool operator==(const DynamicPlan&) const = default;
};

/// Returns true if all members are in their ranges.
inline bool is_plan(const DynamicPlan& plan) {
    const bool is_share = !std::signbit(plan.static_share) && plan.static_share <= 1;  // no NaN, no -0
    return plan.chunk >= 1 && plan.chunk <= kLargestChunk && plan.overhead <= kLargestOverhead && is_share;
}

}  // namespace raya
