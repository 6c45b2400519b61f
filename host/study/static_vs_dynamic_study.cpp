// The study of static against dynamic distribution: its tables, plots and verdicts.
#include "host/scene/generate.hpp"
#include "host/study/ensemble.hpp"
#include "host/study/paper.hpp"
#include "host/study/prose.hpp"
#include "host/study/spa_clock.hpp"
#include "host/study/static_vs_dynamic.hpp"
#include "host/study/studies.hpp"

namespace raya {
namespace {

constexpr const char* kName = "static-vs-dynamic";
constexpr std::uint32_t kFewest = 128, kMost = 16'384;  // PEs; the claim speaks of 128 and more

// A strategy on one scene, or the bound of all.
struct Line {
    std::string strategy;
    std::vector<double> percent;  // efficiency on each number of PEs
};

Line line_of(const SceneOutcomes& scene, std::size_t s) {
    return {scene.strategies[s].name,
            each(scene.outcomes[s], [](const StrategyOutcome& o) { return 100 * o.efficiency; })};
}

Line bound_of(const SceneOutcomes& scene) {
    return {"most that is possible", each(scene.bound, [](double bound) { return 100 * bound; })};
}

StudyTable efficiency_table(const SceneOutcomes& scene, std::size_t number) {
    std::vector<Line> rows;
    for (std::size_t s = 0; s < scene.strategies.size(); ++s) rows.push_back(line_of(scene, s));
    rows.push_back(bound_of(scene));
    std::vector<Column<Line>> columns = {{"strategy", &Line::strategy}};
    for (std::size_t n = 0; n < scene.pes.size(); ++n)
        columns.push_back({std::to_string(scene.pes[n]), [n](const Line& row) { return row.percent[n]; }});
    return table_of(fmt::format("{}-{}", kName, number), "Efficiency (%) by P, " + scene.label, rows, columns);
}

// A strategy on one scene, on a number of PEs.
struct Case {
    const SceneOutcomes* scene;
    std::size_t strategy, number;

    const std::string& label() const { return scene->label; }
    const std::string& name() const { return scene->strategies[strategy].name; }
    std::uint32_t pes() const { return scene->pes[number]; }
    const StrategyOutcome& outcome() const { return scene->outcomes[strategy][number]; }
    Cell below(double limit) const {
        const std::uint32_t first = first_below(*scene, strategy, limit);
        return first > 0 ? Cell(first) : Cell("never");
    }
};

std::vector<StudyTable> tables_of(const std::vector<SceneOutcomes>& scenes) {
    std::vector<StudyTable> tables;
    std::vector<Case> cases;
    for (const SceneOutcomes& scene : scenes) {
        tables.push_back(efficiency_table(scene, tables.size() + 1));
        for (std::size_t s = 0; s < scene.strategies.size(); ++s)
            for (std::size_t n = 0; n < scene.pes.size(); ++n) cases.push_back({&scene, s, n});
    }
    tables.push_back(table_of(std::string(kName) + "-limits",
                              "The first P at which the efficiency is under 90 % and under 50 %",
                              where(cases, [](const Case& c) { return c.number == 0; }),
                              {{"scene", &Case::label},
                               {"strategy", &Case::name},
                               {"P, under 90 %", [](const Case& c) { return c.below(0.9); }},
                               {"P, under 50 %", [](const Case& c) { return c.below(0.5); }}}));
    tables.push_back(table_of(kName, "Every strategy, scene and number of PEs", cases,
                              {{"scene", &Case::label},
                               {"strategy", &Case::name},
                               {"P", &Case::pes},
                               {"makespan", [](const Case& c) { return c.outcome().makespan; }, "cycles"},
                               {"efficiency", [](const Case& c) { return c.outcome().efficiency; }},
                               {"makespan / lower bound", [](const Case& c) { return c.outcome().over_bound; }},
                               {"requests", [](const Case& c) { return c.outcome().requests; }}},
                              false));
    return tables;
}

// Static strategies alone, or those that ask, requests paid for, beside the lower bound.
StudyPlot efficiency_plot(const SceneOutcomes& scene, std::size_t number, bool fixed) {
    StudyPlot plot{fmt::format("{}-{}-{}", kName, number, fixed ? "static" : "dynamic"),
                   fmt::format("{}: {}", scene.label, fixed ? "static mappings" : "dynamic and hybrid distribution"),
                   "PEs", "efficiency (%)", Axes::kLogX};
    const auto add = [&](const Line& one) {
        plot.series.push_back({one.strategy, {scene.pes.begin(), scene.pes.end()}, one.percent});
    };
    for (std::size_t s = 0; s < scene.strategies.size(); ++s) {
        const Strategy& strategy = scene.strategies[s];
        if (fixed ? strategy.kind == StrategyKind::kStatic : strategy.pays()) add(line_of(scene, s));
    }
    add(bound_of(scene));
    return plot;
}

// What the verdict is by one factor of the clock: with a larger one a request costs fewer pixels.
struct AtFactor {
    double factor;
    std::uint64_t overhead;
    StaticVerdict verdict;
};

StudyTable table_of_factors(const std::vector<AtFactor>& factors) {
    return table_of(
        std::string(kName) + "-factors", "The verdicts by the clock's factor, cases of scene and P", factors,
        {{"factor", &AtFactor::factor},
         {"request", &AtFactor::overhead, "budget cycles"},
         {"cases", [](const AtFactor& row) { return row.verdict.cases; }},
         {"no static one near the bound", [](const AtFactor& row) { return row.verdict.static_inadequate; }},
         {"hybrid near the bound", [](const AtFactor& row) { return row.verdict.hybrid_optimal; }},
         {"hybrid beats all static ones", [](const AtFactor& row) { return row.verdict.hybrid_beats; }}});
}

std::vector<Claim> claims_of(const std::vector<AtFactor>& factors) {
    const auto in = [&](std::size_t StaticVerdict::*count) {
        return joined(factors, ", ", [&](const AtFactor& row) {
            return fmt::format("{} of {} by the factor {:.2f}", row.verdict.*count, row.verdict.cases, row.factor);
        });
    };
    const auto verdict = [&](std::size_t StaticVerdict::*count) {
        return verdict_of(
            std::ranges::all_of(factors, [&](const AtFactor& row) { return row.verdict.*count == row.verdict.cases; }),
            std::ranges::all_of(factors, [&](const AtFactor& row) { return row.verdict.*count == 0; }));
    };
    return {{paper::kDynamic, "conclusions", "Static strategies are inadequate on 128 computers or more.",
             verdict(&StaticVerdict::static_inadequate),
             fmt::format("No static one ends within 10 % of the lower bound in {}.",
                         in(&StaticVerdict::static_inadequate))},
            {paper::kDynamic, "conclusions", "Static plus dynamic distribution is nearly optimal.",
             verdict(&StaticVerdict::hybrid_optimal),
             fmt::format("A hybrid, requests paid for, ends within 10 % of it in {}.",
                         in(&StaticVerdict::hybrid_optimal))}};
}

}  // namespace

StudyPage study_static_vs_dynamic(Laboratory& lab, const Scenes& given) {
    const Scenes own = {
        embedded_scene("centre"), {"random-200", generate_random(200, 200)}, {"balls-3", generate_balls(3)}};
    const std::uint32_t size = lab.size(512);
    std::vector<std::uint32_t> pes;
    for (std::uint32_t p = kFewest; p <= std::min(kMost, size * size); p *= 2) pes.push_back(p);
    const auto outcomes_by = [&](std::uint64_t overhead) {
        return each(given.empty() ? own : given, [&](const LabelledScene& scene) {
            return outcomes_of(scene.label, lab.costs(scene, size).trace, pes, overhead);
        });
    };
    const auto overhead_of = [](double factor) { return round_trip_cycles(machine_named("spa"), factor); };
    const double factor = machine_factor().value;
    const std::uint64_t overhead = overhead_of(factor);
    const auto scenes = outcomes_by(overhead);
    std::vector<AtFactor> factors = {{factor, overhead, verdict_of(scenes)}};
    for (const double other : {kFactors.front(), kFactors.back()})
        factors.push_back({other, overhead_of(other), verdict_of(outcomes_by(overhead_of(other)))});
    std::ranges::sort(factors, {}, &AtFactor::factor);
    StudyPage page = page_about(kName, {{"size", size},
                                        {"pes", pes},
                                        {"factor", factor},
                                        {"request_cycles", overhead},
                                        {"random_seed", 1},
                                        {"scenes", each(scenes, &SceneOutcomes::label)}});
    page.clock = clock_text();
    page.claims = claims_of(factors);
    page.findings = dynamic_findings(scenes, overhead);
    page.tables = tables_of(scenes);
    page.tables.push_back(table_of_factors(factors));
    for (std::size_t i = 0; i < scenes.size(); ++i)
        for (const bool fixed : {true, false}) page.plots.push_back(efficiency_plot(scenes[i], i + 1, fixed));
    page.news = {sentence(kName, "news")};
    return page;
}

}  // namespace raya
