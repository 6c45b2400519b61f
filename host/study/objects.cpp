// Fig. 4: 64 transputers, 64 to 8320 objects. Is random slower than even, is it for the copies, and why does time grow
// less than the objects do?
#include "host/study/ensemble.hpp"
#include "host/study/objects_findings.hpp"
#include "host/study/prose.hpp"
#include "host/study/rows.hpp"
#include "host/study/studies.hpp"

namespace raya {
namespace {

using Rows = ObjectsRows;
using Row = ObjectsRow;
using Ratio = ObjectsRatio;
using Ratios = ObjectsRatios;

Cell half_width(const Estimate& e) { return e.has_interval() ? Cell(e.half_width) : Cell("-"); }

Column<Row> mean(const char* label, auto figure, const char* unit = "") {
    return {label, [=](const Row& row) { return row.of(figure).mean; }, unit};
}

StudyTable table_of_rows(const Rows& rows) {
    return table_of("objects", "Time and work for each number of objects", rows,
                    {{"objects", &Row::objects},
                     {"kind", &Row::kind},
                     {"protocol", &Row::protocol},
                     {"scenes", [](const Row& row) { return row.runs.size(); }},
                     mean("copies", &TorusRun::copies),
                     mean("tests a ray", &TorusRun::tests_per_ray),
                     mean("steps a ray", &TorusRun::steps_per_ray),
                     mean("returns", &TorusRun::returns),
                     mean("rays thrown away", &TorusRun::discarded),
                     mean("u", &TorusRun::imbalance),
                     mean("overlapped", &TorusRun::overlapped_ms, "ms"),
                     {"overlapped +-", [](const Row& row) { return half_width(row.overlapped()); }, "ms"},
                     mean("stepwise", &TorusRun::stepwise_ms, "ms"),
                     {"stepwise +-", [](const Row& row) { return half_width(row.stepwise()); }, "ms"},
                     mean("asynchronous", &TorusRun::asynchronous_ms, "ms"),
                     {"asynchronous +-", [](const Row& row) { return half_width(row.asynchronous()); }, "ms"},
                     mean("busiest node computes", &TorusRun::compute_ms, "ms"),
                     mean("the root alone", &TorusRun::root_ms, "ms")});
}

std::vector<StudyTable> tables_of(const ObjectsRuns& all, const Ratios& ratios, const std::vector<GrowthRow>& growth) {
    const auto factor = [](const char* label, double Growth::*figure) {
        return Column<GrowthRow>{label, [=](const GrowthRow& row) { return row.mean(figure); }};
    };
    return {
        table_of_rows(all.rows),
        table_of("objects-ratios", "Random over even", ratios,
                 {{"objects", &Ratio::objects},
                  {"kind", &Ratio::kind},
                  {"protocol", &Ratio::protocol},
                  {"overlapped", [](const Ratio& one) { return one.overlapped.mean; }},
                  {"overlapped +-", [](const Ratio& one) { return half_width(one.overlapped); }},
                  {"stepwise", [](const Ratio& one) { return one.stepwise.mean; }},
                  {"stepwise +-", [](const Ratio& one) { return half_width(one.stepwise); }},
                  {"asynchronous", [](const Ratio& one) { return one.asynchronous.mean; }},
                  {"asynchronous +-", [](const Ratio& one) { return half_width(one.asynchronous); }}}),
        table_of("objects-growth", "Why time grows less than the objects: objects / time as a product", growth,
                 {{"kind", &GrowthRow::kind},
                  {"protocol", &GrowthRow::protocol},
                  factor("objects", &Growth::objects),
                  factor("time", &Growth::time),
                  {"objects / time", [](const GrowthRow& row) { return row.of(&Growth::sublinearity).mean; }},
                  {"+-", [](const GrowthRow& row) { return half_width(row.of(&Growth::sublinearity)); }},
                  factor("fewer voxels a ray", &Growth::depth),
                  factor("tests a voxel grow less", &Growth::lists),
                  factor("fixed costs", &Growth::fixed),
                  factor("one node's bound", &Growth::bound)}),
        table_of(
            "objects-primary", "How deep primary rays go", all.primary,
            {{"objects", &PrimaryRow::objects},
             {"kind", &PrimaryRow::kind},
             {"hit", [](const PrimaryRow& row) { return 100 * estimate_of(row.hit_shares).mean; }, "% of primary rays"},
             {"end in the first voxel", [](const PrimaryRow& row) { return 100 * row.first_share(); },
              "% of those in the box"},
             {"voxels a ray in the box", &PrimaryRow::steps}}),
        table_of("objects-words", "Larger ray packets, from the root, a return for each ray, even scenes", all.words,
                 {{"objects", &WordsRow::objects},
                  {"words a ray", &WordsRow::words},
                  {"overlapped", &WordsRow::overlapped_ms, "ms"},
                  {"stepwise", &WordsRow::stepwise_ms, "ms"}})};
}

StudyPlot time_plot(const Rows& rows, const char* protocol, const char* name, const char* title,
                    Estimate (Row::*time)() const) {
    StudyPlot plot{name, title, "objects", "modelled ms", Axes::kLogBoth};
    for (const char* kind : {kEven, kRandom, kWithin})
        plot.series.push_back(line_with_bars(kind, of(rows, kind, protocol), &Row::objects, time));
    const Rows even = of(rows, kEven, protocol);
    const double first = (even.front().*time)().mean;
    plot.series.push_back(line("as the objects, from the even scene's first", even, &Row::objects,
                               [&](const Row& row) { return first * row.objects / even.front().objects; }));
    return plot;
}

std::vector<StudyPlot> plots_of(const ObjectsRuns& all, const Ratios& ratios) {
    StudyPlot ratio{"objects-ratios", "Random over even, without supersteps", "objects", "times as long", Axes::kLogX};
    for (const char* protocol : {kPaperProtocol, kOwnProtocol})
        for (const char* kind : {kRandom, kWithin})
            ratio.series.push_back(line_with_bars(fmt::format("{}, protocol: {}", kind, protocol),
                                                  of(ratios, kind, protocol), &Ratio::objects, &Ratio::asynchronous));
    StudyPlot depth{"objects-depth", "How deep primary rays go", "objects", "voxels a ray in the box", Axes::kLogX};
    for (const std::string kind : {kEven, kRandom})
        depth.series.push_back(
            line_with_bars(kind, where(all.primary, [&](const PrimaryRow& row) { return row.kind == kind; }),
                           &PrimaryRow::objects, [](const PrimaryRow& row) { return estimate_of(row.voxels); }));
    return {time_plot(all.rows, kPaperProtocol, "objects-async",
                      "Time by the protocol of Yoshitani & Yamazaki, without supersteps", &Row::asynchronous),
            time_plot(all.rows, kPaperProtocol, "objects", "Time by the protocol of Yoshitani & Yamazaki, overlapped",
                      &Row::overlapped),
            time_plot(all.rows, kPaperProtocol, "objects-stepwise",
                      "Time by the protocol of Yoshitani & Yamazaki, stepwise", &Row::stepwise),
            time_plot(all.rows, kOwnProtocol, "objects-raya", "Time by raya's protocol, overlapped", &Row::overlapped),
            ratio,
            depth};
}

}  // namespace

StudyPage objects_page(const ObjectsRuns& all, std::uint32_t size) {
    const Ratios ratios = ratios_of(all.rows);
    const std::vector<GrowthRow> growth = growth_rows(all.rows);
    StudyPage page = page_about("objects", {{"nodes", "4x4x4"},
                                            {"voxels", "4x4x4"},
                                            {"links", "torus2d"},
                                            {"size", size},
                                            {"bounces", 0},
                                            {"format", "fp32"},
                                            {"words", paper::kRayWords},
                                            {"seeds", of(all.rows, kRandom, kPaperProtocol).front().runs.size()},
                                            {"objects", distinct(all.rows, &Row::objects)}});
    page.clock = sentence("torus", "clock");
    page.claims = objects_claims(ratios, growth);
    page.findings = objects_findings(all, ratios, growth);
    page.tables = tables_of(all, ratios, growth);
    page.plots = plots_of(all, ratios);
    page.news = {sentence("objects", "news")};
    return page;
}

StudyPage study_objects(Laboratory& lab, const Scenes& scenes) {
    constexpr int kSeeds = 5;
    const std::uint32_t size = lab.size(96);
    StudyPage page = objects_page(run_objects(lab.session(), {64, 192, 256, 512, 1024, 8320}, size, kSeeds), size);
    if (!scenes.empty()) page.method.push_back(sentence("objects", "named scenes"));
    return page;
}

}  // namespace raya
