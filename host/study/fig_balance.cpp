// Figs 7 and 12, the load of each PE, and Figs 8 and 13, the imbalance u of each offset: of the first pass and of
// supersampling.
#include <cmath>
#include <numeric>
#include <span>

#include "host/ring/schedule.hpp"
#include "host/study/arrays.hpp"
#include "host/study/paper.hpp"
#include "host/study/prose.hpp"
#include "host/study/rows.hpp"
#include "host/study/studies.hpp"

namespace raya {
namespace {

constexpr std::uint32_t kGood = 8, kBest = 16;  // "already good" and best, in the paper; 16 is sqrt(256)

// One pass over one scene, a PE for each column.
struct Pass {
    std::string scene, phase, calibration;  // the remark beside u(0)
    std::uint32_t size;
    bool first;
    const CostImage& image;

    bool in_paper() const { return first && as_in_paper(scene, size); }
    std::optional<double> paper(double value) const { return in_paper() ? std::optional<double>(value) : std::nullopt; }
};

Pass pass_of(Laboratory& lab, const Scenes& scenes, AntialiasMethod method) {
    const LabelledScene scene = one_of(scenes);
    const std::uint32_t size = lab.size(256);
    const bool first = method == AntialiasMethod::kNone, calibrated = first && as_in_paper(scene.label, size);
    const Costs& costs = lab.costs(scene, size, method);
    return {scene.label,
            first ? "first pass" : "supersampling alone",
            calibrated ? "calibrated on: see scenes/README.md" : "",
            size,
            first,
            first ? costs.trace : costs.supersample};
}

// --- Figs 7 and 12

struct PeLoad {
    std::size_t pe;
    std::uint64_t columns, cyclic;  // cycles
    double columns_ms() const { return spa_ms(static_cast<double>(columns)); }
    double cyclic_ms() const { return spa_ms(static_cast<double>(cyclic)); }
};

// Mean load of the PEs `first` to `last` - 1, over that of all.
double mean_between(const Load& load, std::size_t first, std::size_t last) {
    double sum = 0;
    for (std::size_t pe = first; pe < last; ++pe) sum += static_cast<double>(load.per_pe[pe]);
    return sum / static_cast<double>(last - first) / load.mean;
}

std::string finding_of(const Load& columns, const Load& cyclic, std::uint32_t p) {
    const std::size_t size = columns.per_pe.size(), eighth = size / 8, middle = size / 2;
    return fmt::format(
        "With columns the PEs of the middle quarter carry {:.2f} times the mean load and those of the outer quarter "
        "{:.2f} times; with p = {} the lightest PE carries {:.2f} times and the heaviest {:.2f} times the mean.",
        mean_between(columns, middle - eighth, middle + eighth),
        (mean_between(columns, 0, eighth) + mean_between(columns, size - eighth, size)) / 2, p,
        static_cast<double>(cyclic.min) / cyclic.mean, static_cast<double>(cyclic.max) / cyclic.mean);
}

StudyPage loads_page(const std::string& name, const Pass& pass) {
    const std::uint32_t p = kBest % pass.size;
    const Load columns = static_load(pass.image, cyclic(pass.size, 0));
    const Load shifted = static_load(pass.image, cyclic(pass.size, p));
    std::vector<PeLoad> rows;
    for (std::size_t pe = 0; pe < pass.size; ++pe) rows.push_back({pe, columns.per_pe[pe], shifted.per_pe[pe]});
    const double mean = spa_ms(columns.mean);

    StudyPage page = page_about(
        name, {{"scene", pass.scene}, {"size", pass.size}, {"pes", pass.size}, {"offsets", std::vector{0u, p}}});
    page.comparisons = {
        {"mean load", "ms", pass.paper(paper::kMeanMs), mean, "no factor fitted"},
        {"largest load, p = 0", "ms", pass.paper(paper::kTrace0Ms), spa_ms(static_cast<double>(columns.max))},
        {"largest load, p = 16", "ms", pass.paper(paper::kTrace16Ms), spa_ms(static_cast<double>(shifted.max))},
        {"u(0)", "", pass.paper(paper::kImbalance0), columns.imbalance, pass.calibration},
        {"u(16)", "", pass.paper(paper::kImbalance16), shifted.imbalance}};
    page.tables = {table_of(
        page.name, "Load of each PE", rows,
        {{"PE", &PeLoad::pe}, {"p = 0", &PeLoad::columns, "cycles"}, {"p = 16", &PeLoad::cyclic, "cycles"}}, false)};
    page.plots = {{page.name, "Load of each PE, " + pass.phase, "PE", "load (modelled ms)"}};
    page.plots[0].series = {line("p = 0, column split", rows, &PeLoad::pe, &PeLoad::columns_ms),
                            line("p = 16, cyclic mapping", rows, &PeLoad::pe, &PeLoad::cyclic_ms),
                            {"mean", {0, pass.size - 1.0}, {mean, mean}}};
    page.findings = {finding_of(columns, shifted, p)};
    return page;
}

// --- Figs 8 and 13

struct Offset {
    std::uint32_t p;
    double u;
};

StudyPage imbalance_page(const std::string& name, const Pass& pass) {
    std::vector<std::uint32_t> offsets(pass.size);
    std::iota(offsets.begin(), offsets.end(), 0u);
    const std::vector<double> u = imbalance_of_offsets(pass.image, pass.size, RAYA_FOLD_CYCLIC, offsets);
    const auto rows = each(offsets, [&](std::uint32_t p) { return Offset{p, u[p]}; });
    const auto at = [&](std::uint32_t p) { return u[p % pass.size]; };
    const std::span near = std::span(rows).first(std::min(kBest + 1, pass.size));
    const Offset &best = least(rows, &Offset::u), &best_near = least(near, &Offset::u);
    const auto value = [](const Offset& offset) { return fmt::format("u = {:.3f}", offset.u); };

    StudyPage page = page_about(name, {{"scene", pass.scene}, {"size", pass.size}, {"pes", pass.size}});
    page.comparisons = {{"u(0)", "", pass.paper(paper::kImbalance0), at(0), pass.calibration},
                        {"u(8)", "", std::nullopt, at(kGood), pass.in_paper() ? "the paper: \"already good\"" : ""},
                        {"u(16)", "", pass.paper(paper::kImbalance16), at(kBest)},
                        {"best p of 0..16", "", pass.paper(kBest), double(best_near.p), value(best_near)},
                        {fmt::format("best p of all {}", rows.size()), "", std::nullopt, double(best.p), value(best)}};
    page.tables = {
        table_of(page.name, "Imbalance for each offset", rows, {{"p", &Offset::p}, {"u", &Offset::u}}, false)};
    const std::string over = "Imbalance against ", axis = "offset p (pixels)";
    page.plots = {{page.name, over + "the offset, " + pass.phase, axis, "u"},
                  {page.name + "-all", over + "every offset, " + pass.phase, axis, "u", Axes::kLogY}};
    page.plots[0].series = {line(pass.scene, near, &Offset::p, &Offset::u)};
    page.plots[1].series = {line(pass.scene, rows, &Offset::p, &Offset::u)};
    for (StudyPlot& plot : page.plots)
        if (pass.in_paper())
            plot.series.push_back(
                {"paper, from its tables", {0, kBest}, {paper::kImbalance0, paper::kImbalance16}, PlotStyle::kPaper});
    page.findings = {
        fmt::format("u is {:.3f} at p = 0, {:.3f} at p = 8 and {:.3f} at p = 16.", at(0), at(kGood), at(kBest)),
        fmt::format("Of the offsets 0..16 p = {} is best, u = {:.3f}; of all {} p = {}, u = {:.3f}. {} offsets are "
                    "better than p = 16.",
                    best_near.p, best_near.u, rows.size(), best.p, best.u,
                    std::ranges::count_if(u, [&](double one) { return one < at(kBest); }))};
    return page;
}

}  // namespace

StudyPage study_fig7(Laboratory& lab, const Scenes& scenes) {
    return loads_page("fig7", pass_of(lab, scenes, AntialiasMethod::kNone));
}

StudyPage study_fig8(Laboratory& lab, const Scenes& scenes) {
    return imbalance_page("fig8", pass_of(lab, scenes, AntialiasMethod::kNone));
}

StudyPage study_fig12(Laboratory& lab, const Scenes& scenes) {
    return loads_page("fig12", pass_of(lab, scenes, AntialiasMethod::kSupersample));
}

StudyPage study_fig13(Laboratory& lab, const Scenes& scenes) {
    return imbalance_page("fig13", pass_of(lab, scenes, AntialiasMethod::kSupersample));
}

}  // namespace raya
