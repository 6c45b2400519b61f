// Static against dynamic distribution: what each strategy came to on one scene, and what that says of the claim.
#pragma once
#include <string>
#include <vector>

#include "host/study/strategies.hpp"

namespace raya {

/// All strategies on one scene, for each number of PEs.
struct SceneOutcomes {
    std::string label;
    std::vector<std::uint32_t> pes;    // ascending
    std::vector<Strategy> strategies;  // names and kinds; mappings are those of the last number of PEs
    std::vector<std::vector<StrategyOutcome>> outcomes;  // [strategy][number of PEs]
    std::vector<double> bound;                           // efficiency of the lower bound, of each number of PEs
};

SceneOutcomes outcomes_of(const std::string& label, const CostImage& image, const std::vector<std::uint32_t>& pes,
                          std::uint64_t overhead);

/// The first number of PEs at which an efficiency is below `limit`; 0: at none.
std::uint32_t first_below(const SceneOutcomes& scene, std::size_t strategy, double limit);

/// Heirich & Arvo's claim, on these scenes: static strategies are inadequate, static plus dynamic nearly optimal. Read
/// as: further than 10 % above the lower bound, and within that.
struct StaticVerdict {
    std::size_t cases = 0;              // scenes x numbers of PEs
    std::size_t static_inadequate = 0;  // in which no static strategy is within 10 % of the lower bound
    std::size_t hybrid_optimal = 0;     // in which a hybrid is, requests paid for
    std::size_t hybrid_beats = 0;       // in which a hybrid, requests paid for, is done before every static strategy
};
StaticVerdict verdict_of(const std::vector<SceneOutcomes>& scenes);

/// The sentences of the page, the chief one first.
std::vector<std::string> dynamic_findings(const std::vector<SceneOutcomes>& scenes, std::uint64_t overhead);

}  // namespace raya
