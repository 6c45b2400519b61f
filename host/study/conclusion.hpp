// What the pages come to together, told from their verdicts and first findings.
#pragma once
#include <array>
#include <span>
#include <string>
#include <vector>

#include "host/study/page.hpp"

namespace raya {

/// How many claims have each verdict, by ClaimVerdict.
struct Tally {
    std::string paper;
    std::array<std::size_t, 3> counts{};
    std::size_t count(ClaimVerdict verdict) const { return counts[static_cast<std::size_t>(verdict)]; }
    std::size_t all() const { return counts[0] + counts[1] + counts[2]; }
};

/// One for each paper, in the order in which the pages name them.
std::vector<Tally> tallies_of(std::span<const StudyPage> pages);

/// A sentence on all claims, and where there are several papers one on each.
std::vector<std::string> verdict_sentences(std::span<const StudyPage> pages);

/// A sentence for each claim with that verdict: paper, place, what it says, why.
std::vector<std::string> claims_with(std::span<const StudyPage> pages, ClaimVerdict verdict);

}  // namespace raya
