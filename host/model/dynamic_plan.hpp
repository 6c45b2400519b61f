// How a machine hands out pixels while it runs.
#pragma once
#include <cmath>
#include <cstdint>

#include "host/model/image_size.hpp"

namespace raya {

inline constexpr std::uint32_t kLargestChunk = kLargestSide * kLargestSide;  // pixels: the largest image
inline constexpr std::uint64_t kLargestOverhead = 1'000'000'000;  // cycles; times the largest image below 2^58

struct DynamicPlan {
    std::uint32_t chunk = 1;     // pixels a request, 1..kLargestChunk
    std::uint64_t overhead = 0;  // cycles that a PE spends on a request, 0..kLargestOverhead
    double static_share = 0;     // 0..1 of each PE's own pixels that it starts with, unasked; above 0 it is a hybrid

    bool operator==(const DynamicPlan&) const = default;
};

/// Whether all its figures are in their ranges.
inline bool is_plan(const DynamicPlan& plan) {
    const bool is_share = !std::signbit(plan.static_share) && plan.static_share <= 1;  // no NaN, no -0
    return plan.chunk >= 1 && plan.chunk <= kLargestChunk && plan.overhead <= kLargestOverhead && is_share;
}

}  // namespace raya
