// The best offset for the user's scene: balance against communication, for each number of PEs and anti-aliasing.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "host/ring/schedule.hpp"
#include "host/study/laboratory.hpp"
#include "host/study/offset_times.hpp"
#include "host/study/studies.hpp"

namespace raya {
namespace {

constexpr const char* kName = "best-offset";
constexpr std::array kMethods = {AntialiasMethod::kNone, AntialiasMethod::kFilter, AntialiasMethod::kSupersample};

// One number of PEs and one way of anti-aliasing.
struct Choice {
    std::uint32_t pes = 0, root = 0;  // root: round(sqrt(P)) modulo W, the paper's best
    AntialiasMethod method = AntialiasMethod::kNone;
    std::vector<OffsetTime> times;
    std::vector<double> imbalance;          // u of the first pass
    std::uint32_t best = 0, best_near = 0;  // of all offsets, of 0..root

    double total(std::uint32_t p) const { return times[p].total_ms(); }
    double loss(std::uint32_t p) const { return total(best) > 0 ? 100 * (total(p) / total(best) - 1) : 0; }  // %
};

struct SceneChoices {
    std::string label;
    std::uint32_t size = 0;
    std::string format;
    std::vector<Choice> choices;  // numbers of PEs in order, the methods for each
};

Choice choice_of(const Costs& costs, std::uint32_t pes, AntialiasMethod method) {
    const std::uint32_t size = costs.trace.width;
    Choice choice{.pes = pes, .method = method, .times = offset_times(costs, pes, method), .imbalance = {}};
    choice.root = static_cast<std::uint32_t>(std::lround(std::sqrt(pes))) % size;
    std::vector<std::uint32_t> offsets(size);
    for (std::uint32_t p = 0; p < size; ++p) offsets[p] = p;
    choice.imbalance = imbalance_of_offsets(costs.trace, pes, RAYA_FOLD_CYCLIC, offsets);
    choice.best = best_offset_of(choice.times, choice.times.size());
    choice.best_near = best_offset_of(choice.times, choice.root + 1);
    return choice;
}

SceneChoices choices_of(Laboratory& lab, const LabelledScene& scene) {
    SceneChoices all{scene.label, lab.size(usual_size(scene.scene)), format_name(format_for(scene.scene)), {}};
    const Costs& costs = lab.costs(scene, all.size, AntialiasMethod::kSupersample);
    std::vector<std::uint32_t> pes = {all.size};
    for (const std::uint32_t more : {256u, 64u})
        if (more != all.size && more <= all.size * all.size) pes.push_back(more);
    for (const std::uint32_t p : pes)
        for (const AntialiasMethod method : kMethods) all.choices.push_back(choice_of(costs, p, method));
    return all;
}

std::string without_or_with(AntialiasMethod method) {
    return method == AntialiasMethod::kNone ? "without anti-aliasing" : "with --antialias " + antialias_name(method);
}

// The array with as many PEs as columns comes first: its three choices answer the question.
std::string chief_finding(const SceneChoices& scene) {
    std::string text;
    for (const Choice& choice : scene.choices) {
        if (choice.pes != scene.choices.front().pes) break;
        text +=
            fmt::format("{}--offset {} {}", text.empty() ? "Use " : ", ", choice.best, without_or_with(choice.method));
    }
    return fmt::format("{}: {} at {} x {} pixels on {} PEs.", text, scene.label, scene.size, scene.size,
                       scene.choices.front().pes);
}

std::string choice_finding(const SceneChoices& scene, const Choice& c) {
    const OffsetTime& t = c.times[c.best];
    std::string near = c.best_near == c.best ? fmt::format("no offset beyond sqrt(P) = {} is better", c.root)
                                             : fmt::format("the best of 0..sqrt(P) is p = {}, {:.1f} % slower",
                                                           c.best_near, c.loss(c.best_near));
    const std::string root =
        c.root == c.best ? "" : fmt::format("p = {} takes {:.1f} % longer, ", c.root, c.loss(c.root));
    return fmt::format(
        "{}, {} PEs, {}: p = {} takes {:.1f} ms, {:.1f} % of it on the ring, u of the first pass {:.3f}; {}; {}p = 0 "
        "takes {:.1f} % longer.",
        scene.label, c.pes, without_or_with(c.method), c.best, t.total_ms(),
        t.total_ms() > 0 ? 100 * t.ring_ms / t.total_ms() : 0, c.imbalance[c.best], near, root, c.loss(0));
}

std::vector<std::string> findings_of(const std::vector<SceneChoices>& scenes) {
    std::vector<std::string> findings;
    for (const SceneChoices& scene : scenes) findings.push_back(chief_finding(scene));
    for (const SceneChoices& scene : scenes)
        for (const Choice& choice : scene.choices) findings.push_back(choice_finding(scene, choice));
    return findings;
}

StudyTable best_table(const std::vector<SceneChoices>& scenes) {
    StudyTable table{
        kName,
        "Best offsets, modelled, nothing fitted",
        {"scene", "size", "PEs", "anti-aliasing", "best p", "time (ms)", "of it ring (ms)", "u, first pass",
         "best p of 0..sqrt(P)", "its time (ms)", "its u", "p = sqrt(P) (ms)", "p = 0 (ms)"},
        {},
        true};
    for (const SceneChoices& scene : scenes)
        for (const Choice& c : scene.choices)
            table.rows.push_back({scene.label, std::int64_t{scene.size}, std::int64_t{c.pes}, antialias_name(c.method),
                                  std::int64_t{c.best}, c.total(c.best), c.times[c.best].ring_ms, c.imbalance[c.best],
                                  std::int64_t{c.best_near}, c.total(c.best_near), c.imbalance[c.best_near],
                                  c.total(c.root), c.total(0)});
    return table;
}

StudyTable long_table(const std::vector<SceneChoices>& scenes) {
    StudyTable table{std::string(kName) + "-all",
                     "Every offset",
                     {"scene", "PEs", "anti-aliasing", "p", "u, first pass", "first pass (ms)",
                      "neighbours' arithmetic (ms)", "supersampling (ms)", "rotations", "ring (ms)", "total (ms)"},
                     {},
                     false};
    for (const SceneChoices& scene : scenes)
        for (const Choice& c : scene.choices)
            for (std::size_t p = 0; p < c.times.size(); ++p) {
                const OffsetTime& t = c.times[p];
                table.rows.push_back({scene.label, std::int64_t{c.pes}, antialias_name(c.method),
                                      static_cast<std::int64_t>(p), c.imbalance[p], t.trace_ms, t.smooth_ms,
                                      t.supersample_ms, static_cast<std::int64_t>(t.rotations), t.ring_ms,
                                      t.total_ms()});
            }
    return table;
}

// A plot for each number of PEs, a line for each way of anti-aliasing, its best offset marked.
std::vector<StudyPlot> plots_of(const SceneChoices& scene, std::size_t number) {
    std::vector<StudyPlot> plots;
    for (const Choice& c : scene.choices) {
        const std::string name = fmt::format("{}-{}-{}pes", kName, number, c.pes);
        if (plots.empty() || plots.back().name != name)
            plots.push_back({name,
                             fmt::format("{} at {} x {} on {} PEs", scene.label, scene.size, scene.size, c.pes),
                             "offset p (pixels)",
                             "computing and rotations (modelled ms)",
                             false,
                             true,
                             {}});
        PlotSeries line{c.method == AntialiasMethod::kNone ? "no anti-aliasing" : antialias_name(c.method),
                        {},
                        {},
                        PlotStyle::kLine};
        for (std::size_t p = 0; p < c.times.size(); ++p) {
            line.x.push_back(static_cast<double>(p));
            line.y.push_back(c.times[p].total_ms());
        }
        plots.back().series.push_back(line);
        plots.back().series.push_back({fmt::format("its best: p = {}", c.best),
                                       {static_cast<double>(c.best)},
                                       {c.total(c.best)},
                                       PlotStyle::kPoints});
    }
    return plots;
}

std::vector<Comparison> comparisons_of(const SceneChoices& scene) {
    std::vector<Comparison> comparisons;
    for (const Choice& c : scene.choices)
        comparisons.push_back({fmt::format("best p, {} PEs, {}", c.pes, antialias_name(c.method)),
                               "",
                               {},
                               static_cast<double>(c.best),
                               fmt::format("u of the first pass {:.3f}; the paper's rule, sqrt(P), is p = {}",
                                           c.imbalance[c.best], c.root)});
    return comparisons;
}

}  // namespace

StudyPage study_best_offset(Laboratory& lab, const std::vector<LabelledScene>& given) {
    std::vector<SceneChoices> scenes;
    for (const LabelledScene& scene : given.empty() ? std::vector{embedded_scene("centre")} : given)
        scenes.push_back(choices_of(lab, scene));
    StudyPage page;
    page.name = kName;
    page.title = "The best offset for a scene";
    page.question = "Which offset of the cyclic mapping makes this image soonest, communication in the balance?";
    page.method = {
        "For every offset: the busiest PE's modelled cycles in the first pass and in supersampling, the arithmetic "
        "between neighbours, and the rotations that bring the neighbours by the shortest route, on the SPA's rates. No "
        "factor is fitted. Broadcast and image transfer take the same for every offset and are left out.",
        "A PE for each column, 256 PEs and 64; fold cyclic; sqrt(P) is rounded. PEs have memory for the shares that go "
        "round, which the SPA's have only for small ones.",
        "A scene is rendered at its own size, if that is square, and smaller where its objects would make that take "
        "minutes; --size overrides. Of equal offsets the smallest is named."};
    page.comparisons = comparisons_of(scenes.front());
    page.tables = {best_table(scenes), long_table(scenes)};
    for (std::size_t i = 0; i < scenes.size(); ++i)
        for (StudyPlot& plot : plots_of(scenes[i], i + 1)) page.plots.push_back(std::move(plot));
    page.findings = findings_of(scenes);
    for (const SceneChoices& scene : scenes)
        page.settings["scenes"].push_back(
            {{"scene", scene.label}, {"size", scene.size}, {"format", scene.format}, {"fold", "cyclic"}});
    return page;
}

}  // namespace raya
