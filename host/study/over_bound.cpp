#include "host/study/over_bound.hpp"

#include <algorithm>
#include <limits>

#include "host/study/strategies.hpp"

namespace raya {
namespace {

template <class Wanted>
double best_of(const CostImage& image, const std::vector<Strategy>& all, Wanted wanted) {
    double best = std::numeric_limits<double>::max();
    for (const Strategy& strategy : all)
        if (wanted(strategy)) best = std::min(best, run_strategy(image, strategy).over_bound);
    return best;
}

}  // namespace

std::vector<OverBound> over_bound_of(const std::string& label, const std::vector<const CostImage*>& pictures,
                                     std::uint32_t pes, const std::vector<std::uint64_t>& overheads) {
    const std::uint32_t size = pictures.front()->width;
    std::vector<double> fixed;
    for (const CostImage* picture : pictures)
        fixed.push_back(best_of(*picture, strategies(size, pes, 0),
                                [](const Strategy& s) { return s.kind == StrategyKind::kStatic; }));
    std::vector<OverBound> all;
    for (const std::uint64_t overhead : overheads) {
        const std::vector<Strategy> by_overhead = strategies(size, pes, overhead);
        std::vector<double> hybrid, saved;
        for (std::size_t i = 0; i < pictures.size(); ++i) {
            hybrid.push_back(best_of(*pictures[i], by_overhead,
                                     [](const Strategy& s) { return s.kind == StrategyKind::kHybrid && s.pays(); }));
            saved.push_back(100 * (1 - hybrid[i] / fixed[i]));
        }
        all.push_back({label, pes, estimate_of(fixed), estimate_of(hybrid), estimate_of(saved)});
    }
    return all;
}

}  // namespace raya
