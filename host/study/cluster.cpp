// Scenes as heavy and as uneven as Kohata & Ito's: what they take on the one clock, beside Tables 2, 3 and 4.
#include "host/ring/schedule.hpp"
#include "host/scene/generate.hpp"
#include "host/study/arrays.hpp"
#include "host/study/ensemble.hpp"
#include "host/study/paper.hpp"
#include "host/study/prose.hpp"
#include "host/study/rows.hpp"
#include "host/study/spa_times.hpp"
#include "host/study/studies.hpp"

namespace raya {
namespace {

// One scene; times in milliseconds on the clock, of the busiest PE.
struct Member {
    std::string scene;
    double u_0, u_16, recomputed, cycles;  // recomputed: % of the pixels; budget cycles a pixel
    double one_pe, trace_0, trace_16, filtered_0, filtered_16, again_0, again_16;

    double gain() const { return filtered_0 / filtered_16; }
    double speedup() const { return one_pe / trace_16; }
};

Member member_of(Laboratory& lab, const LabelledScene& scene, std::uint32_t size) {
    const Costs& costs = lab.costs(scene, size, AntialiasMethod::kSupersample);
    const double factor = machine_factor().value, pixels = static_cast<double>(size) * size;
    const auto filtered = offset_times(costs, size, AntialiasMethod::kFilter, factor),
               again = offset_times(costs, size, AntialiasMethod::kSupersample, factor);
    const std::uint32_t far = 16 % size;
    const auto phase = [&](std::uint32_t p) { return again[p].smooth_ms + again[p].supersample_ms; };
    const auto total = static_cast<double>(total_cycles(costs.trace));
    return {.scene = scene.label,
            .u_0 = filtered[0].imbalance,
            .u_16 = filtered[far].imbalance,
            .recomputed = 100 * static_cast<double>(costs.recomputed) / pixels,
            .cycles = total / pixels,
            .one_pe = factor * spa_ms(total),
            .trace_0 = filtered[0].trace_ms,
            .trace_16 = filtered[far].trace_ms,
            .filtered_0 = filtered[0].total_ms(),
            .filtered_16 = filtered[far].total_ms(),
            .again_0 = phase(0),
            .again_16 = phase(far)};
}

// A figure of the members beside one of the paper: those that the family was searched for, then those left free.
template <class Of>
struct Figure {
    const char *what, *unit;
    Of of;
    double paper;
    Source source;
    const char* place;
};
using MemberFigure = double (*)(const Member&);

constexpr Figure<MemberFigure> kSought[] = {
    {"u(0)", "", [](const Member& m) { return m.u_0; }, paper::kImbalance0, Source::kDerived, "Table 3"},
    {"pixels recomputed", "%", [](const Member& m) { return m.recomputed; },
     50 * (paper::kRecomputedLeast + paper::kRecomputedMost), Source::kDerived, "Table 4"},
    {"1 PE: compute", "ms", [](const Member& m) { return m.one_pe; }, paper::kOnePeComputeMs, Source::kPrinted,
     "Table 2"},
};

constexpr Figure<MemberFigure> kFree[] = {
    {"u(16)", "", [](const Member& m) { return m.u_16; }, paper::kImbalance16, Source::kDerived, "Table 3"},
    {"speed-up, p = 16", "", [](const Member& m) { return m.speedup(); }, paper::kSpeedup16, Source::kPrinted,
     "abstract"},
    {"ray tracing, p = 16", "ms", [](const Member& m) { return m.trace_16; }, paper::kTrace16Ms, Source::kPrinted,
     "Table 3"},
    {"with the filter, p = 0", "ms", [](const Member& m) { return m.filtered_0; }, paper::kFiltered0Ms,
     Source::kPrinted, "Table 3"},
    {"with the filter, p = 16", "ms", [](const Member& m) { return m.filtered_16; }, paper::kFiltered16Ms,
     Source::kPrinted, "Table 3"},
    {"total, p = 0 over p = 16", "", [](const Member& m) { return m.gain(); },
     paper::kFiltered0Ms / paper::kFiltered16Ms, Source::kDerived, "Table 3"},
    {"supersampling alone, p = 0", "ms", [](const Member& m) { return m.again_0; }, paper::kSupersample0Ms,
     Source::kPrinted, "Table 4"},
    {"supersampling alone, p = 16", "ms", [](const Member& m) { return m.again_16; }, paper::kSupersample16Ms,
     Source::kPrinted, "Table 4"},
};

using Members = std::vector<Member>;

Comparison comparison_of(const Members& members, const Figure<MemberFigure>& figure, bool beside, const char* remark) {
    const Estimate mean = mean_of_each(members, figure.of);
    return {figure.what,
            figure.unit,
            beside ? std::optional(figure.paper) : std::nullopt,
            mean.mean,
            fmt::format("{}; {} of single scenes", remark, range_text(each(members, figure.of))),
            figure.source,
            mean.half_width};
}

Claim claim_of(const Members& members, const Figure<MemberFigure>& figure) {
    const auto values = each(members, figure.of);
    const int digits = figure.paper < 10 ? 3 : 0;
    return {
        paper::kSpa, figure.place,
        fmt::format("{}: {:.{}f}{}{}.", figure.what, figure.paper, digits, *figure.unit ? " " : "", figure.unit),
        verdict_among(figure.paper, values),
        finding("cluster", "among", "scenes"_a = values.size(), "mean"_a = with_interval(estimate_of(values), digits),
                "prediction"_a = prediction_text(values, digits))};
}

StudyTable table_of_members(const Members& members) {
    return table_of("cluster", "Each scene", members,
                    {{"scene", &Member::scene},
                     {"u(0)", &Member::u_0},
                     {"u(16)", &Member::u_16},
                     {"recomputed", &Member::recomputed, "%"},
                     {"cycles a pixel", &Member::cycles},
                     {"1 PE: compute", &Member::one_pe, "ms"},
                     {"ray tracing, p = 0", &Member::trace_0, "ms"},
                     {"ray tracing, p = 16", &Member::trace_16, "ms"},
                     {"with the filter, p = 0", &Member::filtered_0, "ms"},
                     {"with the filter, p = 16", &Member::filtered_16, "ms"},
                     {"supersampling alone, p = 0", &Member::again_0, "ms"},
                     {"supersampling alone, p = 16", &Member::again_16, "ms"}},
                    false);
}

StudyPlot plot_of(const Members& members, bool beside) {
    StudyPlot plot{"cluster", "Imbalance of each scene, column split and cyclic mapping", "u(0)", "u(16)"};
    plot.series = {line("scenes", members, &Member::u_0, &Member::u_16, PlotStyle::kPoints)};
    if (beside)
        plot.series.push_back(
            {"Kohata & Ito, from their tables", {paper::kImbalance0}, {paper::kImbalance16}, PlotStyle::kPaper});
    return plot;
}

Scenes family() {
    Scenes scenes;
    for (std::uint64_t seed = 1; seed <= kMostViews; ++seed)
        scenes.push_back({fmt::format("cluster, seed {}", seed), generate_cluster(seed)});
    return scenes;
}

}  // namespace

StudyPage study_cluster(Laboratory& lab, const Scenes& given) {
    const std::uint32_t size = lab.size(256);
    const Members members =
        each(given.empty() ? family() : given, [&](const LabelledScene& scene) { return member_of(lab, scene, size); });
    const bool beside = given.empty() && size == 256;
    const std::string seeds = fmt::format("1..{}", kMostViews);
    Json settings = {{"scenes", members.size()}, {"size", size}, {"pes", size}, {"factor", machine_factor().value}};
    if (given.empty()) settings["seeds"] = seeds;
    StudyPage page = page_about("cluster", settings, {{"seeds", seeds}});
    page.clock = clock_text();
    for (const auto& figure : kSought)
        page.comparisons.push_back(comparison_of(members, figure, beside, given.empty() ? "sought" : "as it is"));
    for (const auto& figure : kFree)
        page.comparisons.push_back(comparison_of(members, figure, beside, given.empty() ? "free" : "as it is"));
    if (beside)
        for (const auto& figure : kFree) page.claims.push_back(claim_of(members, figure));
    page.findings = {finding("cluster", "free", "scenes"_a = members.size(),
                             "u_16"_a = with_interval(mean_of_each(members, &Member::u_16)),
                             "range"_a = range_text(each(members, &Member::u_16)),
                             "gain"_a = with_interval(mean_of_each(members, &Member::gain), 2))};
    page.tables = {table_of_members(members)};
    page.plots = {plot_of(members, beside)};
    page.news = {sentence("cluster", "news")};
    return page;
}

}  // namespace raya
