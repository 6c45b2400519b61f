// Fig. 7 and Fig. 12: the load of each PE for the column split and for p = 16, in the first pass and in supersampling.
#include <fmt/format.h>

#include "host/ring/mapping.hpp"
#include "host/ring/schedule.hpp"
#include "host/study/laboratory.hpp"
#include "host/study/paper.hpp"
#include "host/study/studies.hpp"

namespace raya {
namespace {

constexpr std::uint32_t kOffset = 16;  // the paper's, sqrt(256)

PlotSeries loads_series(const std::string& label, const Load& load) {
    PlotSeries series{label, {}, {}, PlotStyle::kLine};
    for (std::size_t pe = 0; pe < load.per_pe.size(); ++pe) {
        series.x.push_back(static_cast<double>(pe));
        series.y.push_back(spa_ms(static_cast<double>(load.per_pe[pe])));
    }
    return series;
}

PlotSeries mean_series(const Load& load) {
    const double last = static_cast<double>(load.per_pe.size() - 1), mean = spa_ms(load.mean);
    return {"mean", {0, last}, {mean, mean}, PlotStyle::kLine};
}

StudyTable loads_table(const std::string& name, const Load& columns, const Load& cyclic) {
    StudyTable table{name, "Load of each PE", {"PE", "p = 0 (cycles)", "p = 16 (cycles)"}, {}, false};
    for (std::size_t pe = 0; pe < columns.per_pe.size(); ++pe)
        table.rows.push_back({static_cast<std::int64_t>(pe), static_cast<std::int64_t>(columns.per_pe[pe]),
                              static_cast<std::int64_t>(cyclic.per_pe[pe])});
    return table;
}

// Mean load of the PEs `first` to `last` - 1, over that of all.
double mean_between(const Load& load, std::size_t first, std::size_t last) {
    double sum = 0;
    for (std::size_t pe = first; pe < last; ++pe) sum += static_cast<double>(load.per_pe[pe]);
    return sum / static_cast<double>(last - first) / load.mean;
}

struct Pass {
    std::string name, title, question, phase;
    AntialiasMethod method;
};

std::vector<Comparison> comparisons_of(const Load& columns, const Load& cyclic, bool first, bool calibrated) {
    const auto paper = [&](double value) { return first ? std::optional<double>(value) : std::nullopt; };
    return {{"mean load", "ms", paper(paper::kMeanMs), spa_ms(columns.mean), "no factor fitted"},
            {"largest load, p = 0", "ms", paper(paper::kTrace0Ms), spa_ms(static_cast<double>(columns.max)), ""},
            {"largest load, p = 16", "ms", paper(paper::kTrace16Ms), spa_ms(static_cast<double>(cyclic.max)), ""},
            {"u(0)", "", paper(paper::kImbalance0), columns.imbalance,
             calibrated ? "calibrated on: see scenes/README.md" : ""},
            {"u(16)", "", paper(paper::kImbalance16), cyclic.imbalance, ""}};
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

StudyPlot plot_of(const Pass& pass, const Load& columns, const Load& cyclic) {
    StudyPlot plot{pass.name, fmt::format("Load of each PE, {}", pass.phase), "PE", "load (modelled ms)"};
    plot.series = {loads_series("p = 0, column split", columns), loads_series("p = 16, cyclic mapping", cyclic),
                   mean_series(columns)};
    return plot;
}

StudyPage loads_page(Laboratory& lab, const std::vector<LabelledScene>& scenes, const Pass& pass) {
    const LabelledScene scene = scenes.empty() ? embedded_scene("centre") : scenes.front();
    const std::uint32_t size = lab.size(256), p = kOffset % size;
    const bool first = pass.method == AntialiasMethod::kNone, calibrated = first && scenes.empty() && size == 256;
    const Costs& costs = lab.costs(scene, size, pass.method);
    const CostImage& image = first ? costs.trace : costs.supersample;
    const Load columns = static_load(image, make_mapping("cyclic", size, size, size, 0, "cyclic"));
    const Load cyclic = static_load(image, make_mapping("cyclic", size, size, size, p, "cyclic"));

    StudyPage page;
    page.name = pass.name;
    page.title = pass.title;
    page.question = pass.question;
    page.method = {
        fmt::format("{} at {} x {} on {} PEs of the SPA, a PE for each column; {}.", scene.label, size, size, size,
                    pass.phase),
        "Loads are the sums of the modelled cycles that the kernels counted for each pixel, at 100 ns a cycle."};
    page.settings = {{"scene", scene.label}, {"size", size}, {"pes", size}, {"offsets", {0, p}}};
    page.comparisons = comparisons_of(columns, cyclic, first, calibrated);
    page.tables = {loads_table(pass.name, columns, cyclic)};
    page.plots = {plot_of(pass, columns, cyclic)};
    page.findings = {finding_of(columns, cyclic, p)};
    return page;
}

}  // namespace

StudyPage study_fig7(Laboratory& lab, const std::vector<LabelledScene>& scenes) {
    return loads_page(lab, scenes,
                      {"fig7", "Fig. 7: load of each PE",
                       "How is the work of one image spread over the PEs, by columns and by the cyclic mapping?",
                       "first pass", AntialiasMethod::kNone});
}

StudyPage study_fig12(Laboratory& lab, const std::vector<LabelledScene>& scenes) {
    return loads_page(lab, scenes,
                      {"fig12", "Fig. 12: load of each PE in supersampling",
                       "Is the extra work of supersampling spread as evenly as the first pass?", "supersampling alone",
                       AntialiasMethod::kSupersample});
}

}  // namespace raya
