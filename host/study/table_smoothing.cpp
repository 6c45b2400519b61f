// Tables 3 and 4: what the 3 x 3 filter and supersampling cost over the ring, p = 0, 8 and 16. Supersampling in both
// readings of Table 4: its phase alone, or with the first pass.
#include <cmath>
#include <span>

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

using Row = SmoothedOffset;

// Every offset: `columns` between the rotations and the total.
StudyTable offsets_table(const std::string& name, const SmoothingRuns& study, std::vector<Column<OffsetTime>> columns) {
    columns.insert(columns.begin(), {{"p", &OffsetTime::offset},
                                     {"rotations", &OffsetTime::rotations},
                                     {"communication", &OffsetTime::ring_ms, "ms"}});
    columns.push_back({"total", &OffsetTime::total_ms, "ms"});
    return table_of(name + "-offsets", "Every offset, nothing fitted", study.times, columns, false);
}

StudyPage page_of(const std::string& name, const SmoothingRuns& study, std::optional<double> recomputed = {}) {
    Json settings = {{"scene", study.scene.label},
                     {"size", study.size},
                     {"pes", study.size},
                     {"format", format_name(format_for(study.scene.scene))}};
    if (recomputed) settings["recomputed_share"] = *recomputed;
    settings["factor"] = study.factor;
    return page_about(name, settings);
}

// --- Table 3

// A figure that Table 3 has, and what it has for p = 0, 8 and 16.
struct Figure {
    const char* what;
    double (*ours)(const ModelledTime&);
    std::optional<double> paper[3];
};
constexpr Figure kFigures[] = {{"ray tracing", tracing_ms, {paper::kTrace0Ms, std::nullopt, paper::kTrace16Ms}},
                               {"filtering", filtering_ms, {paper::kFilter0Ms, paper::kFilter8Ms, paper::kFilter16Ms}},
                               {"total", total_ms, {paper::kFiltered0Ms, std::nullopt, paper::kFiltered16Ms}}};

std::vector<Comparison> filter_comparisons(const SmoothingRuns& study) {
    std::vector<Comparison> all;
    for (std::size_t i = 0; i < study.rows.size(); ++i)
        for (const Figure& figure : kFigures)
            for (const bool fitted : {false, true}) {
                const Row& row = study.rows[i];
                all.push_back({row.name() + ": " + figure.what + (fitted ? ", fitted" : ""), "ms",
                               printed(figure.paper[i], study.scene.label, study.size),
                               figure.ours(fitted ? row.fitted : row.plain),
                               i == 1 && figure.paper[i] ? "[D] predicted from Table 3, not printed" : ""});
            }
    const std::optional<double> arithmetic = printed(paper::kFilterArithmeticMs, study.scene.label, study.size);
    const Row& first = study.first();
    all.push_back({"filter's arithmetic", "ms", arithmetic, first.plain.filter_ms, "[D]; nothing fitted"});
    all.push_back({"filter's arithmetic, fitted", "ms", arithmetic, first.fitted.filter_ms, "[D]"});
    all.push_back({"factor", "", std::nullopt, study.factor, "Table 2's"});
    return all;
}

std::vector<StudyTable> filter_tables(const SmoothingRuns& study) {
    const auto plain = [](auto figure) { return [=](const Row& row) { return std::invoke(figure, row.plain); }; };
    const auto fitted = [](auto figure) { return [=](const Row& row) { return std::invoke(figure, row.fitted); }; };
    return {table_of("table3", "Ray tracing and filter, modelled", study.rows,
                     {{"p", &Row::offset},
                      {"rotations", &Row::rotations},
                      {"communication", &Row::communication_ms, "ms"},
                      {"filter", plain(&ModelledTime::filter_ms), "ms"},
                      {"filter, fitted", fitted(&ModelledTime::filter_ms), "ms"},
                      {"ray tracing", plain(tracing_ms), "ms"},
                      {"ray tracing, fitted", fitted(tracing_ms), "ms"},
                      {"total", plain(total_ms), "ms"},
                      {"total, fitted", fitted(total_ms), "ms"}}),
            offsets_table("table3", study,
                          {{"filter", &OffsetTime::smooth_ms, "ms"}, {"ray tracing", &OffsetTime::trace_ms, "ms"}})};
}

StudyPlot filter_plot(const SmoothingRuns& study, bool with_tracing, double paper0, double paper16) {
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
    if (as_in_paper(study.scene.label, study.size))
        plot.series.push_back({"paper", {0, 16}, {paper0, paper16}, PlotStyle::kPaper});
    return plot;
}

std::string finding_of_filter(const Row& first, const Row& last) {
    const double lost = filtering_ms(last.fitted) - filtering_ms(first.fitted);
    const double won = tracing_ms(first.fitted) - tracing_ms(last.fitted);
    return finding("table3", "offset", "last"_a = last.name(), "first"_a = first.name(), "lost"_a = lost,
                   "saves"_a = won >= 0 ? "saves" : "loses", "won"_a = std::abs(won),
                   "pays"_a = won > lost ? "pays" : "does not pay");
}

std::string finding_of_rotations(const std::vector<Row>& rows) {
    const auto counted = each(rows, &Row::rotations);
    const bool as_printed = counted == std::vector<std::uint64_t>{2, 18, 34};
    return finding("table3", "rotations", "a"_a = counted[0], "b"_a = counted[1], "c"_a = counted[2],
                   "of_a"_a = rows[0].name(), "of_b"_a = rows[1].name(), "of_c"_a = rows[2].name(),
                   "verdict"_a = as_printed ? ", as the paper counts them" : "");
}

std::string finding_of_best(const SmoothingRuns& study) {
    const auto tried = std::span(study.times).first(study.last().offset + 1);
    const OffsetTime& best = least(tried, &OffsetTime::total_ms);
    return finding("table3", "best", "most"_a = tried.size() - 1, "best"_a = best.offset, "time"_a = best.total_ms(),
                   "alone"_a = least(tried, &OffsetTime::trace_ms).offset);
}

std::string finding_of_arithmetic(const Row& row) {
    const bool more = row.fitted.filter_ms < paper::kFilterArithmeticMs / 2;
    return finding("table3", more ? "arithmetic, more" : "arithmetic", "plain"_a = row.plain.filter_ms,
                   "fitted"_a = row.fitted.filter_ms);
}

// --- Table 4

std::vector<Comparison> supersample_comparisons(const SmoothingRuns& study) {
    std::vector<Comparison> all;
    const auto add = [&](const std::string& what, double value, double ours, const std::string& remark = "") {
        all.push_back({what, "ms", printed(value, study.scene.label, study.size), ours, remark});
    };
    const auto add_row = [&](const Row& row, double communication, double computation) {
        const std::string name = row.name() + ": ";
        const double f = study.factor, total = communication + computation;
        add(name + "communication", communication, row.communication_ms());
        add(name + "phase alone", computation, row.alone_ms(), "computation, comparisons included");
        add(name + "phase alone, fitted", computation, f * row.alone_ms(), "computation");
        add(name + "with first pass", computation, row.with_first_ms(), "computation of both passes");
        add(name + "with first pass, fitted", computation, f * row.with_first_ms(), "computation of both passes");
        add(name + "total, phase alone, fitted", total, row.communication_ms() + f * row.alone_ms());
        add(name + "total, with first pass, fitted", total, row.communication_ms() + f * row.with_first_ms());
    };
    add_row(study.first(), paper::kExchange0Ms, paper::kSupersample0Ms);
    add_row(study.last(), paper::kExchange16Ms, paper::kSupersample16Ms);
    const Row& middle = study.rows[1];
    add(middle.name() + ": communication", paper::kExchange8Ms, middle.communication_ms(),
        "[D] predicted from Tables 3 and 4, not printed");
    all.push_back({"pixels recomputed", "%",
                   printed(50 * (paper::kRecomputedLeast + paper::kRecomputedMost), study.scene.label, study.size),
                   100 * study.recomputed, "[D] 16-18 %, if Table 4 shows the phase alone"});
    add("supersampling, mean of all PEs, fitted", paper::kMeanSupersampleMs, study.factor * spa_ms(middle.again.mean),
        "[D] if Table 4 shows the phase alone");
    all.push_back({"factor", "", std::nullopt, study.factor, "Table 2's"});
    return all;
}

std::vector<StudyTable> supersample_tables(const SmoothingRuns& study) {
    return {table_of("table4", "Supersampling, modelled, nothing fitted", study.rows,
                     {{"p", &Row::offset},
                      {"rotations", &Row::rotations},
                      {"communication", &Row::communication_ms, "ms"},
                      {"comparison", &Row::compare_ms, "ms"},
                      {"supersampling", &Row::supersample_ms, "ms"},
                      {"u", &Row::imbalance},
                      {"first pass", &Row::trace_ms, "ms"},
                      {"phase alone", &Row::alone_ms, "ms"},
                      {"with first pass", &Row::with_first_ms, "ms"}}),
            offsets_table("table4", study,
                          {{"comparison", &OffsetTime::smooth_ms, "ms"},
                           {"supersampling", &OffsetTime::supersample_ms, "ms"},
                           {"first pass", &OffsetTime::trace_ms, "ms"}})};
}

StudyPlot supersample_plot(const SmoothingRuns& study) {
    StudyPlot plot{
        "table4", fmt::format("Computation of supersampling against the offset, times the factor {:.2f}", study.factor),
        "offset p (pixels)", "computation (modelled ms)"};
    plot.series = {line("phase alone", study.near(), &OffsetTime::offset,
                        [&](const OffsetTime& t) { return study.factor * (t.smooth_ms + t.supersample_ms); }),
                   line("with the first pass", study.near(), &OffsetTime::offset, [&](const OffsetTime& t) {
                       return study.factor * (t.smooth_ms + t.supersample_ms + t.trace_ms);
                   })};
    if (as_in_paper(study.scene.label, study.size))
        plot.series.push_back({"paper", {0, 16}, {paper::kSupersample0Ms, paper::kSupersample16Ms}, PlotStyle::kPaper});
    return plot;
}

// How far two times are from the printed ones: the mean factor between them.
double distance(double at0, double at16) {
    return std::exp(
        (std::abs(std::log(at0 / paper::kSupersample0Ms)) + std::abs(std::log(at16 / paper::kSupersample16Ms))) / 2);
}

std::string nearer(const Row& first, const Row& last, double factor) {
    const double alone[] = {factor * first.alone_ms(), factor * last.alone_ms()};
    const double both[] = {factor * first.with_first_ms(), factor * last.with_first_ms()};
    const double off_alone = distance(alone[0], alone[1]), off_both = distance(both[0], both[1]);
    return finding("table4", "nearer", "alone_0"_a = alone[0], "alone_16"_a = alone[1], "both_0"_a = both[0],
                   "both_16"_a = both[1], "nearer"_a = off_alone < off_both ? "the first" : "the second",
                   "off_alone"_a = off_alone, "off_both"_a = off_both);
}

std::string finding_of_reading(const Row& first, const Row& last, double factor) {
    return finding("table4", "reading", "printed_0"_a = paper::kSupersample0Ms,
                   "printed_16"_a = paper::kSupersample16Ms, "fitted"_a = nearer(first, last, factor),
                   "plain"_a = nearer(first, last, 1));
}

// What speaks for one reading without any factor: in the second, the printed figures leave the supersampling of the
// busiest PE less to gain than to lose.
std::string finding_of_balance(const Row& first, const Row& last) {
    const double ours[] = {first.supersample_ms(), last.supersample_ms()};
    return finding("table4", ours[1] < ours[0] ? "balance, shorter" : "balance, longer",
                   "left_0"_a = paper::kSupersample0Ms - paper::kTrace0Ms,
                   "left_16"_a = paper::kSupersample16Ms - paper::kTrace16Ms, "ours_0"_a = ours[0],
                   "ours_16"_a = ours[1]);
}

std::string finding_of_exchange(const Row& first, const Row& last) {
    const double at_0 = paper::kExchange0Ms - first.communication_ms();
    const double at_16 = paper::kExchange16Ms - last.communication_ms();
    constexpr double kPrintedTo = 0.5;  // ms: the tables hold whole ones
    const bool fixed = std::abs(at_0 - at_16) <= 2 * kPrintedTo && at_0 > kPrintedTo;
    return finding("table4", fixed ? "exchange, fixed" : "exchange", "lack_0"_a = at_0, "lack_16"_a = at_16);
}

std::string finding_of_recomputed(const Row& first, const Row& last, double share) {
    const bool within = share >= paper::kRecomputedLeast && share <= paper::kRecomputedMost;
    return finding("table4", "recomputed", "share"_a = 100 * share, "where"_a = within ? "within the" : "beside",
                   "u_first"_a = first.imbalance(), "first"_a = first.name(), "u_last"_a = last.imbalance(),
                   "last"_a = last.name());
}

std::string finding_of_offset(const Row& first, const Row& last, double factor) {
    const double saved = factor * (first.alone_ms() - last.alone_ms());
    return finding("table4", "offset", "last"_a = last.name(), "first"_a = first.name(),
                   "saves"_a = saved >= 0 ? "saves" : "loses", "saved"_a = std::abs(saved),
                   "rotations"_a = last.communication_ms() - first.communication_ms());
}

}  // namespace

StudyPage study_table3(Laboratory& lab, const Scenes& scenes) {
    const SmoothingRuns study = smoothing_runs(lab, scenes, AntialiasMethod::kFilter);
    StudyPage page = page_of("table3", study);
    page.comparisons = filter_comparisons(study);
    page.findings = {finding_of_filter(study.first(), study.last()), finding_of_rotations(study.rows),
                     finding_of_best(study)};
    if (as_in_paper(study.scene.label, study.size)) page.findings.push_back(finding_of_arithmetic(study.first()));
    page.tables = filter_tables(study);
    page.plots = {filter_plot(study, false, paper::kFilter0Ms, paper::kFilter16Ms),
                  filter_plot(study, true, paper::kFiltered0Ms, paper::kFiltered16Ms)};
    return page;
}

StudyPage study_table4(Laboratory& lab, const Scenes& scenes) {
    const SmoothingRuns study = smoothing_runs(lab, scenes, AntialiasMethod::kSupersample);
    const Row &first = study.first(), &last = study.last();
    StudyPage page = page_of("table4", study, study.recomputed);
    page.comparisons = supersample_comparisons(study);
    if (as_in_paper(study.scene.label, study.size))
        page.findings = {finding_of_reading(first, last, study.factor), finding_of_balance(first, last),
                         finding_of_exchange(first, last)};
    page.findings.push_back(finding_of_recomputed(first, last, study.recomputed));
    page.findings.push_back(finding_of_offset(first, last, study.factor));
    page.tables = supersample_tables(study);
    page.plots = {supersample_plot(study)};
    return page;
}

}  // namespace raya
