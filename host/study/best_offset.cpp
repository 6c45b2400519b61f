// The best offset for the user's scene: balance against communication, for each number of PEs and anti-aliasing.
#include <span>

#include "host/study/arrays.hpp"
#include "host/study/ensemble.hpp"
#include "host/study/paper.hpp"
#include "host/study/prose.hpp"
#include "host/study/rows.hpp"
#include "host/study/spa_times.hpp"
#include "host/study/studies.hpp"

namespace raya {
namespace {

constexpr const char* kName = "best-offset";
constexpr std::size_t kViews = 40;
constexpr double kEnough = 1;  // %: ours; what an offset may lose and still be enough

// One scene, one number of PEs and one way of anti-aliasing.
struct Choice {
    std::string scene, format;
    std::uint32_t size = 0, pes = 0, root = 0;  // root: round(sqrt(P)) modulo W, the paper's best
    AntialiasMethod method = AntialiasMethod::kNone;
    std::vector<OffsetTime> times = {};
    OffsetTime best = {}, best_near = {};             // of all offsets, of 0..root
    std::vector<std::uint32_t> best_of_factors = {};  // the best offsets for factors of 1 to 8, each once
    std::vector<std::vector<double>> chosen_by = {},
                                     judged_by = {};  // views of odd and of even seeds: [view][offset] ms

    // Of 0..`count` - 1 that which takes least in the mean of the views by which offsets are chosen.
    std::uint32_t chosen(std::size_t count) const {
        std::vector<double> sums(count);
        for (const auto& ms : chosen_by)
            for (std::size_t p = 0; p < count; ++p) sums[p] += ms[p];
        return static_cast<std::uint32_t>(std::ranges::min_element(sums) - sums.begin());
    }
    std::uint32_t chosen_of_all() const { return chosen(times.size()); }
    std::uint32_t chosen_near() const { return chosen(root + 1); }

    // In the other views: what an offset takes, and by how many % longer than the chosen one of all.
    Estimate time_of(std::uint32_t offset) const {
        return mean_of_each(judged_by, [&](const std::vector<double>& ms) { return ms[offset]; });
    }
    Estimate longer(std::uint32_t offset, double confidence = 0.95) const {
        const std::uint32_t soonest = chosen_of_all();
        return mean_of_each(
            judged_by, [&](const std::vector<double>& ms) { return 100 * (ms[offset] / ms[soonest] - 1); }, confidence);
    }

    // n^2 of n x n PEs, where the image has columns for that offset.
    std::uint32_t square() const { return root * root; }
    bool has_square() const { return square() == pes && square() < times.size(); }

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
    const Ensemble ensemble = ensemble_of(lab, scene, size, AntialiasMethod::kSupersample, kViews);
    const Costs& costs = *ensemble.picture;
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
            for (std::size_t view = 0; view < ensemble.views.size(); ++view)
                (view % 2 == 0 ? choice.chosen_by : choice.judged_by)
                    .push_back(each(offset_times(*ensemble.views[view], pes, method, machine_factor().value),
                                    &OffsetTime::total_ms));
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

// --- what views say

std::string views_finding(const Choice& c) {
    const std::uint32_t best = c.chosen_of_all();
    const auto longer = [&](std::uint32_t offset) { return with_interval(c.longer(offset), 1); };
    return finding(kName, "views", "scene"_a = c.scene, "pes"_a = c.pes, "method"_a = c.method_text(),
                   "views"_a = c.chosen_by.size() + c.judged_by.size(), "best"_a = best,
                   "time"_a = with_interval(c.time_of(best), 1), "near"_a = c.chosen_near(),
                   "near_longer"_a = longer(c.chosen_near()), "root"_a = c.root, "root_longer"_a = longer(c.root),
                   "zero_longer"_a = longer(0), "picture"_a = c.best.offset,
                   "picture_longer"_a = longer(c.best.offset));
}

Claim claim_of_enough(const Choices& scene) {
    const auto near = each(scene, [&](const Choice& c) { return c.longer(c.chosen_near(), each_of(scene.size())); });
    const auto more = std::ranges::count_if(near, [](const Estimate&e) { return e.low() > kEnough; }),
               none = std::ranges::count_if(near, [](const Estimate&e) { return e.high() <= kEnough; });
    return {paper::kSpa, "section on the cyclic mapping",
            "Offsets of 0..sqrt(P) are enough, communication with neighbours considered.",
            verdict_of(none == std::ssize(near), more > 0),
            finding(kName, "enough", "cases"_a = near.size(), "none"_a = none, "more"_a = more, "rule"_a = kEnough)};
}

Claim claim_of_square(const Choices& scene) {
    const Choices some = where(scene, &Choice::has_square);
    std::size_t cases = 0, equal = 0;
    for (const Choice& c : some) {
        const auto same = [&](const std::vector<double>& ms) { return ms[c.square()] == ms[0]; };
        cases += 1 + c.chosen_by.size() + c.judged_by.size();
        equal += c.times[c.square()].total_ms() == c.times[0].total_ms();
        for (const auto* views : {&c.chosen_by, &c.judged_by})
            equal += static_cast<std::size_t>(std::ranges::count_if(*views, same));
    }
    return {paper::kSpa, "section on the cyclic mapping", "On n x n PEs p = n^2 is the same as p = 0.",
            verdict_of(cases > 0 && equal == cases, equal < cases),
            finding(kName, "square", "equal"_a = equal, "cases"_a = cases)};
}

StudyTable table_of_views(const Choices& choices) {
    const auto mean = [](auto offset) {
        return [=](const Choice& c) { return c.longer(std::invoke(offset, c)).mean; };
    };
    const auto half = [](auto offset) {
        return [=](const Choice& c) { return c.longer(std::invoke(offset, c)).half_width; };
    };
    const auto zero = [](const Choice&) { return 0u; };
    return table_of(std::string(kName) + "-views", "Offsets chosen by one half of the views, in the other half",
                    choices,
                    {{"scene", &Choice::scene},
                     {"PEs", &Choice::pes},
                     {"anti-aliasing", &Choice::antialias},
                     {"best p", &Choice::chosen_of_all},
                     {"time", [](const Choice& c) { return c.time_of(c.chosen_of_all()).mean; }, "ms"},
                     {"time, +-", [](const Choice& c) { return c.time_of(c.chosen_of_all()).half_width; }, "ms"},
                     {"best p of 0..sqrt(P)", &Choice::chosen_near},
                     {"it takes longer", mean(&Choice::chosen_near), "%"},
                     {"it, +-", half(&Choice::chosen_near), "%"},
                     {"p = sqrt(P) takes longer", mean(&Choice::root), "%"},
                     {"p = sqrt(P), +-", half(&Choice::root), "%"},
                     {"p = 0 takes longer", mean(zero), "%"},
                     {"p = 0, +-", half(zero), "%"}});
}

// --- the page

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
    settings["views"] = kViews;
    settings["rule"] = kEnough;
    StudyPage page = page_about(kName, settings);
    page.clock = clock_text();
    page.news = {sentence(kName, "news")};
    for (const Choice& c : scenes.front())
        page.comparisons.push_back(
            {fmt::format("best p, {} PEs, {}", c.pes, c.antialias()), "", std::nullopt, double(c.best.offset),
             fmt::format("u of the first pass {:.3f}; sqrt(P), Kohata & Ito's, is p = {}", c.best.imbalance, c.root)});
    for (const Choices& scene : scenes) page.findings.push_back(chief_finding(scene));
    for (const Choice& choice : all) page.findings.push_back(views_finding(choice));
    for (const Choice& choice : all) page.findings.push_back(choice_finding(choice));
    page.claims = {claim_of_enough(scenes.front()), claim_of_square(scenes.front())};
    page.tables = tables_of(all);
    page.tables.insert(page.tables.begin(), table_of_views(all));
    for (std::size_t i = 0; i < scenes.size(); ++i) add_plots(page.plots, scenes[i], i + 1);
    return page;
}

}  // namespace raya
