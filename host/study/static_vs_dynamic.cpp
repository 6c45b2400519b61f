#include "host/study/static_vs_dynamic.hpp"

#include <fmt/format.h>

#include "host/study/laboratory.hpp"
#include "host/study/rows.hpp"
#include "host/study/spa_clock.hpp"

namespace raya {
namespace {

constexpr std::size_t kColumns = 0, kCyclic16 = 1, kCyclicRoot = 2;  // among strategies()

constexpr double kNear = 1.1;  // of the lower bound: ours, the claim names no figure

// The strategy of that kind with the least makespan; of those that ask, only such as pay for requests, where any does.
std::size_t best_of(const SceneOutcomes& scene, StrategyKind kind, std::size_t n) {
    std::size_t best = scene.strategies.size();
    const bool any_pays = std::any_of(scene.strategies.begin(), scene.strategies.end(), std::mem_fn(&Strategy::pays));
    for (std::size_t s = 0; s < scene.strategies.size(); ++s) {
        const Strategy& strategy = scene.strategies[s];
        if (strategy.kind != kind || (kind != StrategyKind::kStatic && any_pays && !strategy.pays())) continue;
        if (best == scene.strategies.size() || scene.outcomes[s][n].makespan < scene.outcomes[best][n].makespan)
            best = s;
    }
    return best;
}

const StrategyOutcome& best_outcome(const SceneOutcomes& scene, StrategyKind kind, std::size_t n) {
    return scene.outcomes[best_of(scene, kind, n)][n];
}

// The first number of PEs at which the best of a kind is less efficient than `limit`; 0: at none.
std::uint32_t kind_below(const SceneOutcomes& scene, StrategyKind kind, double limit) {
    for (std::size_t n = 0; n < scene.pes.size(); ++n)
        if (best_outcome(scene, kind, n).efficiency < limit) return scene.pes[n];
    return 0;
}

std::string from_words(std::uint32_t pes) { return pes > 0 ? fmt::format("from P = {}", pes) : "at no P"; }

std::string static_finding(const SceneOutcomes& scene) {
    const std::size_t end = scene.pes.size() - 1;
    const std::size_t first = best_of(scene, StrategyKind::kStatic, 0),
                      last = best_of(scene, StrategyKind::kStatic, end);
    const auto limits_of = [&](std::size_t s) {
        return fmt::format("{} and {}", from_words(first_below(scene, s, 0.9)), from_words(first_below(scene, s, 0.5)));
    };
    return fmt::format(
        "{}, static: at P = {} {} is best, {:.0f} % efficient, at P = {} {}, {:.0f} % (of {:.0f} % possible). The best "
        "of them falls under 90 % {} and under 50 % {}; the column split {}, cyclic with p = sqrt(P) {}.",
        scene.label, scene.pes.front(), scene.strategies[first].name, 100 * scene.outcomes[first].front().efficiency,
        scene.pes.back(), scene.strategies[last].name, 100 * scene.outcomes[last].back().efficiency,
        100 * scene.bound.back(), from_words(kind_below(scene, StrategyKind::kStatic, 0.9)),
        from_words(kind_below(scene, StrategyKind::kStatic, 0.5)), limits_of(kColumns), limits_of(kCyclicRoot));
}

std::string hybrid_finding(const SceneOutcomes& scene) {
    double paid = 1, free = 1;
    std::size_t near = 0;  // numbers of PEs, from the first on, at which the best is near the bound
    for (std::size_t n = 0; n < scene.pes.size(); ++n) {
        const double over = best_outcome(scene, StrategyKind::kHybrid, n).over_bound;
        if (near == n && over <= kNear) ++near;
        paid = std::max(paid, over);
        double best = 0;
        for (std::size_t s = 0; s < scene.strategies.size(); ++s)
            if (scene.strategies[s].kind == StrategyKind::kHybrid && !scene.strategies[s].pays())
                best = best == 0 ? scene.outcomes[s][n].over_bound : std::min(best, scene.outcomes[s][n].over_bound);
        free = std::max(free, best);
    }
    return fmt::format(
        "{}, static plus dynamic: {}within 10 % of the lower bound {}; at worst the best of them ends {:.2f} times the "
        "lower bound with requests paid for, {:.2f} times with free ones.",
        scene.label, near == 0 ? "not " : "",
        near == 0                  ? fmt::format("at P = {}", scene.pes.front())
        : near == scene.pes.size() ? "for every P"
                                   : fmt::format("up to P = {}", scene.pes[near - 1]),
        paid, free);
}

std::string claim_finding(const StaticVerdict& v, std::uint32_t first_pes) {
    const char* verdict = v.static_inadequate == v.cases ? "holds"
                          : v.static_inadequate == 0     ? "does not hold"
                                                         : "holds in part";
    return fmt::format(
        "That static strategies are inadequate from {} PEs on {} here: in {} of {} cases (scene and P) no static one "
        "ends within 10 % of the lower bound. Static plus dynamic, requests paid for, does in {} of them and beats "
        "every static strategy in {}.",
        first_pes, verdict, v.static_inadequate, v.cases, v.hybrid_optimal, v.hybrid_beats);
}

// What the model leaves out: a root that answers one request at a time.
std::string queue_of(const SceneOutcomes& scene, std::uint64_t overhead) {
    std::vector<std::string> words;
    for (std::size_t s = 0; s < scene.strategies.size(); ++s) {
        if (!scene.strategies[s].pays()) continue;
        const auto late =
            std::ranges::find_if(scene.outcomes[s],
                                 [&](const StrategyOutcome& o) { return o.requests * overhead > o.makespan; }) -
            scene.outcomes[s].begin();
        const auto n = static_cast<std::size_t>(late);
        words.push_back(scene.strategies[s].name + " " + from_words(n < scene.pes.size() ? scene.pes[n] : 0));
    }
    return fmt::format("{} ({})", scene.label, fmt::join(words, ", "));
}

std::string queue_finding(const std::vector<SceneOutcomes>& scenes, std::uint64_t overhead) {
    return fmt::format(
        "A request takes {} budget cycles ({:.2f} ms). If the root answered them one at a time, as one bus would make "
        "it, they alone would take longer than the run that is shown: {}.",
        overhead, machine_factor().value * spa_ms(static_cast<double>(overhead)),
        joined(scenes, "; ", [&](const SceneOutcomes& scene) { return queue_of(scene, overhead); }));
}

// Where the cyclic mapping falls back to single columns: p and the turns in which P / W PEs share a slot's rows meet.
// The same for all scenes, as it follows from the mapping.
std::string collapse_finding(const SceneOutcomes& scene) {
    std::string text;
    for (const std::size_t s : {kCyclic16, kCyclicRoot})
        for (std::size_t n = 0; n < scene.pes.size(); ++n)
            if (scene.outcomes[s][n].single_columns)
                text += fmt::format("{}{} at P = {}", text.empty() ? "" : "; ", scene.strategies[s].name, scene.pes[n]);
    if (text.empty()) return {};
    return fmt::format(
        "No better than the column split can be: {}. Each PE's pixels lie in one column there, as the offset comes "
        "round within the rows after which a slot's PEs do.",
        text);
}

}  // namespace

std::uint32_t first_below(const SceneOutcomes& scene, std::size_t strategy, double limit) {
    for (std::size_t n = 0; n < scene.pes.size(); ++n)
        if (scene.outcomes[strategy][n].efficiency < limit) return scene.pes[n];
    return 0;
}

StaticVerdict verdict_of(const std::vector<SceneOutcomes>& scenes) {
    StaticVerdict v;
    for (const SceneOutcomes& scene : scenes)
        for (std::size_t n = 0; n < scene.pes.size(); ++n) {
            const StrategyOutcome &fixed = best_outcome(scene, StrategyKind::kStatic, n),
                                  &hybrid = best_outcome(scene, StrategyKind::kHybrid, n);
            v.cases += 1;
            v.static_inadequate += fixed.over_bound > kNear;
            v.hybrid_optimal += hybrid.over_bound <= kNear;
            v.hybrid_beats += hybrid.makespan < fixed.makespan;
        }
    return v;
}

std::vector<std::string> dynamic_findings(const std::vector<SceneOutcomes>& scenes, std::uint64_t overhead) {
    std::vector<std::string> findings = {claim_finding(verdict_of(scenes), scenes.front().pes.front())};
    for (const SceneOutcomes& scene : scenes) {
        findings.push_back(static_finding(scene));
        findings.push_back(hybrid_finding(scene));
    }
    if (std::string collapse = collapse_finding(scenes.front()); !collapse.empty())
        findings.push_back(std::move(collapse));
    findings.push_back(queue_finding(scenes, overhead));
    return findings;
}

SceneOutcomes outcomes_of(const std::string& label, const CostImage& image, const std::vector<std::uint32_t>& pes,
                          std::uint64_t overhead) {
    SceneOutcomes scene{label, pes, {}, {}, {}};
    for (const std::uint32_t p : pes) {
        scene.strategies = strategies(image.width, p, overhead);
        scene.outcomes.resize(scene.strategies.size());
        for (std::size_t s = 0; s < scene.strategies.size(); ++s)
            scene.outcomes[s].push_back(run_strategy(image, scene.strategies[s]));
        const std::uint64_t bound = lower_bound(image, p);
        scene.bound.push_back(bound > 0 ? static_cast<double>(total_cycles(image)) /
                                              (static_cast<double>(p) * static_cast<double>(bound))
                                        : 1);
    }
    return scene;
}

}  // namespace raya
