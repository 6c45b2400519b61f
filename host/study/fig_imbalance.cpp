// Fig. 8 and Fig. 13: the imbalance u against the offset p, in the first pass and in supersampling.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "ring/schedule.hpp"
#include "study/laboratory.hpp"
#include "study/paper.hpp"
#include "study/studies.hpp"

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

StudyPage imbalance_page(Laboratory& lab, const std::vector<LabelledScene>& scenes, const Pass& pass) {
    const LabelledScene scene = scenes.empty() ? embedded_scene("centre") : scenes.front();
    const std::uint32_t size = lab.size(256);
    const Costs& costs = lab.costs(scene, size, pass.method);
    const bool first = pass.method == AntialiasMethod::kNone, calibrated = first && scenes.empty() && size == 256;
    const CostImage& image = first ? costs.trace : costs.supersample;
    const std::vector<double> u = imbalance_of_offsets(image, size, RAYA_FOLD_CYCLIC, all_offsets(size));
    const auto at = [&](std::uint32_t p) { return u[p % size]; };
    const std::size_t shown = std::min<std::size_t>(17, size);
    const auto best = static_cast<std::uint32_t>(std::min_element(u.begin(), u.end()) - u.begin());
    const auto best_near = static_cast<std::uint32_t>(
        std::min_element(u.begin(), u.begin() + static_cast<std::ptrdiff_t>(shown)) - u.begin());
    const auto better = std::count_if(u.begin(), u.end(), [&](double value) { return value < at(kBest); });

    StudyPage page;
    page.name = pass.name;
    page.title = pass.title;
    page.question = pass.question;
    page.method = {fmt::format("{} at {} x {} on {} PEs of the SPA, a PE for each column; {}.", scene.label, size, size,
                               size, pass.phase),
                   "u = (max load - mean load) / mean load, from one cost image: the load of a static mapping is the "
                   "sum of its pixels' modelled cycles."};
    page.settings = {{"scene", scene.label}, {"size", size}, {"pes", size}};
    const auto paper = [&](double value) { return first ? std::optional<double>(value) : std::nullopt; };
    page.comparisons = {
        {"u(0)", "", paper(paper::kImbalance0), at(0), calibrated ? "calibrated on: see scenes/README.md" : ""},
        {"u(8)", "", {}, at(kGood), first ? "the paper: \"already good\"" : ""},
        {"u(16)", "", paper(paper::kImbalance16), at(kBest), ""},
        {"best p of 0..16", "", first ? std::optional<double>(16) : std::nullopt, double(best_near),
         fmt::format("u = {:.3f}", u[best_near])},
        {fmt::format("best p of all {}", size), "", {}, double(best), fmt::format("u = {:.3f}", u[best])}};
    page.tables = {table_of(pass.name, u)};
    StudyPlot near{
        pass.name, fmt::format("Imbalance against the offset, {}", pass.phase), "offset p (pixels)", "u", false,
        false,     {series_of(scene.label, u, shown, PlotStyle::kLine)}};
    StudyPlot all{pass.name + "-all",
                  fmt::format("Imbalance against every offset, {}", pass.phase),
                  "offset p (pixels)",
                  "u",
                  false,
                  true,
                  {series_of(scene.label, u, size, PlotStyle::kLine)}};
    if (first) {
        const PlotSeries printed{
            "paper, from its tables", {0, 16}, {paper::kImbalance0, paper::kImbalance16}, PlotStyle::kPaper};
        near.series.push_back(printed);
        all.series.push_back(printed);
    }
    page.plots = {near, all};
    page.findings = {fmt::format("u falls from {:.3f} at p = 0 to {:.3f} at p = 8 and {:.3f} at p = 16.", at(0),
                                 at(kGood), at(kBest)),
                     fmt::format("Of the offsets 0..16 p = {} is best, u = {:.3f}; of all {} p = {}, u = {:.3f}. {} "
                                 "offsets are better than p = 16.",
                                 best_near, u[best_near], size, best, u[best], better)};
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
