// Fig. 8 and Fig. 13: the imbalance u against the offset p, in the first pass and in supersampling.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "host/ring/schedule.hpp"
#include "host/study/laboratory.hpp"
#include "host/study/paper.hpp"
#include "host/study/studies.hpp"

namespace raya {
namespace {

constexpr std::uint32_t kGood = 8, kBest = 16;  // "already good" and best, in the paper

struct Pass {
    std::string name, title, question, phase;
    AntialiasMethod method;
};

std::vector<std::uint32_t> all_offsets(std::uint32_t size) {
    std::vector<std::uint32_t> offsets(size);
    std::iota(offsets.begin(), offsets.end(), 0u);
    return offsets;
}

PlotSeries series_of(const std::string& label, const std::vector<double>& u, std::size_t count, PlotStyle style) {
    PlotSeries series{label, {}, {}, style};
    for (std::size_t p = 0; p < count; ++p) {
        series.x.push_back(static_cast<double>(p));
        series.y.push_back(u[p]);
    }
    return series;
}

StudyTable table_of(const std::string& name, const std::vector<double>& u) {
    StudyTable table{name, "Imbalance for each offset", {"p", "u"}, {}, false};
    for (std::size_t p = 0; p < u.size(); ++p) table.rows.push_back({static_cast<std::int64_t>(p), u[p]});
    return table;
}

// u of every offset, and the offsets that stand out.
struct Imbalances {
    std::vector<double> u;
    std::size_t best = 0, best_near = 0;  // of all offsets; of 0..16

    explicit Imbalances(std::vector<double> of_offsets) : u(std::move(of_offsets)) {
        best = static_cast<std::size_t>(std::min_element(u.begin(), u.end()) - u.begin());
        const auto near_end = u.begin() + static_cast<std::ptrdiff_t>(shown());
        best_near = static_cast<std::size_t>(std::min_element(u.begin(), near_end) - u.begin());
    }
    std::size_t shown() const { return std::min<std::size_t>(kBest + 1, u.size()); }
    double at(std::uint32_t p) const { return u[p % u.size()]; }
};

std::vector<Comparison> comparisons_of(const Imbalances& i, bool first, bool calibrated) {
    const auto paper = [&](double value) { return first ? std::optional<double>(value) : std::nullopt; };
    const auto value_of = [&](std::size_t p) { return fmt::format("u = {:.3f}", i.u[p]); };
    return {{"u(0)", "", paper(paper::kImbalance0), i.at(0), calibrated ? "calibrated on: see scenes/README.md" : ""},
            {"u(8)", "", {}, i.at(kGood), first ? "the paper: \"already good\"" : ""},
            {"u(16)", "", paper(paper::kImbalance16), i.at(kBest), ""},
            {"best p of 0..16", "", paper(kBest), double(i.best_near), value_of(i.best_near)},
            {fmt::format("best p of all {}", i.u.size()), "", {}, double(i.best), value_of(i.best)}};
}

std::vector<StudyPlot> plots_of(const Imbalances& i, const Pass& pass, const std::string& label, bool first) {
    StudyPlot near{pass.name, fmt::format("Imbalance against the offset, {}", pass.phase), "offset p (pixels)", "u"};
    StudyPlot all{pass.name + "-all", fmt::format("Imbalance against every offset, {}", pass.phase), near.x_label, "u"};
    all.log_y = true;
    near.series = {series_of(label, i.u, i.shown(), PlotStyle::kLine)};
    all.series = {series_of(label, i.u, i.u.size(), PlotStyle::kLine)};
    if (first)
        for (StudyPlot* plot : {&near, &all})
            plot->series.push_back(
                {"paper, from its tables", {0, kBest}, {paper::kImbalance0, paper::kImbalance16}, PlotStyle::kPaper});
    return {near, all};
}

std::vector<std::string> findings_of(const Imbalances& i) {
    const auto better = std::count_if(i.u.begin(), i.u.end(), [&](double value) { return value < i.at(kBest); });
    return {
        fmt::format("u is {:.3f} at p = 0, {:.3f} at p = 8 and {:.3f} at p = 16.", i.at(0), i.at(kGood), i.at(kBest)),
        fmt::format("Of the offsets 0..16 p = {} is best, u = {:.3f}; of all {} p = {}, u = {:.3f}. {} offsets are "
                    "better than p = 16.",
                    i.best_near, i.u[i.best_near], i.u.size(), i.best, i.u[i.best], better)};
}

StudyPage imbalance_page(Laboratory& lab, const std::vector<LabelledScene>& scenes, const Pass& pass) {
    const LabelledScene scene = scenes.empty() ? embedded_scene("centre") : scenes.front();
    const std::uint32_t size = lab.size(256);
    const bool first = pass.method == AntialiasMethod::kNone, calibrated = first && scenes.empty() && size == 256;
    const Costs& costs = lab.costs(scene, size, pass.method);
    const CostImage& image = first ? costs.trace : costs.supersample;
    const Imbalances imbalances(imbalance_of_offsets(image, size, RAYA_FOLD_CYCLIC, all_offsets(size)));

    StudyPage page;
    page.name = pass.name;
    page.title = pass.title;
    page.question = pass.question;
    page.method = {fmt::format("{} at {} x {} on {} PEs of the SPA, a PE for each column; {}.", scene.label, size, size,
                               size, pass.phase),
                   "u = (max load - mean load) / mean load, from one cost image: the load of a static mapping is the "
                   "sum of its pixels' modelled cycles."};
    page.settings = {{"scene", scene.label}, {"size", size}, {"pes", size}};
    page.comparisons = comparisons_of(imbalances, first, calibrated);
    page.tables = {table_of(pass.name, imbalances.u)};
    page.plots = plots_of(imbalances, pass, scene.label, first);
    page.findings = findings_of(imbalances);
    return page;
}

}  // namespace

StudyPage study_fig8(Laboratory& lab, const std::vector<LabelledScene>& scenes) {
    return imbalance_page(
        lab, scenes,
        {"fig8", "Fig. 8: imbalance against the offset", "Which offset of the cyclic mapping spreads the load best?",
         "first pass", AntialiasMethod::kNone});
}

StudyPage study_fig13(Laboratory& lab, const std::vector<LabelledScene>& scenes) {
    return imbalance_page(lab, scenes,
                          {"fig13", "Fig. 13: imbalance against the offset in supersampling",
                           "Does the offset that suits the first pass suit supersampling as well?",
                           "supersampling alone", AntialiasMethod::kSupersample});
}

}  // namespace raya
