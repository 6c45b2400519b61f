#include "host/study/objects_findings.hpp"

#include "host/study/ensemble.hpp"

namespace raya {
namespace {

using Rows = ObjectsRows;
using Row = ObjectsRow;
using Ratio = ObjectsRatio;
using Ratios = ObjectsRatios;

constexpr double kNoticed = 1.02;  // times as long: slower
constexpr double kLinear = 1.1;    // objects over time, within which time grows as the objects do

std::string in_short(const Estimate& estimate) { return with_interval(estimate, 2); }

std::string text_of(const Ratios& some, Estimate Ratio::*time) {
    return joined(some, ", ",
                  [&](const Ratio& one) { return fmt::format("{} ({})", in_short(one.*time), one.objects); });
}

// Slower where the whole interval lies above 1; else not slower where it lies below what is noticed.
std::size_t slower(const Ratios& some, Estimate Ratio::*time) {
    return static_cast<std::size_t>(
        std::ranges::count_if(some, [&](const Ratio& one) { return (one.*time).low() > 1; }));
}
std::size_t not_slower(const Ratios& some, Estimate Ratio::*time) {
    return static_cast<std::size_t>(std::ranges::count_if(
        some, [&](const Ratio& one) { return (one.*time).low() <= 1 && (one.*time).high() < kNoticed; }));
}

// Reproduced where all numbers of objects are slower; not reproduced where none is, and half of them or more are not.
ClaimVerdict verdict_on(const Ratios& some, Estimate Ratio::*time) {
    const std::size_t are = slower(some, time);
    return verdict_of(are == some.size(), are == 0 && 2 * not_slower(some, time) >= some.size());
}

// By the machine without supersteps, as theirs is; its bounds stand beside it.
Claim claim_of_random(const Ratios& ratios) {
    const Ratios some = of(ratios, kRandom, kPaperProtocol);
    return {
        paper::kTp, "Fig. 4",
        "Random objects take longer than even ones, as those that straddle voxels are registered more than once.",
        verdict_on(some, &Ratio::asynchronous),
        fmt::format("Random over even, without supersteps: {}. Slower, by the 95 % interval, for {} of {} numbers of "
                    "objects; not slower, or by less than 2 %, for {}. Its bounds: overlapped {}; stepwise {}.",
                    text_of(some, &Ratio::asynchronous), slower(some, &Ratio::asynchronous), some.size(),
                    not_slower(some, &Ratio::asynchronous), text_of(some, &Ratio::overlapped),
                    text_of(some, &Ratio::stepwise))};
}

// Of both kinds; linear where one of them is.
Claim claim_of_growth(const GrowthRow& even, const GrowthRow& random) {
    const Estimate of_even = even.of(&Growth::sublinearity), of_random = random.of(&Growth::sublinearity);
    return {paper::kTp, "Fig. 4", "Time does not grow linearly with the objects.",
            verdict_of(std::min(of_even.low(), of_random.low()) > kLinear,
                       std::min(of_even.high(), of_random.high()) <= kLinear),
            fmt::format("{:.0f} times the objects take {:.2f} times the time, even; {} times, random.",
                        even.mean(&Growth::objects), even.mean(&Growth::time), in_short(random.of(&Growth::time)))};
}

double share_of_depth(const Growth& growth) { return growth.share(growth.depth); }

// The paper's reason is the right one where it explains more than half, of logarithms, in both kinds; it is not where
// it explains half or less in one.
Claim claim_of_depth(const GrowthRow& even, const GrowthRow& random) {
    constexpr double kHalf = 0.5;
    const Estimate of_even = even.of(share_of_depth), of_random = random.of(share_of_depth);
    return {
        paper::kTp, "Fig. 4", "That is since the share of rays that end in the front voxels differs.",
        verdict_of(std::min(of_even.low(), of_random.low()) > kHalf,
                   std::min(of_even.high(), of_random.high()) <= kHalf),
        fmt::format("Rays end earlier: fewer voxels a ray explain a factor of {:.2f} of {:.2f} even, {:.2f} of {:.2f} "
                    "random; that is {:.0f} % and {:.0f} % of it by logarithms.",
                    even.mean(&Growth::depth), even.of(&Growth::sublinearity).mean, random.mean(&Growth::depth),
                    random.of(&Growth::sublinearity).mean, 100 * of_even.mean, 100 * of_random.mean)};
}

std::string finding_of_random(const Ratios& ratios, const std::string& protocol) {
    const Ratios some = of(ratios, kRandom, protocol);
    return fmt::format(
        "Protocol of {}: random over even is {} without supersteps, {} overlapped, {} stepwise (objects in brackets).",
        protocol, text_of(some, &Ratio::asynchronous), text_of(some, &Ratio::overlapped),
        text_of(some, &Ratio::stepwise));
}

std::string finding_of_copies(const Rows& rows, const Ratios& ratios) {
    const Rows random = of(rows, kRandom, kOwnProtocol);
    const Row &first = random.front(), &last = random.back();
    return fmt::format(
        "Is it the copies? Random objects are registered {:.2f} times each where there are {} and {:.2f} times where "
        "there are {}. Moved until none lies astride, they take {} times as long as even ones where all nodes make "
        "primary rays: what remains is that voxels hold unequal numbers.",
        1 + first.copies() / first.objects, first.objects, 1 + last.copies() / last.objects, last.objects,
        text_of(of(ratios, kWithin, kOwnProtocol), &Ratio::overlapped));
}

std::string finding_of_growth(const GrowthRow& row) {
    return fmt::format(
        "Protocol of {}, {}: {:.0f} times the objects take {} times the time, {} times less than in proportion. As a "
        "product: {:.2f} as rays go through fewer voxels, {:.2f} as a voxel's tests grow less than the objects, {:.2f} "
        "for what does not depend on objects, {:.2f} for what one node or link holds up.",
        row.protocol, row.kind, row.mean(&Growth::objects), in_short(row.of(&Growth::time)),
        in_short(row.of(&Growth::sublinearity)), row.mean(&Growth::depth), row.mean(&Growth::lists),
        row.mean(&Growth::fixed), row.mean(&Growth::bound));
}

std::string finding_of_depth(const std::vector<PrimaryRow>& all) {
    const auto even = where(all, [](const PrimaryRow& row) { return row.kind == kEven; });
    const PrimaryRow &first = even.front(), &last = even.back();
    return fmt::format(
        "A primary ray in the box goes through {:.2f} voxels where there are {} even objects and through {:.2f} where "
        "there are {}, {:.2f} times fewer; {:.0f} % and {:.0f} % end in the first one.",
        first.steps(), first.objects, last.steps(), last.objects, first.steps() / last.steps(),
        100 * first.first_share(), 100 * last.first_share());
}

std::string finding_of_root(const Rows& rows, const std::string& protocol) {
    const Rows even = of(rows, kEven, protocol);
    const Rows bound = where(even, [](const Row& row) { return row.root_ms() >= row.overlapped_ms(); });
    if (bound.empty())
        return fmt::format("Protocol of {}: in no even scene does the machine wait for the root.", protocol);
    return fmt::format(
        "Protocol of {}: with {} even objects the machine waits for the root, {:.0f} to {:.0f} ms; there the time is "
        "that of making rays and taking in returns, not of the objects.",
        protocol, joined(bound, ", ", &Row::objects), least(bound, &Row::root_ms).root_ms(),
        std::ranges::max(each(bound, &Row::root_ms)));
}

std::string finding_of_returns(const Rows& rows) {
    const Rows even = of(rows, kEven, kPaperProtocol), terms = of(rows, kEven, kOwnProtocol);
    const TorusRun &theirs = even.front().runs.front(), &ours = terms.front().runs.front();
    return fmt::format(
        "{} primary rays bring home {} returns by the protocol of {} and {} where each term is one; there, all nodes "
        "together make {} primary rays that they throw away ({} even objects).",
        theirs.result.events[RAYA_PRIMARY], theirs.returns(), kPaperProtocol, ours.returns(), ours.discarded(),
        even.front().objects);
}

std::string finding_of_words(const ObjectsRuns& all) {
    const Rows even = of(all.rows, kEven, kPaperProtocol);
    return fmt::format("Larger ray packets than the {} words of Table 1, overlapped: {}.", paper::kRayWords,
                       joined(all.words, ", ", [&](const WordsRow& row) {
                           const Row& same = row.objects == even.front().objects ? even.front() : even.back();
                           return fmt::format("{} words take {:.2f} times as long ({} objects)", row.words,
                                              row.overlapped_ms / same.overlapped_ms(), row.objects);
                       }));
}

}  // namespace

std::vector<Claim> objects_claims(const ObjectsRatios& ratios, const std::vector<GrowthRow>& growth) {
    return {claim_of_random(ratios), claim_of_growth(growth[0], growth[1]), claim_of_depth(growth[0], growth[1])};
}

std::vector<std::string> objects_findings(const ObjectsRuns& all, const ObjectsRatios& ratios,
                                          const std::vector<GrowthRow>& growth) {
    std::vector<std::string> findings = {finding_of_random(ratios, kPaperProtocol),
                                         finding_of_root(all.rows, kPaperProtocol),
                                         finding_of_random(ratios, kOwnProtocol),
                                         finding_of_root(all.rows, kOwnProtocol), finding_of_copies(all.rows, ratios)};
    for (const GrowthRow& row : growth) findings.push_back(finding_of_growth(row));
    findings.insert(findings.end(),
                    {finding_of_depth(all.primary), finding_of_returns(all.rows), finding_of_words(all)});
    return findings;
}

}  // namespace raya
