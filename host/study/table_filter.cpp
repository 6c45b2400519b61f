// Table 3: ray tracing and the 3 x 3 filter over the ring, p = 0, 8 and 16.
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

// A figure that Table 3 has, and what it has for p = 0, 8 and 16; that of p = 8 is derived.
struct Figure {
    const char* what;
    double (Row::*ours)() const;
    std::optional<double> paper[3];
    const char* remark = "";  // of p = 0 and 16
};
constexpr Figure kFigures[] = {{"ray tracing", &Row::trace_ms, {paper::kTrace0Ms, std::nullopt, paper::kTrace16Ms}},
                               {"filtering",
                                &Row::filtering_ms,
                                {paper::kFilter0Ms, paper::kFilter8Ms, paper::kFilter16Ms},
                                "the clock is made from it"},
                               {"total", &Row::filtered_ms, {paper::kFiltered0Ms, std::nullopt, paper::kFiltered16Ms}}};

// What one factor makes of the study's conclusions.
struct AtFactor {
    double factor;
    double total_0, total_16, saved, lost;  // ms; won by p = 16 in ray tracing, lost in rotations
    std::uint32_t best;                     // of 0..16, in all

    double gain() const { return total_0 / total_16; }
    const char* pays() const { return saved > lost ? "yes" : "no"; }
};

AtFactor at_factor(const SmoothingRuns& study, double factor) {
    const SmoothingRuns runs = study.by_factor(factor);
    const Row &first = runs.first(), &last = runs.last();
    return {factor,
            first.filtered_ms(),
            last.filtered_ms(),
            first.trace_ms() - last.trace_ms(),
            last.filtering_ms() - first.filtering_ms(),
            least(study.near(factor), &OffsetTime::total_ms).offset};
}

std::vector<AtFactor> sensitivity_of(const SmoothingRuns& study) {
    auto rows = each(kFactors, [&](double factor) { return at_factor(study, factor); });
    rows.push_back(at_factor(study, machine_factor().value));
    std::ranges::sort(rows, {}, &AtFactor::factor);
    return rows;
}

std::vector<Comparison> comparisons_of(const SmoothingRuns& study) {
    const auto paper = [&](std::optional<double> value) { return printed(value, study.scene.label, study.size); };
    std::vector<Comparison> all;
    for (std::size_t i = 0; i < study.rows.size(); ++i)
        for (const Figure& figure : kFigures)
            all.push_back({study.rows[i].name() + ": " + figure.what, "ms", paper(figure.paper[i]),
                           (study.rows[i].*figure.ours)(),
                           i != 1            ? figure.remark
                           : figure.paper[i] ? "predicted from Table 3"
                                             : "",
                           i == 1 ? Source::kDerived : Source::kPrinted});
    all.push_back({"filter's arithmetic", "ms", paper(paper::kFilterArithmeticMs), study.first().filter_ms(),
                   "the clock's factor is taken from it", Source::kDerived});
    all.push_back({"exchange's set-up", "ms", std::nullopt, paper::kExchangeSetupMs,
                   "of Table 4, 2 - 2 x 0.3125 ms; within the filtering"});
    all.push_back({"total, p = 0 over p = 16", "", paper(paper::kFiltered0Ms / paper::kFiltered16Ms),
                   study.first().filtered_ms() / study.last().filtered_ms(), "needs the clock little",
                   Source::kDerived});
    return all;
}

Claim claim_of_rotations(const std::vector<Row>& rows) {
    const bool same = std::ranges::all_of(rows, [](const Row& row) { return row.rotations() == 2 * (row.offset + 1); });
    return {paper::kSpa, "section on anti-aliasing",
            "The filter takes p + 1 rotations to the left and p + 1 to the right.", verdict_of(same, !same),
            finding("table3", "rotations", "counted"_a = joined(rows, ", ", [](const Row& row) {
                                               return fmt::format("{} for {}", row.rotations(), row.name());
                                           }))};
}

Claim claim_of_total(const std::vector<AtFactor>& factors) {
    constexpr double kTwice = 2;
    const auto gains = each(factors, &AtFactor::gain);
    return {paper::kSpa, "Table 3", "Filter included, p = 16 is more than twice as fast in total as p = 0.",
            verdict_of(std::ranges::min(gains) > kTwice, std::ranges::max(gains) <= kTwice),
            finding("table3", "total", "printed"_a = paper::kFiltered0Ms / paper::kFiltered16Ms,
                    "least"_a = std::ranges::min(gains), "most"_a = std::ranges::max(gains))};
}

Claim claim_of_neighbours(const SmoothingRuns& study) {
    const auto near = study.near(machine_factor().value);
    const bool rises = std::ranges::is_sorted(near, {}, &OffsetTime::ring_ms);
    return {paper::kSpa, "section on the cyclic mapping", "For communication with neighbours a small p is better.",
            verdict_of(rises, !rises),
            finding("table3", "neighbours", "first"_a = near.front().ring_ms, "last"_a = near.back().ring_ms,
                    "most"_a = near.back().offset)};
}

std::string finding_of_filter(const SmoothingRuns& study, const std::vector<AtFactor>& factors) {
    const AtFactor at = at_factor(study, machine_factor().value);
    const auto pays = [](const AtFactor& row) { return row.saved > row.lost; };
    const bool always = std::ranges::all_of(factors, pays), never = std::ranges::none_of(factors, pays);
    return finding("table3", "offset", "last"_a = study.last().name(), "first"_a = study.first().name(),
                   "lost"_a = at.lost, "saves"_a = at.saved >= 0 ? "saves" : "loses", "won"_a = std::abs(at.saved),
                   "pays"_a = at.saved > at.lost ? "pays" : "does not pay",
                   "factors"_a = always  ? "for every factor of 1 to 8"
                                 : never ? "for no factor of 1 to 8"
                                         : "for some factors of 1 to 8");
}

std::string finding_of_best(const SmoothingRuns& study, const std::vector<AtFactor>& factors) {
    const double factor = machine_factor().value;
    const auto near = study.near(factor);
    const OffsetTime& best = least(near, &OffsetTime::total_ms);
    return finding("table3", "best", "most"_a = near.size() - 1, "best"_a = best.offset, "time"_a = best.total_ms(),
                   "alone"_a = least(near, &OffsetTime::trace_ms).offset,
                   "all"_a = joined(distinct(factors, &AtFactor::best), ", ", [](std::uint32_t p) { return p; }));
}

std::vector<StudyTable> tables_of(const SmoothingRuns& study, const std::vector<AtFactor>& factors) {
    return {table_of("table3", "Ray tracing and filter", study.rows,
                     {{"p", &Row::offset},
                      {"rotations", &Row::rotations},
                      {"communication", &Row::communication_ms, "ms"},
                      {"filter", &Row::filter_ms, "ms"},
                      {"ray tracing", &Row::trace_ms, "ms"},
                      {"total", &Row::filtered_ms, "ms"}}),
            table_of("table3-factors", "The conclusions by the clock's factor", factors,
                     {{"factor", &AtFactor::factor},
                      {"total, p = 0", &AtFactor::total_0, "ms"},
                      {"total, p = 16", &AtFactor::total_16, "ms"},
                      {"p = 0 over p = 16", &AtFactor::gain},
                      {"p = 16 saves", &AtFactor::saved, "ms"},
                      {"and costs", &AtFactor::lost, "ms"},
                      {"pays", &AtFactor::pays},
                      {"best of 0..16", &AtFactor::best}}),
            table_of("table3-offsets", "Every offset", study.times(machine_factor().value),
                     {{"p", &OffsetTime::offset},
                      {"rotations", &OffsetTime::rotations},
                      {"communication", &OffsetTime::ring_ms, "ms"},
                      {"filter", &OffsetTime::smooth_ms, "ms"},
                      {"ray tracing", &OffsetTime::trace_ms, "ms"},
                      {"total", &OffsetTime::total_ms, "ms"}},
                     false)};
}

StudyPlot plot_of(const SmoothingRuns& study, bool with_tracing) {
    StudyPlot plot{with_tracing ? "table3-total" : "table3-filter",
                   with_tracing ? "Ray tracing and filter against the offset" : "Filtering against the offset",
                   "offset p (pixels)", "time (modelled ms)"};
    const MachineFactor machine = machine_factor();
    for (const double factor : {1.0, machine.value, 8.0})
        plot.series.push_back(
            line(factor == machine.value ? "the clock's factor" : fmt::format("factor {:.0f}", factor),
                 study.near(factor), &OffsetTime::offset,
                 [&](const OffsetTime& t) { return t.ring_ms + t.smooth_ms + (with_tracing ? t.trace_ms : 0); }));
    const std::vector<double> y = with_tracing ? std::vector{paper::kFiltered0Ms, paper::kFiltered16Ms}
                                               : std::vector{paper::kFilter0Ms, paper::kFilter16Ms};
    if (as_in_paper(study.scene.label, study.size))
        plot.series.push_back({"Kohata & Ito", {0, 16}, y, PlotStyle::kPaper});
    return plot;
}

}  // namespace

StudyPage study_table3(Laboratory& lab, const Scenes& scenes) {
    const SmoothingRuns study = smoothing_runs(lab, scenes, AntialiasMethod::kFilter);
    const auto factors = sensitivity_of(study);
    StudyPage page = page_about("table3", {{"scene", study.scene.label},
                                           {"size", study.size},
                                           {"pes", study.size},
                                           {"format", format_name(format_for(study.scene.scene))},
                                           {"factor", machine_factor().value}});
    page.clock = clock_text();
    page.comparisons = comparisons_of(study);
    page.claims = {claim_of_total(factors), claim_of_rotations(study.rows), claim_of_neighbours(study)};
    page.findings = {finding_of_filter(study, factors), finding_of_best(study, factors),
                     sentence("table3", "arithmetic")};
    page.tables = tables_of(study, factors);
    page.plots = {plot_of(study, false), plot_of(study, true)};
    page.news = {sentence("table3", "news")};
    return page;
}

}  // namespace raya
