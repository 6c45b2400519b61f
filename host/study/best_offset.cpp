// The best offset for the user's scene: balance against communication, for each number of PEs and anti-aliasing.
#include <span>

#include "host/study/arrays.hpp"
#include "host/study/prose.hpp"
#include "host/study/rows.hpp"
#include "host/study/spa_times.hpp"
#include "host/study/studies.hpp"

namespace raya {
namespace {

constexpr const char* kName = "best-offset";

// One scene, one number of PEs and one way of anti-aliasing.
struct Choice {
    std::string scene, format;
    std::uint32_t size = 0, pes = 0, root = 0;  // root: round(sqrt(P)) modulo W, the paper's best
    AntialiasMethod method = AntialiasMethod::kNone;
    std::vector<OffsetTime> times = {};
    OffsetTime best = {}, best_near = {};             // of all offsets, of 0..root
    std::vector<std::uint32_t> best_of_factors = {};  // the best offsets for factors of 1 to 8, each once

    std::string factors() const {
        return joined(best_of_factors, ", ", [](std::uint32_t p) { return p; });
    }
    std::string antialias() const { return antialias_name(method); }
    std::string method_text() const {
        return method == AntialiasMethod::kNone ? "without anti-aliasing" : "with --antialias " + antialias();
    }
    double loss(const OffsetTime& time) const {  // %
        return best.total_ms() > 0 ? 100 * (time.total_ms() / best.total_ms() - 1) : 0;
    }
};

// Of one scene: numbers of PEs in order, the methods for each. The array with as many PEs as columns comes first.
using Choices = std::vector<Choice>;

// The best offset, were computing so many times as dear.
const OffsetTime& best_by(const std::vector<OffsetTime>& times, double dearer) {
    return least(times,
                 [=](const OffsetTime& time) { return time.ring_ms + dearer * (time.total_ms() - time.ring_ms); });
}

Choices choices_of(Laboratory& lab, const LabelledScene& scene) {
    const std::uint32_t size = lab.size(usual_size(scene.scene));
    const Costs& costs = lab.costs(scene, size, AntialiasMethod::kSupersample);
    Choices all;
    for (const std::uint32_t pes : {size, 256u, 64u}) {
        if (!all.empty() && (pes == size || pes > size * size)) continue;
        for (const AntialiasMethod method :
             {AntialiasMethod::kNone, AntialiasMethod::kFilter, AntialiasMethod::kSupersample}) {
            Choice choice{scene.label,
                          format_name(format_for(scene.scene)),
                          size,
                          pes,
                          root_offset(pes) % size,
                          method,
                          offset_times(costs, pes, method, machine_factor().value)};
            choice.best = least(choice.times, &OffsetTime::total_ms);
            choice.best_of_factors = distinct(
                kFactors, [&](double factor) { return best_by(choice.times, factor / machine_factor().value).offset; });
            choice.best_near = least(std::span(choice.times).first(choice.root + 1), &OffsetTime::total_ms);
            all.push_back(std::move(choice));
        }
    }
    return all;
}

std::string chief_finding(const Choices& scene) {
    const Choice& first = scene.front();
    const Choices answer = where(scene, [&](const Choice& choice) { return choice.pes == first.pes; });
    return fmt::format(
        "Use {}: {} at {} x {} pixels on {} PEs.",
        joined(answer, ", ",
               [](const Choice& c) { return fmt::format("--offset {} {}", c.best.offset, c.method_text()); }),
        first.scene, first.size, first.size, first.pes);
}

std::string choice_finding(const Choice& c) {
    const std::string near =
        c.best_near.offset == c.best.offset
            ? fmt::format("no offset beyond sqrt(P) = {} is better", c.root)
            : fmt::format("the best of 0..sqrt(P) is p = {}, {:.1f} % slower", c.best_near.offset, c.loss(c.best_near));
    const std::string root =
        c.root == c.best.offset ? "" : fmt::format("p = {} takes {:.1f} % longer, ", c.root, c.loss(c.times[c.root]));
    const double total = c.best.total_ms();
    return fmt::format(
        "{}, {} PEs, {}: p = {} takes {:.1f} ms, {:.1f} % of it on the ring, u of the first pass {:.3f}; {}; {}p = 0 "
        "takes {:.1f} % longer; the best for factors of 1 to 8: p = {}.",
        c.scene, c.pes, c.method_text(), c.best.offset, total, total > 0 ? 100 * c.best.ring_ms / total : 0,
        c.best.imbalance, near, root, c.loss(c.times[0]), c.factors());
}

// Every offset of a choice.
struct Tried {
    const Choice* choice;
    const OffsetTime* time;
};

std::vector<StudyTable> tables_of(const Choices& choices) {
    std::vector<Tried> all;
    for (const Choice& choice : choices)
        for (const OffsetTime& time : choice.times) all.push_back({&choice, &time});
    const auto of = [](auto figure) { return [=](const Tried& tried) { return std::invoke(figure, *tried.time); }; };
    const auto best = [](auto figure) { return [=](const Choice& c) { return std::invoke(figure, c.best); }; };
    const auto near = [](auto figure) { return [=](const Choice& c) { return std::invoke(figure, c.best_near); }; };
    return {table_of(kName, "Best offsets, modelled", choices,
                     {{"scene", &Choice::scene},
                      {"size", &Choice::size},
                      {"PEs", &Choice::pes},
                      {"anti-aliasing", &Choice::antialias},
                      {"best p", best(&OffsetTime::offset)},
                      {"best p, factors 1 to 8", &Choice::factors},
                      {"time", best(&OffsetTime::total_ms), "ms"},
                      {"of it ring", best(&OffsetTime::ring_ms), "ms"},
                      {"u, first pass", best(&OffsetTime::imbalance)},
                      {"best p of 0..sqrt(P)", near(&OffsetTime::offset)},
                      {"its time", near(&OffsetTime::total_ms), "ms"},
                      {"its u", near(&OffsetTime::imbalance)},
                      {"p = sqrt(P)", [](const Choice& c) { return c.times[c.root].total_ms(); }, "ms"},
                      {"p = 0", [](const Choice& c) { return c.times[0].total_ms(); }, "ms"}}),
            table_of(std::string(kName) + "-all", "Every offset", all,
                     {{"scene", [](const Tried& tried) { return tried.choice->scene; }},
                      {"PEs", [](const Tried& tried) { return tried.choice->pes; }},
                      {"anti-aliasing", [](const Tried& tried) { return tried.choice->antialias(); }},
                      {"p", of(&OffsetTime::offset)},
                      {"u, first pass", of(&OffsetTime::imbalance)},
                      {"first pass", of(&OffsetTime::trace_ms), "ms"},
                      {"neighbours' arithmetic", of(&OffsetTime::smooth_ms), "ms"},
                      {"supersampling", of(&OffsetTime::supersample_ms), "ms"},
                      {"rotations", of(&OffsetTime::rotations)},
                      {"ring", of(&OffsetTime::ring_ms), "ms"},
                      {"total", of(&OffsetTime::total_ms), "ms"}},
                     false)};
}

// A plot for each number of PEs, a line for each way of anti-aliasing, its best offset marked.
void add_plots(std::vector<StudyPlot>& plots, const Choices& scene, std::size_t number) {
    for (const Choice& c : scene) {
        const std::string name = fmt::format("{}-{}-{}pes", kName, number, c.pes);
        if (plots.empty() || plots.back().name != name)
            plots.push_back({name, fmt::format("{} at {} x {} on {} PEs", c.scene, c.size, c.size, c.pes),
                             "offset p (pixels)", "computing and rotations (modelled ms)", Axes::kLogY});
        plots.back().series.push_back(line(c.method == AntialiasMethod::kNone ? "no anti-aliasing" : c.antialias(),
                                           c.times, &OffsetTime::offset, &OffsetTime::total_ms));
        plots.back().series.push_back(line(fmt::format("its best: p = {}", c.best.offset), std::span(&c.best, 1),
                                           &OffsetTime::offset, &OffsetTime::total_ms, PlotStyle::kPoints));
    }
}

}  // namespace

StudyPage study_best_offset(Laboratory& lab, const Scenes& given) {
    const auto scenes = each(given.empty() ? Scenes{embedded_scene("centre")} : given,
                             [&](const LabelledScene& scene) { return choices_of(lab, scene); });
    Choices all;
    for (const Choices& scene : scenes) all.insert(all.end(), scene.begin(), scene.end());
    Json settings;
    for (const Choices& scene : scenes)
        settings["scenes"].push_back(
            {{"scene", scene[0].scene}, {"size", scene[0].size}, {"format", scene[0].format}, {"fold", "cyclic"}});
    settings["factor"] = machine_factor().value;
    StudyPage page = page_about(kName, settings);
    page.clock = clock_text();
    page.news = {sentence(kName, "news")};
    for (const Choice& c : scenes.front())
        page.comparisons.push_back(
            {fmt::format("best p, {} PEs, {}", c.pes, c.antialias()), "", std::nullopt, double(c.best.offset),
             fmt::format("u of the first pass {:.3f}; sqrt(P), Kohata & Ito's, is p = {}", c.best.imbalance, c.root)});
    for (const Choices& scene : scenes) page.findings.push_back(chief_finding(scene));
    for (const Choice& choice : all) page.findings.push_back(choice_finding(choice));
    page.tables = tables_of(all);
    for (std::size_t i = 0; i < scenes.size(); ++i) add_plots(page.plots, scenes[i], i + 1);
    return page;
}

}  // namespace raya
