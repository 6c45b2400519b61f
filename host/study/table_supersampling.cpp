// Table 4: what supersampling costs over the ring, p = 0, 8 and 16, in both readings: its phase alone, or with the
// first pass.
#include <cmath>

#include "host/study/ensemble.hpp"
#include "host/study/paper.hpp"
#include "host/study/prose.hpp"
#include "host/study/rows.hpp"
#include "host/study/spa_times.hpp"
#include "host/study/studies.hpp"

namespace raya {
namespace {

using Row = SmoothedOffset;

constexpr double kPrintedRatio = paper::kSupersample0Ms / paper::kSupersample16Ms;  // [D]

std::vector<Comparison> comparisons_of(const SmoothingRuns& study) {
    std::vector<Comparison> all;
    const auto paper = [&](double value) { return printed(value, study.scene.label, study.size); };
    const auto add = [&](const std::string& what, double value, double ours, const std::string& remark = "",
                         Source source = Source::kPrinted) {
        all.push_back({what, "ms", paper(value), ours, remark, source});
    };
    const auto add_row = [&](const Row& row, double communication, double computation) {
        const std::string name = row.name() + ": ";
        add(name + "communication", communication, row.communication_ms(), "the clock is made from it");
        add(name + "phase alone", computation, row.alone_ms(), "computation, comparisons included");
        add(name + "with first pass", computation, row.with_first_ms(), "computation of both passes");
    };
    add_row(study.first(), paper::kExchange0Ms, paper::kSupersample0Ms);
    add_row(study.last(), paper::kExchange16Ms, paper::kSupersample16Ms);
    const Row& middle = study.rows[1];
    add(middle.name() + ": communication", paper::kExchange8Ms, middle.communication_ms(),
        "predicted from Tables 3 and 4", Source::kDerived);
    all.push_back({"phase alone, p = 0 over p = 16", "", paper(kPrintedRatio),
                   study.first().alone_ms() / study.last().alone_ms(), "needs no clock", Source::kDerived});
    all.push_back({"with first pass, p = 0 over p = 16", "", paper(kPrintedRatio),
                   study.first().with_first_ms() / study.last().with_first_ms(), "needs no clock", Source::kDerived});
    all.push_back({"pixels recomputed", "%", paper(50 * (paper::kRecomputedLeast + paper::kRecomputedMost)),
                   100 * study.recomputed, "16 .. 18 %, if Table 4 shows the phase alone", Source::kDerived});
    return all;
}

// --- what the paper says

Claim claim_of_exchange(const SmoothingRuns& study, const std::vector<SpaRun>& filtered) {
    bool same = true;
    for (std::size_t i = 0; i < filtered.size(); ++i)
        same = same && filtered[i].communication.rotations == study.rows[i].rotations() &&
               filtered[i].communication.rotation_words == study.rows[i].run.communication.rotation_words;
    return {paper::kSpa, "section on anti-aliasing",
            "Supersampling's comparison communicates exactly as the filter does.", verdict_of(same, !same),
            finding("table4", "same",
                    "counted"_a =
                        joined(study.rows, ", ",
                               [](const Row& row) { return fmt::format("{} for {}", row.rotations(), row.name()); }),
                    "same"_a = same ? "as many, and as many words, as" : "not as many rotations or words as")};
}

Claim claim_of_gain(const SmoothingRuns& study) {
    const double alone = study.first().alone_ms() / study.last().alone_ms(),
                 both = study.first().with_first_ms() / study.last().with_first_ms();
    return {paper::kSpa, "Table 4", "p = 16 shortens the computation of supersampling.",
            verdict_of(alone > 1 && both > 1, alone <= 1 && both <= 1),
            finding("table4", "gain", "printed"_a = kPrintedRatio, "alone"_a = alone, "both"_a = both)};
}

// --- which reading

// How far two times are from the printed ones: the factor between them, up or down, in the geometric mean of both.
double mean_factor(double at0, double at16) {
    return std::exp(
        (std::abs(std::log(at0 / paper::kSupersample0Ms)) + std::abs(std::log(at16 / paper::kSupersample16Ms))) / 2);
}

std::string finding_of_reading(const SmoothingRuns& study) {
    const Row &first = study.first(), &last = study.last();
    const double alone = mean_factor(first.alone_ms(), last.alone_ms()),
                 both = mean_factor(first.with_first_ms(), last.with_first_ms());
    return finding("table4", "reading", "printed_0"_a = paper::kSupersample0Ms,
                   "printed_16"_a = paper::kSupersample16Ms, "alone_0"_a = first.alone_ms(),
                   "alone_16"_a = last.alone_ms(), "both_0"_a = first.with_first_ms(),
                   "both_16"_a = last.with_first_ms(), "nearer"_a = alone < both ? "the first" : "the second",
                   "off_alone"_a = alone, "off_both"_a = both);
}

// What speaks for one reading without any clock: in the second, the printed figures leave the supersampling of the
// busiest PE less to gain than to lose.
std::string finding_of_balance(const Row& first, const Row& last) {
    const double ours[] = {first.supersample_ms(), last.supersample_ms()};
    return finding("table4", ours[1] < ours[0] ? "balance, shorter" : "balance, longer",
                   "left_0"_a = paper::kSupersample0Ms - paper::kTrace0Ms,
                   "left_16"_a = paper::kSupersample16Ms - paper::kTrace16Ms, "ours"_a = ours[0] / ours[1]);
}

std::string finding_of_recomputed(const Row& first, const Row& last, double share) {
    const bool within = share >= paper::kRecomputedLeast && share <= paper::kRecomputedMost;
    return finding("table4", "recomputed", "share"_a = 100 * share, "where"_a = within ? "within the" : "beside",
                   "u_first"_a = first.imbalance(), "first"_a = first.name(), "u_last"_a = last.imbalance(),
                   "last"_a = last.name());
}

std::string finding_of_offset(const SmoothingRuns& study) {
    const auto saved = [&](double factor) {
        const SmoothingRuns runs = study.by_factor(factor);
        return runs.first().alone_ms() - runs.last().alone_ms();
    };
    return finding("table4", "offset", "last"_a = study.last().name(), "first"_a = study.first().name(),
                   "saved"_a = saved(machine_factor().value), "least"_a = std::min(saved(1), saved(8)),
                   "most"_a = std::max(saved(1), saved(8)),
                   "rotations"_a = study.last().communication_ms() - study.first().communication_ms());
}

std::vector<StudyTable> tables_of(const SmoothingRuns& study) {
    return {table_of("table4", "Supersampling", study.rows,
                     {{"p", &Row::offset},
                      {"rotations", &Row::rotations},
                      {"communication", &Row::communication_ms, "ms"},
                      {"comparison", &Row::compare_ms, "ms"},
                      {"supersampling", &Row::supersample_ms, "ms"},
                      {"u", &Row::imbalance},
                      {"first pass", &Row::trace_ms, "ms"},
                      {"phase alone", &Row::alone_ms, "ms"},
                      {"with first pass", &Row::with_first_ms, "ms"}}),
            table_of("table4-offsets", "Every offset", study.times(machine_factor().value),
                     {{"p", &OffsetTime::offset},
                      {"rotations", &OffsetTime::rotations},
                      {"communication", &OffsetTime::ring_ms, "ms"},
                      {"comparison", &OffsetTime::smooth_ms, "ms"},
                      {"supersampling", &OffsetTime::supersample_ms, "ms"},
                      {"first pass", &OffsetTime::trace_ms, "ms"},
                      {"total", &OffsetTime::total_ms, "ms"}},
                     false)};
}

StudyPlot plot_of(const SmoothingRuns& study) {
    StudyPlot plot{"table4", "Computation of supersampling against the offset", "offset p (pixels)",
                   "computation (modelled ms)"};
    const auto near = study.near(machine_factor().value);
    plot.series = {line("phase alone", near, &OffsetTime::offset,
                        [](const OffsetTime& t) { return t.smooth_ms + t.supersample_ms; }),
                   line("with the first pass", near, &OffsetTime::offset,
                        [](const OffsetTime& t) { return t.smooth_ms + t.supersample_ms + t.trace_ms; })};
    if (as_in_paper(study.scene.label, study.size))
        plot.series.push_back(
            {"Kohata & Ito", {0, 16}, {paper::kSupersample0Ms, paper::kSupersample16Ms}, PlotStyle::kPaper});
    return plot;
}

}  // namespace

StudyPage study_table4(Laboratory& lab, const Scenes& scenes) {
    const SmoothingRuns study = smoothing_runs(lab, scenes, AntialiasMethod::kSupersample);
    const auto filtered = each(study.rows, [&](const Row& row) {
        return run_on_spa(lab.session(), study.scene, study.size, study.size, row.offset, AntialiasMethod::kFilter);
    });
    const Row &first = study.first(), &last = study.last();
    StudyPage page = page_about("table4", {{"scene", study.scene.label},
                                           {"size", study.size},
                                           {"pes", study.size},
                                           {"format", format_name(format_for(study.scene.scene))},
                                           {"recomputed_share", study.recomputed},
                                           {"factor", machine_factor().value}});
    page.clock = clock_text();
    page.comparisons = comparisons_of(study);
    page.claims = {claim_of_exchange(study, filtered), claim_of_gain(study)};
    if (as_in_paper(study.scene.label, study.size))
        page.findings = {finding_of_reading(study), finding_of_balance(first, last)};
    page.findings.push_back(finding_of_recomputed(first, last, study.recomputed));
    page.findings.push_back(finding_of_offset(study));
    page.tables = tables_of(study);
    page.plots = {plot_of(study)};
    page.news = {sentence("table4", "news")};
    return page;
}

}  // namespace raya
