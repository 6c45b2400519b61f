#include "host/study/conclusion.hpp"

#include <fmt/core.h>

#include <algorithm>

namespace raya {
namespace {

std::string sentence_of(const Tally& tally, const std::string& whose) {
    const auto be = [](std::size_t count) { return count == 1 ? "is" : "are"; };
    const std::size_t seen = tally.count(ClaimVerdict::kReproduced),
                      not_seen = tally.count(ClaimVerdict::kNotReproduced);
    return fmt::format("Of {} claim{} {}, {} {} reproduced, {} {} not, and {} cannot be told.", tally.all(),
                       tally.all() == 1 ? "" : "s", whose, seen, be(seen), not_seen, be(not_seen),
                       tally.count(ClaimVerdict::kCannotTell));
}

}  // namespace

std::vector<Tally> tallies_of(std::span<const StudyPage> pages) {
    std::vector<Tally> tallies;
    for (const StudyPage& page : pages)
        for (const Claim& claim : page.claims) {
            auto at = std::ranges::find(tallies, claim.paper, &Tally::paper);
            if (at == tallies.end()) at = tallies.insert(at, {claim.paper});
            ++at->counts[static_cast<std::size_t>(claim.verdict)];
        }
    return tallies;
}

std::vector<std::string> verdict_sentences(std::span<const StudyPage> pages) {
    const std::vector<Tally> tallies = tallies_of(pages);
    if (tallies.empty()) return {"No claim of a paper is judged here."};
    if (tallies.size() == 1) return {sentence_of(tallies[0], "of " + tallies[0].paper)};
    Tally sum;
    for (const Tally& tally : tallies)
        for (std::size_t i = 0; i < sum.counts.size(); ++i) sum.counts[i] += tally.counts[i];
    std::vector<std::string> sentences = {sentence_of(sum, fmt::format("of {} papers", tallies.size()))};
    for (const Tally& tally : tallies) sentences.push_back(sentence_of(tally, "of " + tally.paper));
    return sentences;
}

std::vector<std::string> claims_with(std::span<const StudyPage> pages, ClaimVerdict verdict) {
    std::vector<std::string> sentences;
    for (const StudyPage& page : pages)
        for (const Claim& claim : page.claims)
            if (claim.verdict == verdict)
                sentences.push_back(fmt::format("{}, {}: \"{}\" {}", claim.paper, claim.place, claim.words, claim.why));
    return sentences;
}

}  // namespace raya
