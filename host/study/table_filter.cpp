// Table 3: what the 3 x 3 filter costs over the ring, p = 0, 8 and 16.
#include <cmath>
#include <span>

#include "host/study/offset_times.hpp"
#include "host/study/paper.hpp"
#include "host/study/prose.hpp"
#include "host/study/rows.hpp"
#include "host/study/spa_times.hpp"
#include "host/study/studies.hpp"

namespace raya {
namespace {

double tracing_ms(const ModelledTime& t) { return t.compute_ms - t.filter_ms; }
double filtering_ms(const ModelledTime& t) { return t.filter_ms + t.communication_ms; }
double total_ms(const ModelledTime& t) { return t.compute_ms + t.communication_ms; }

struct FilterRow {
    std::uint32_t offset = 0;
    std::uint64_t rotations = 0;
    ModelledTime plain, fitted;
};

struct FilterStudy {
    std::uint32_t size = 0;
    double factor = 1;
    std::vector<FilterRow> rows = {};    // p = 0, 8, 16, each rendered
    std::vector<OffsetTime> times = {};  // every p, from the cost image

    std::span<const OffsetTime> near() const { return std::span(times).first(std::min<std::size_t>(17, size)); }
};

FilterStudy study_filter(Laboratory& lab, const LabelledScene& scene, std::uint32_t size) {
    FilterStudy study{.size = size};
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

// A figure that Table 3 has, and what it has for p = 0, 8 and 16.
struct Figure {
    const char* what;
    double (*ours)(const ModelledTime&);
    std::optional<double> paper[3];
};
constexpr Figure kFigures[] = {{"ray tracing", tracing_ms, {paper::kTrace0Ms, std::nullopt, paper::kTrace16Ms}},
                               {"filtering", filtering_ms, {paper::kFilter0Ms, paper::kFilter8Ms, paper::kFilter16Ms}},
                               {"total", total_ms, {paper::kFiltered0Ms, std::nullopt, paper::kFiltered16Ms}}};

std::vector<Comparison> comparisons_of(const FilterStudy& study) {
    std::vector<Comparison> all;
    for (std::size_t i = 0; i < study.rows.size(); ++i)
        for (const Figure& figure : kFigures)
            for (const bool fitted : {false, true}) {
                const FilterRow& row = study.rows[i];
                all.push_back({offset_name(row.offset) + ": " + figure.what + (fitted ? ", fitted" : ""), "ms",
                               printed(figure.paper[i], study.size), figure.ours(fitted ? row.fitted : row.plain),
                               i == 1 && figure.paper[i] ? "[D] predicted from Table 3, not printed" : ""});
            }
    const std::optional<double> arithmetic = printed(paper::kFilterArithmeticMs, study.size);
    const FilterRow& first = study.rows.front();
    all.push_back({"filter's arithmetic", "ms", arithmetic, first.plain.filter_ms, "[D]; nothing fitted"});
    all.push_back({"filter's arithmetic, fitted", "ms", arithmetic, first.fitted.filter_ms, "[D]"});
    all.push_back({"factor", "", std::nullopt, study.factor, "Table 2's"});
    return all;
}

std::vector<StudyTable> tables_of(const FilterStudy& study) {
    const auto plain = [](auto figure) { return [=](const FilterRow& row) { return std::invoke(figure, row.plain); }; };
    const auto fitted = [](auto figure) {
        return [=](const FilterRow& row) { return std::invoke(figure, row.fitted); };
    };
    return {table_of("table3", "Ray tracing and filter, modelled", study.rows,
                     {{"p", &FilterRow::offset},
                      {"rotations", &FilterRow::rotations},
                      {"communication", plain(&ModelledTime::communication_ms), "ms"},
                      {"filter", plain(&ModelledTime::filter_ms), "ms"},
                      {"filter, fitted", fitted(&ModelledTime::filter_ms), "ms"},
                      {"ray tracing", plain(tracing_ms), "ms"},
                      {"ray tracing, fitted", fitted(tracing_ms), "ms"},
                      {"total", plain(total_ms), "ms"},
                      {"total, fitted", fitted(total_ms), "ms"}}),
            table_of("table3-offsets", "Every offset, nothing fitted", study.times,
                     {{"p", &OffsetTime::offset},
                      {"rotations", &OffsetTime::rotations},
                      {"communication", &OffsetTime::ring_ms, "ms"},
                      {"filter", &OffsetTime::smooth_ms, "ms"},
                      {"ray tracing", &OffsetTime::trace_ms, "ms"},
                      {"total", &OffsetTime::total_ms, "ms"}},
                     false)};
}

StudyPlot offsets_plot(const FilterStudy& study, bool with_tracing, double paper0, double paper16) {
    StudyPlot plot{with_tracing ? "table3-total" : "table3-filter",
                   with_tracing ? "Ray tracing and filter against the offset" : "Filtering against the offset",
                   "offset p (pixels)", "time (modelled ms)"};
    for (const double factor : {1.0, study.factor}) {
        const std::string label = plot.series.empty() ? "modelled, nothing fitted"
                                                      : fmt::format("modelled, computing x {:.2f}", study.factor);
        plot.series.push_back(line(label, study.near(), &OffsetTime::offset, [&](const OffsetTime& t) {
            return t.ring_ms + factor * (t.smooth_ms + (with_tracing ? t.trace_ms : 0));
        }));
    }
    if (at_papers_size(study.size)) plot.series.push_back({"paper", {0, 16}, {paper0, paper16}, PlotStyle::kPaper});
    return plot;
}

std::string finding_of_offset(const FilterRow& first, const FilterRow& last) {
    const double lost = filtering_ms(last.fitted) - filtering_ms(first.fitted);
    const double won = tracing_ms(first.fitted) - tracing_ms(last.fitted);
    return fmt::format(
        "{} instead of {} costs {:.1f} ms more in rotations and {} {:.0f} ms of ray tracing (fitted): the offset {} "
        "with the filter.",
        offset_name(last.offset), offset_name(first.offset), lost, won >= 0 ? "saves" : "loses", std::abs(won),
        won > lost ? "pays" : "does not pay");
}

std::string finding_of_rotations(const std::vector<FilterRow>& rows) {
    const auto counted = each(rows, &FilterRow::rotations);
    return fmt::format("Rotations counted: {}, {} and {} for {}, {} and {}{}.", counted[0], counted[1], counted[2],
                       offset_name(rows[0].offset), offset_name(rows[1].offset), offset_name(rows[2].offset),
                       counted == std::vector<std::uint64_t>{2, 18, 34} ? ", as the paper counts them" : "");
}

std::string finding_of_best(const FilterStudy& study) {
    const auto tried = std::span(study.times).first(study.rows.back().offset + 1);
    const OffsetTime& best = least(tried, &OffsetTime::total_ms);
    return fmt::format(
        "Nothing fitted, of the offsets 0..{} p = {} takes least in all: {:.1f} ms; by ray tracing alone it would be p "
        "= {}.",
        tried.size() - 1, best.offset, best.total_ms(), least(tried, &OffsetTime::trace_ms).offset);
}

std::string finding_of_arithmetic(const FilterRow& row) {
    return fmt::format(
        "The filter's arithmetic is {:.1f} ms by the budget and {:.1f} ms fitted, where Table 3 leaves 7 ms [D]{}",
        row.plain.filter_ms, row.fitted.filter_ms,
        row.fitted.filter_ms < paper::kFilterArithmeticMs / 2
            ? ": the paper's filter takes several times what its additions do; how its program was written is not "
              "printed."
            : ".");
}

}  // namespace

StudyPage study_table3(Laboratory& lab, const Scenes& scenes) {
    const LabelledScene scene = one_of(scenes);
    const FilterStudy study = study_filter(lab, scene, lab.size(256));
    StudyPage page = page_about("table3", {{"scene", scene.label},
                                           {"size", study.size},
                                           {"pes", study.size},
                                           {"format", format_name(format_for(scene.scene))},
                                           {"factor", study.factor}});
    page.comparisons = comparisons_of(study);
    page.findings = {finding_of_offset(study.rows.front(), study.rows.back()), finding_of_rotations(study.rows),
                     finding_of_best(study)};
    if (at_papers_size(study.size)) page.findings.push_back(finding_of_arithmetic(study.rows.front()));
    page.tables = tables_of(study);
    page.plots = {offsets_plot(study, false, paper::kFilter0Ms, paper::kFilter16Ms),
                  offsets_plot(study, true, paper::kFiltered0Ms, paper::kFiltered16Ms)};
    return page;
}

}  // namespace raya
