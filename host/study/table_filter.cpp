// Table 3: what the 3 x 3 filter costs over the ring, p = 0, 8 and 16.
#include <fmt/format.h>

#include <algorithm>

#include "host/study/laboratory.hpp"
#include "host/study/offset_times.hpp"
#include "host/study/paper.hpp"
#include "host/study/spa_times.hpp"
#include "host/study/studies.hpp"

namespace raya {
namespace {

struct FilterRow {
    std::uint32_t offset = 0;
    std::uint64_t rotations = 0;
    ModelledTime plain, fitted;
};

double tracing_ms(const ModelledTime& t) { return t.compute_ms - t.filter_ms; }
double filtering_ms(const ModelledTime& t) { return t.filter_ms + t.communication_ms; }
double total_ms(const ModelledTime& t) { return t.compute_ms + t.communication_ms; }

struct FilterStudy {
    std::uint32_t size = 0;
    double factor = 1;
    std::vector<FilterRow> rows;    // p = 0, 8, 16, each rendered
    std::vector<OffsetTime> times;  // every p, from the cost image
};

FilterStudy study_filter(Laboratory& lab, const LabelledScene& scene, std::uint32_t size) {
    FilterStudy study{.size = size, .rows = {}, .times = {}};
    Costs costs;
    for (const std::uint32_t p : {0u, 8u, 16u}) {
        const SpaRun run = run_on_spa(lab.session(), scene, size, size, p % size, AntialiasMethod::kFilter);
        study.factor = fitted_factor(run.cost.front());
        study.rows.push_back({p % size, run.communication.rotations, spa_time(run), spa_time(run, study.factor)});
        costs.trace = run.cost.front();
    }
    study.times = offset_times(costs, size, AntialiasMethod::kFilter);
    return study;
}

struct Printed {
    std::optional<double> tracing, filtering, total;
    std::string remark;
};

std::vector<Comparison> comparisons_of(const FilterStudy& study) {
    const auto paper = [&](double value) { return printed(value, study.size); };
    const std::vector<Printed> all = {
        {paper(paper::kTrace0Ms), paper(paper::kFilter0Ms), paper(paper::kTrace0Ms + paper::kFilter0Ms), ""},
        {{}, paper(paper::kFilter8Ms), {}, "[D] predicted from Table 3, not printed"},
        {paper(paper::kTrace16Ms), paper(paper::kFilter16Ms), paper(paper::kTrace16Ms + paper::kFilter16Ms), ""}};
    std::vector<Comparison> comparisons;
    for (std::size_t i = 0; i < all.size(); ++i) {
        const FilterRow& row = study.rows[i];
        const std::string name = offset_name(row.offset) + ": ", fitted = ", fitted";
        const auto add = [&](const std::string& what, std::optional<double> value, double ours,
                             const std::string& remark) {
            comparisons.push_back({name + what, "ms", value, ours, remark});
        };
        add("ray tracing", all[i].tracing, tracing_ms(row.plain), "");
        add("ray tracing" + fitted, all[i].tracing, tracing_ms(row.fitted), "");
        add("filtering", all[i].filtering, filtering_ms(row.plain), all[i].remark);
        add("filtering" + fitted, all[i].filtering, filtering_ms(row.fitted), all[i].remark);
        add("total", all[i].total, total_ms(row.plain), "");
        add("total" + fitted, all[i].total, total_ms(row.fitted), "");
    }
    comparisons.push_back({"filter's arithmetic", "ms", paper(paper::kFilterArithmeticMs),
                           study.rows.front().plain.filter_ms, "[D]; nothing fitted"});
    comparisons.push_back({"filter's arithmetic, fitted", "ms", paper(paper::kFilterArithmeticMs),
                           study.rows.front().fitted.filter_ms, "[D]"});
    comparisons.push_back({"factor", "", {}, study.factor, "Table 2's"});
    return comparisons;
}

StudyTable filter_table(const FilterStudy& study) {
    StudyTable table{"table3",
                     "Ray tracing and filter, modelled",
                     {"p", "rotations", "communication (ms)", "filter (ms)", "filter, fitted (ms)", "ray tracing (ms)",
                      "ray tracing, fitted (ms)", "total (ms)", "total, fitted (ms)"},
                     {},
                     true};
    for (const FilterRow& row : study.rows)
        table.rows.push_back({std::int64_t{row.offset}, static_cast<std::int64_t>(row.rotations),
                              row.plain.communication_ms, row.plain.filter_ms, row.fitted.filter_ms,
                              tracing_ms(row.plain), tracing_ms(row.fitted), total_ms(row.plain),
                              total_ms(row.fitted)});
    return table;
}

StudyTable offsets_table(const FilterStudy& study) {
    StudyTable table{"table3-offsets",
                     "Every offset, nothing fitted",
                     {"p", "rotations", "communication (ms)", "filter (ms)", "ray tracing (ms)", "total (ms)"},
                     {},
                     false};
    for (std::size_t p = 0; p < study.times.size(); ++p) {
        const OffsetTime& t = study.times[p];
        table.rows.push_back({static_cast<std::int64_t>(p), static_cast<std::int64_t>(t.rotations), t.ring_ms,
                              t.smooth_ms, t.trace_ms, t.total_ms()});
    }
    return table;
}

PlotSeries offsets_series(const FilterStudy& study, const std::string& label, double factor, bool with_tracing) {
    PlotSeries series{label, {}, {}, PlotStyle::kLine};
    for (std::size_t p = 0; p < std::min<std::size_t>(17, study.times.size()); ++p) {
        const OffsetTime& t = study.times[p];
        series.x.push_back(static_cast<double>(p));
        series.y.push_back(t.ring_ms + factor * (t.smooth_ms + (with_tracing ? t.trace_ms : 0)));
    }
    return series;
}

StudyPlot offsets_plot(const FilterStudy& study, bool with_tracing, double paper0, double paper16) {
    const std::string fitted = fmt::format("modelled, computing x {:.2f}", study.factor);
    StudyPlot plot{with_tracing ? "table3-total" : "table3-filter",
                   with_tracing ? "Ray tracing and filter against the offset" : "Filtering against the offset",
                   "offset p (pixels)",
                   "time (modelled ms)",
                   false,
                   false,
                   {offsets_series(study, "modelled, nothing fitted", 1, with_tracing),
                    offsets_series(study, fitted, study.factor, with_tracing)}};
    if (printed(0, study.size)) plot.series.push_back({"paper", {0, 16}, {paper0, paper16}, PlotStyle::kPaper});
    return plot;
}

std::vector<std::string> findings_of(const FilterStudy& study) {
    const FilterRow &first = study.rows.front(), &last = study.rows.back();
    const double lost = filtering_ms(last.fitted) - filtering_ms(first.fitted);
    const double won = tracing_ms(first.fitted) - tracing_ms(last.fitted);
    const auto count = static_cast<std::size_t>(last.offset + 1);
    const std::uint32_t best = best_offset_of(study.times, count);
    std::vector<std::string> findings = {fmt::format(
        "{} instead of {} costs {:.1f} ms more in rotations and {} {:.0f} ms of ray tracing (fitted): the offset {} "
        "with the filter.",
        offset_name(last.offset), offset_name(first.offset), lost, won >= 0 ? "saves" : "loses", std::abs(won),
        won > lost ? "pays" : "does not pay")};
    findings.push_back(
        fmt::format("Rotations counted: {}, {} and {} for {}, {} and {}{}.", study.rows[0].rotations,
                    study.rows[1].rotations, study.rows[2].rotations, offset_name(study.rows[0].offset),
                    offset_name(study.rows[1].offset), offset_name(study.rows[2].offset),
                    study.rows[0].rotations == 2 && study.rows[1].rotations == 18 && study.rows[2].rotations == 34
                        ? ", as the paper counts them"
                        : ""));
    findings.push_back(
        fmt::format("Nothing fitted, of the offsets 0..{} p = {} takes least in all: {:.1f} ms; by ray "
                    "tracing alone it would be p = {}.",
                    last.offset, best, study.times[best].total_ms(),
                    std::min_element(study.times.begin(), study.times.begin() + last.offset + 1,
                                     [](const OffsetTime& a, const OffsetTime& b) { return a.trace_ms < b.trace_ms; }) -
                        study.times.begin()));
    if (printed(0, study.size))
        findings.push_back(fmt::format(
            "The filter's arithmetic is {:.1f} ms by the budget and {:.1f} ms fitted, where Table 3 leaves 7 ms [D]{}",
            first.plain.filter_ms, first.fitted.filter_ms,
            first.fitted.filter_ms < paper::kFilterArithmeticMs / 2
                ? ": the paper's filter takes several times what its additions do; how its program was written is not "
                  "printed."
                : "."));
    return findings;
}

}  // namespace

StudyPage study_table3(Laboratory& lab, const std::vector<LabelledScene>& scenes) {
    const LabelledScene scene = scenes.empty() ? embedded_scene("centre") : scenes.front();
    const std::uint32_t size = lab.size(256);
    const FilterStudy study = study_filter(lab, scene, size);
    StudyPage page;
    page.name = "table3";
    page.title = "Table 3: ray tracing with the 3 x 3 filter";
    page.question = "What does the filter cost, when a larger offset balances better and makes neighbours distant?";
    page.method = {
        fmt::format("{} at {} x {} on {} PEs of the SPA, a PE for each column; rendered and filtered over the ring for "
                    "three offsets, rotations and their words counted.",
                    scene.label, size, size, size),
        "Filtering is its arithmetic by the instruction budget, and the rotations, each its words at the links' rate "
        "and a synchronisation. The rate of rotations is calibrated on Tables 3 and 4 (0.3125 ms).",
        "Fitted: computing is multiplied by Table 2's factor, rotations are not. The plots' other offsets follow from "
        "the cost image and the shortest routes, which the three renders confirm."};
    page.comparisons = comparisons_of(study);
    page.tables = {filter_table(study), offsets_table(study)};
    page.plots = {
        offsets_plot(study, false, paper::kFilter0Ms, paper::kFilter16Ms),
        offsets_plot(study, true, paper::kTrace0Ms + paper::kFilter0Ms, paper::kTrace16Ms + paper::kFilter16Ms)};
    page.findings = findings_of(study);
    page.settings = {{"scene", scene.label},
                     {"size", size},
                     {"pes", size},
                     {"format", format_name(format_for(scene.scene))},
                     {"factor", study.factor}};
    return page;
}

}  // namespace raya
