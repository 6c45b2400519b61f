// How far the best strategies end above the lower bound, in many pictures of one scene.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "host/ring/cost_image.hpp"
#include "host/study/statistics.hpp"

namespace raya {

/// Makespan / lower bound that counts as near it; ours, no paper names a figure.
inline constexpr double kNearBound = 1.1;

/// Of one scene on one number of PEs, over its pictures.
struct OverBound {
    std::string label;
    std::uint32_t pes = 0;
    Estimate fixed;   // of the best static strategy of each picture: makespan / lower bound
    Estimate hybrid;  // of the best hybrid, requests paid for
    Estimate saved;   // %: what that hybrid saves of that static strategy's time, in the same picture

    bool static_far() const { return fixed.low() > kNearBound; }
    bool static_near() const { return fixed.high() <= kNearBound; }
    bool hybrid_far() const { return hybrid.low() > kNearBound; }
    bool hybrid_near() const { return hybrid.high() <= kNearBound; }
    bool hybrid_beats() const { return saved.low() > 0; }
};

/// For each number of cycles that a request takes, above 0. `pictures`: one at least, square and of one size.
std::vector<OverBound> over_bound_of(const std::string& label, const std::vector<const CostImage*>& pictures,
                                     std::uint32_t pes, const std::vector<std::uint64_t>& overheads);

}  // namespace raya
