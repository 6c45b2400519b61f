#include "host/study/static_vs_dynamic.hpp"

#include <fmt/format.h>

#include "host/scene/generate.hpp"
#include "host/study/laboratory.hpp"
#include "host/study/studies.hpp"

namespace raya {
namespace {

constexpr const char* kName = "static-vs-dynamic";
constexpr std::uint32_t kFewest = 128, kMost = 16'384;  // PEs; the claim speaks of 128 and more

std::vector<LabelledScene> scenes_or_default(const std::vector<LabelledScene>& scenes) {
    if (!scenes.empty()) return scenes;
    return {embedded_scene("centre"), {"random-200", generate_random(200, 200)}, {"balls-3", generate_balls(3)}};
}

Cell pes_or_never(std::uint32_t pes) {
    if (pes > 0) return std::int64_t{pes};
    return std::string("never");
}

StudyTable efficiency_table(const SceneOutcomes& scene, std::size_t number) {
    StudyTable table{
        fmt::format("{}-{}", kName, number), "Efficiency (%) by P, " + scene.label, {"strategy"}, {}, true};
    for (const std::uint32_t pes : scene.pes) table.columns.push_back(std::to_string(pes));
    for (std::size_t s = 0; s < scene.strategies.size(); ++s) {
        table.rows.emplace_back().emplace_back(scene.strategies[s].name);
        for (const Outcome& outcome : scene.outcomes[s]) table.rows.back().emplace_back(100 * outcome.efficiency);
    }
    table.rows.emplace_back().emplace_back(std::string("most that is possible"));
    for (const double bound : scene.bound) table.rows.back().emplace_back(100 * bound);
    return table;
}

StudyTable thresholds_table(const std::vector<SceneOutcomes>& scenes) {
    StudyTable table{std::string(kName) + "-limits",
                     "The first P at which the efficiency is under 90 % and under 50 %",
                     {"scene", "strategy", "P, under 90 %", "P, under 50 %"},
                     {},
                     true};
    for (const SceneOutcomes& scene : scenes)
        for (std::size_t s = 0; s < scene.strategies.size(); ++s)
            table.rows.push_back({scene.label, scene.strategies[s].name, pes_or_never(first_below(scene, s, 0.9)),
                                  pes_or_never(first_below(scene, s, 0.5))});
    return table;
}

StudyTable long_table(const std::vector<SceneOutcomes>& scenes) {
    StudyTable table{
        kName,
        "Every strategy, scene and number of PEs",
        {"scene", "strategy", "P", "makespan (cycles)", "efficiency", "makespan / lower bound", "requests"},
        {},
        false};
    for (const SceneOutcomes& scene : scenes)
        for (std::size_t s = 0; s < scene.strategies.size(); ++s)
            for (std::size_t n = 0; n < scene.pes.size(); ++n) {
                const Outcome& o = scene.outcomes[s][n];
                table.rows.push_back({scene.label, scene.strategies[s].name, std::int64_t{scene.pes[n]},
                                      static_cast<std::int64_t>(o.makespan), o.efficiency, o.over_bound,
                                      static_cast<std::int64_t>(o.requests)});
            }
    return table;
}

PlotSeries series_of(const SceneOutcomes& scene, std::size_t s) {
    PlotSeries series{scene.strategies[s].name, {}, {}, PlotStyle::kLine};
    for (std::size_t n = 0; n < scene.pes.size(); ++n) {
        series.x.push_back(scene.pes[n]);
        series.y.push_back(100 * scene.outcomes[s][n].efficiency);
    }
    return series;
}

// Static strategies alone, or those that ask, requests paid for, beside the lower bound.
StudyPlot efficiency_plot(const SceneOutcomes& scene, std::size_t number, bool fixed) {
    StudyPlot plot{fmt::format("{}-{}-{}", kName, number, fixed ? "static" : "dynamic"),
                   fmt::format("{}: {}", scene.label, fixed ? "static mappings" : "dynamic and hybrid distribution"),
                   "PEs",
                   "efficiency (%)",
                   true,
                   false,
                   {}};
    for (std::size_t s = 0; s < scene.strategies.size(); ++s)
        if ((scene.strategies[s].kind == StrategyKind::kStatic) == fixed &&
            (fixed || scene.strategies[s].plan.overhead > 0))
            plot.series.push_back(series_of(scene, s));
    PlotSeries bound{"most that is possible", {}, {}, PlotStyle::kLine};
    for (std::size_t n = 0; n < scene.pes.size(); ++n) {
        bound.x.push_back(scene.pes[n]);
        bound.y.push_back(100 * scene.bound[n]);
    }
    plot.series.push_back(bound);
    return plot;
}

std::vector<std::string> method_of(std::uint32_t size, std::uint64_t overhead) {
    return {
        fmt::format("Images of {} x {} on 128 and more PEs of the SPA; efficiency = the pixels' modelled cycles / (P x "
                    "the time at which the last PE has finished).",
                    size, size),
        "Static: column split, cyclic mapping with p = 16 and p = sqrt(P), blocks of contiguous scan lines, tiles of "
        "8 x 8 pixels in turn, the grid nearest to a square (every A-th line, every B-th pixel), random.",
        "dynamic:C: a PE that is free takes the next C pixels. hybrid:C: each PE first does a share of its own pixels "
        "(of "
        "the grid, row by row from the top) and then takes C at a time of what is left. Both are simulated exactly on "
        "the cost image.",
        fmt::format(
            "A request costs its PE {} cycles: one word to the root and two back at 6 Mword/s, each way with "
            "the synchronisation that a rotation has. The SPA never did this, so that is our assumption; \"free "
            "requests\" shows the rest without it. Requests do not wait for each other.",
            overhead),
        "Nothing can end sooner than the larger of the mean load and the largest pixel: the lower bound."};
}

}  // namespace

SceneOutcomes outcomes_of(const std::string& label, const CostImage& image, const std::vector<std::uint32_t>& pes,
                          std::uint64_t overhead) {
    SceneOutcomes scene{label, pes, {}, {}, {}};
    for (const std::uint32_t p : pes) {
        scene.strategies = strategies(image.width, p, overhead);
        scene.outcomes.resize(scene.strategies.size());
        for (std::size_t s = 0; s < scene.strategies.size(); ++s)
            scene.outcomes[s].push_back(run_strategy(image, p, scene.strategies[s]));
        const std::uint64_t bound = lower_bound(image, p);
        scene.bound.push_back(bound > 0 ? static_cast<double>(total_cycles(image)) /
                                              (static_cast<double>(p) * static_cast<double>(bound))
                                        : 1);
    }
    return scene;
}

StudyPage study_static_vs_dynamic(Laboratory& lab, const std::vector<LabelledScene>& given) {
    const std::uint32_t size = lab.size(512);
    const std::uint64_t overhead = round_trip_cycles(machine_named("spa"));
    std::vector<std::uint32_t> pes;
    for (std::uint32_t p = kFewest; p <= std::min(kMost, size * size); p *= 2) pes.push_back(p);
    std::vector<SceneOutcomes> scenes;
    for (const LabelledScene& scene : scenes_or_default(given))
        scenes.push_back(outcomes_of(scene.label, lab.costs(scene, size).trace, pes, overhead));

    StudyPage page;
    page.name = kName;
    page.title = "Static against dynamic distribution";
    page.question =
        "Are static strategies inadequate from 128 PEs on, and static plus dynamic ones nearly optimal, as "
        "Heirich and Arvo (1998) found?";
    page.method = method_of(size, overhead);
    for (std::size_t i = 0; i < scenes.size(); ++i) page.tables.push_back(efficiency_table(scenes[i], i + 1));
    page.tables.push_back(thresholds_table(scenes));
    page.tables.push_back(long_table(scenes));
    for (std::size_t i = 0; i < scenes.size(); ++i)
        for (const bool fixed : {true, false}) page.plots.push_back(efficiency_plot(scenes[i], i + 1, fixed));
    page.findings = dynamic_findings(scenes, overhead);
    page.settings = {{"size", size}, {"pes", pes}, {"request_cycles", overhead}, {"random_seed", 1}};
    for (const SceneOutcomes& scene : scenes) page.settings["scenes"].push_back(scene.label);
    return page;
}

}  // namespace raya
