// Image sizes, mapping rules and dynamic distributions. A mapping rule, an image size and a number of PEs together
// determine a mapping of pixels to PEs (kernels/shared/mapping.h).
#pragma once
#include <cmath>
#include <cstdint>
#include <optional>

#include "kernels/shared/mapping.h"

namespace raya {

inline constexpr std::uint32_t kMaxSide = 16384;  // maximum width or height of an image, pixels

struct ImageSize {
    std::uint32_t width = 0, height = 0;  // pixels

    std::uint64_t pixels() const { return std::uint64_t{width} * height; }
    bool operator==(const ImageSize&) const = default;
};

/// Assignment of slots to PEs if the number of slots differs from the number of PEs (kernels/shared/mapping.h).
enum class Fold : std::uint32_t { kCyclic = RAYA_FOLD_CYCLIC, kBlock = RAYA_FOLD_BLOCK };

/// A mapping rule, created by one of the functions below.
struct MappingRule {
    /// RAYA_ROWS, RAYA_BLOCKS, RAYA_GRID, RAYA_TILES or RAYA_RANDOM; for a mapping with slots, its fold
    /// (RAYA_FOLD_CYCLIC or RAYA_FOLD_BLOCK).
    std::uint32_t kind = RAYA_FOLD_CYCLIC;
    std::uint32_t parameter = 0;  // argument of the function: offset, seed or raya_pair(); 0 if it has none

    bool has_slots() const { return kind <= RAYA_FOLD_BLOCK; }
    /// Returns the number of PEs that a grid_mapping() requires; empty for other rules, which map to any number of PEs.
    std::optional<std::uint32_t> pes() const {
        if (kind != RAYA_GRID) return {};
        return raya_first_of(parameter) * raya_second_of(parameter);
    }
    bool operator==(const MappingRule&) const = default;
};

/// Kohata & Ito's cyclic mapping: each row is shifted by `offset` slots relative to the row above.
inline MappingRule cyclic_mapping(std::uint32_t offset, Fold fold = Fold::kCyclic) {
    return {static_cast<std::uint32_t>(fold), offset};
}
/// Kohata & Ito's column split: the cyclic mapping with offset 0.
inline MappingRule column_mapping(Fold fold = Fold::kCyclic) { return cyclic_mapping(0, fold); }
/// Scan lines are assigned to the PEs cyclically.
inline MappingRule rows_mapping() { return {RAYA_ROWS, 0}; }
/// Each PE has a contiguous block of scan lines.
inline MappingRule blocks_mapping() { return {RAYA_BLOCKS, 0}; }
/// The array has `down` rows of `across` PEs. Each PE has every `across`-th pixel of every `down`-th scan line. `down`
/// and `across` must be less than 2^16.
inline MappingRule grid_mapping(std::uint32_t down, std::uint32_t across) {
    return {RAYA_GRID, raya_pair(down, across)};
}
/// Tiles of `width` x `height` pixels are assigned to the PEs cyclically. `width` and `height` must be less than 2^16.
inline MappingRule tiles_mapping(std::uint32_t width, std::uint32_t height) {
    return {RAYA_TILES, raya_pair(width, height)};
}
/// Pixels are assigned to the PEs at random; the numbers of pixels of any two PEs differ by at most one.
inline MappingRule random_mapping(std::uint32_t seed) { return {RAYA_RANDOM, seed}; }

inline constexpr std::uint32_t kMaxChunk = kMaxSide * kMaxSide;  // pixels of the largest image
inline constexpr std::uint64_t kMaxOverhead = 1'000'000'000;     // cycles; kMaxChunk requests take < 2^58

/// A dynamic distribution: PEs request pixels at run time.
struct DynamicPlan {
    std::uint32_t chunk = 1;     // number of pixels per request, 1..kMaxChunk
    std::uint64_t overhead = 0;  // cycles that a request costs the PE, 0..kMaxOverhead
    /// Fraction, 0..1, of a PE's pixels under the static mapping that it renders before its first request.
    double static_fraction = 0;
    /// Cycles for which a request occupies the root, 0..kMaxOverhead. The root answers one request at a time.
    std::uint64_t root_cycles = 0;

    bool operator==(const DynamicPlan&) const = default;
};

/// Returns true if all members of `plan` are in their ranges.
inline bool is_valid_plan(const DynamicPlan& plan) {
    const bool is_fraction = !std::signbit(plan.static_fraction) && plan.static_fraction <= 1;  // no NaN, no -0
    return plan.chunk >= 1 && plan.chunk <= kMaxChunk && plan.overhead <= kMaxOverhead &&
           plan.root_cycles <= kMaxOverhead && is_fraction;
}

}  // namespace raya
