// Fig. 9: speed-up against the number of PEs, column split and cyclic mapping, and 2-D interleaving beside them.
#include <cmath>

#include "host/ring/schedule.hpp"
#include "host/study/arrays.hpp"
#include "host/study/ensemble.hpp"
#include "host/study/paper.hpp"
#include "host/study/prose.hpp"
#include "host/study/rows.hpp"
#include "host/study/speedups.hpp"
#include "host/study/studies.hpp"

namespace raya {
namespace {

auto efficiency(double Speedups::*speedup) {
    return [=](const Speedups& row) { return row.*speedup / row.pes; };
}

// A x A PEs in each view, and how many times faster they are than half as many a side.
std::vector<double> grids_of(const std::vector<SpeedupRows>& views, std::size_t a) {
    return each(views, [&](const SpeedupRows& rows) { return on(rows, a * a).grid; });
}
std::vector<double> ratios_of(const std::vector<SpeedupRows>& views, std::size_t a) {
    return each(views, [&](const SpeedupRows& rows) { return on(rows, a * a).grid / on(rows, a * a / 4).grid; });
}

// The largest A of A x A PEs that can be halved.
std::size_t largest_grid(const SpeedupRows& rows) { return where(rows, &Speedups::is_square).size() / 2 * 2; }

constexpr std::uint32_t kOffset = 16;  // the paper's for 256 PEs

std::vector<StudyPlot> plots_of(const std::string& scene, const SpeedupRows& rows,
                                const std::vector<SpeedupMeans>& means) {
    const double w = rows.back().pes;
    const SpeedupRows squares = where(rows, &Speedups::is_square);
    StudyPlot speedup{"fig9", "Speed-up against the number of PEs, cyclic fold", "PEs", "speed-up"};
    speedup.series = {line("ideal", rows, &Speedups::pes, &Speedups::pes),
                      line("p = 16", rows, &Speedups::pes, &Speedups::cyclic),
                      line("p = round(sqrt(P))", rows, &Speedups::pes, &Speedups::root),
                      line("p = 0, column split", rows, &Speedups::pes, &Speedups::columns),
                      line("2-D, A x A PEs", squares, &Speedups::pes, &Speedups::grid, PlotStyle::kPoints)};
    if (as_in_paper(scene, rows.back().pes)) {
        speedup.series.push_back(
            {"Kohata & Ito, p = 0 and 16", {w, w}, {paper::kSpeedup0, paper::kSpeedup16}, PlotStyle::kPaper});
        speedup.series.push_back(
            {"Pixel Machine, its own scene, 60 or more", {64}, {paper::kPixelMachineSpeedup}, PlotStyle::kPaper});
    }
    const auto some =
        where(means, [&](const SpeedupMeans& row) { return row.pes % 8 == 0 || row.pes == means.size(); });
    StudyPlot views{"fig9-views", "Speed-up against the number of PEs, mean of the views", "PEs", "speed-up"};
    views.series = {line_with_bars("p = 16", some, &SpeedupMeans::pes, &SpeedupMeans::cyclic),
                    line_with_bars("p = round(sqrt(P))", some, &SpeedupMeans::pes, &SpeedupMeans::root),
                    line_with_bars("p = 0, column split", some, &SpeedupMeans::pes, &SpeedupMeans::columns)};
    StudyPlot folds{"fig9-folds", "Efficiency against the number of PEs, both folds", "PEs", "efficiency"};
    folds.series = {line("p = 16, cyclic fold", rows, &Speedups::pes, efficiency(&Speedups::cyclic)),
                    line("p = 16, block fold", rows, &Speedups::pes, efficiency(&Speedups::cyclic_block)),
                    line("p = 0, cyclic fold", rows, &Speedups::pes, efficiency(&Speedups::columns)),
                    line("p = 0, block fold", rows, &Speedups::pes, efficiency(&Speedups::columns_block)),
                    line("2-D, A x A PEs", squares, &Speedups::pes, efficiency(&Speedups::grid), PlotStyle::kPoints)};
    return {speedup, views, folds};
}

StudyTable table_of_sides(const std::vector<SizedSpeedup>& sides) {
    return table_of("fig9-sizes", "One PE to one for each column, cyclic fold, one picture of each size", sides,
                    {{"side", &SizedSpeedup::side, "pixels"},
                     {"P", &SizedSpeedup::pes},
                     {"p = 0", &SizedSpeedup::columns},
                     {"p = 16", &SizedSpeedup::cyclic},
                     {"p = round(sqrt(P))", &SizedSpeedup::root},
                     {"its efficiency", &SizedSpeedup::efficiency}});
}

std::vector<StudyTable> tables_of(const SpeedupRows& rows, const std::vector<SpeedupMeans>& means) {
    const auto shown = [](std::uint32_t pes) { return pes > 1 && ((pes & (pes - 1)) == 0 || pes % 100 == 0); };
    const auto mean = [](Estimate SpeedupMeans::*of) {
        return [=](const SpeedupMeans& row) { return (row.*of).mean; };
    };
    const auto half = [](Estimate SpeedupMeans::*of) {
        return [=](const SpeedupMeans& row) { return (row.*of).half_width; };
    };
    return {
        table_of("fig9-squares", "Speed-up of the picture on square numbers of PEs and powers of two, cyclic fold",
                 where(rows, [&](const Speedups& row) { return (row.is_square() && row.pes > 1) || shown(row.pes); }),
                 {{"P", &Speedups::pes},
                  {"A x A, 2-D", [](const Speedups& row) { return row.is_square() ? Cell(row.grid) : Cell("-"); }},
                  {"p = 0", &Speedups::columns},
                  {"p = 16", &Speedups::cyclic},
                  {"p = sqrt(P)", &Speedups::root}}),
        table_of("fig9-views", "Speed-up, mean of the views", means,
                 {{"P", &SpeedupMeans::pes},
                  {"p = 0", mean(&SpeedupMeans::columns)},
                  {"p = 0, +-", half(&SpeedupMeans::columns)},
                  {"p = 16", mean(&SpeedupMeans::cyclic)},
                  {"p = 16, +-", half(&SpeedupMeans::cyclic)},
                  {"p = round(sqrt(P))", mean(&SpeedupMeans::root)},
                  {"p = round(sqrt(P)), +-", half(&SpeedupMeans::root)}},
                 false),
        table_of("fig9", "Speed-up of the picture for each number of PEs", rows,
                 {{"P", &Speedups::pes},
                  {"p = 0, cyclic fold", &Speedups::columns},
                  {"p = 0, block fold", &Speedups::columns_block},
                  {"p = 16, cyclic fold", &Speedups::cyclic},
                  {"p = 16, block fold", &Speedups::cyclic_block},
                  {"p = round(sqrt(P)), cyclic fold", &Speedups::root},
                  {"p = round(sqrt(P)), block fold", &Speedups::root_block}},
                 false)};
}

std::vector<Comparison> comparisons_of(const std::string& scene, const SpeedupRows& rows,
                                       const std::vector<SpeedupRows>& views, const SpeedupMeans& mean) {
    const Speedups& all = rows.back();
    const auto paper = [&](double value) { return printed(value, scene, all.pes); };
    const std::size_t more = largest_grid(rows), fewer = more / 2;
    const Estimate ratio = estimate_of(ratios_of(views, more)), grid = estimate_of(grids_of(views, fewer));
    const std::string pes = fmt::format("speed-up on {} PEs, ", all.pes), of_views = ", mean of views";
    return {{pes + "p = 16", "", paper(paper::kSpeedup16), all.cyclic, "the paper's stands in its abstracts"},
            {pes + "p = 16" + of_views, "", paper(paper::kSpeedup16), mean.cyclic.mean, "", Source::kPrinted,
             mean.cyclic.half_width},
            {pes + "p = 0", "", paper(paper::kSpeedup0), all.columns, "centre at 256 x 256 is calibrated on its u(0)",
             Source::kDerived},
            {pes + "p = 0" + of_views, "", paper(paper::kSpeedup0), mean.columns.mean, "", Source::kDerived,
             mean.columns.half_width},
            {fmt::format("CAP's mapping, {0} x {0} PEs over {1} x {1}", more, fewer), "", paper(paper::kCapRatio),
             on(rows, more * more).grid / on(rows, fewer * fewer).grid,
             "the paper's from the makers of CAP, who had another scene"},
            {"... mean of views", "", paper(paper::kCapRatio), ratio.mean, "", Source::kPrinted, ratio.half_width},
            {fmt::format("Pixel Machine's mapping, {0} x {0} PEs", fewer), "", paper(paper::kPixelMachineSpeedup),
             on(rows, fewer * fewer).grid, "the paper: 60 or more, from the makers, who had another scene"},
            {"... mean of views ", "", paper(paper::kPixelMachineSpeedup), grid.mean, "", Source::kPrinted,
             grid.half_width}};
}

// What Fig. 9 draws: p = 16 above p = 0, on the powers of two on which they are not the same mapping.
Claim claim_of_curves(const std::vector<SpeedupRows>& views) {
    std::vector<std::uint32_t> pes;
    for (std::uint32_t p = 2 * kOffset; p <= views.front().size(); p *= 2) pes.push_back(p);
    const auto gains = each(pes, [&](std::uint32_t p) {
        return mean_of_each(
            views, [&](const SpeedupRows& rows) { return on(rows, p).cyclic - on(rows, p).columns; },
            each_of(pes.size()));
    });
    std::size_t number = 0;
    return {paper::kSpa, "Fig. 9", "With p = 16 the speed-up is above that with p = 0.",
            verdict_of(std::ranges::all_of(gains, [](const Estimate& gain) { return gain.low() > 0; }),
                       std::ranges::any_of(gains, [](const Estimate& gain) { return gain.high() <= 0; })),
            finding("fig9", "curves", "gains"_a = joined(gains, ", ", [&](const Estimate& gain) {
                                          return fmt::format("{} on {} PEs", with_interval(gain, 1), pes[number++]);
                                      }))};
}

// Beside the paper's own case alone: 256 PEs, views of its scene.
std::vector<Claim> claims_of(const std::vector<SpeedupRows>& views) {
    constexpr std::size_t kCap = 16, kPixelMachine = 8;  // PEs a side
    const auto speedups = each(views, [](const SpeedupRows& rows) { return rows.back().cyclic; });
    const auto columns = each(views, [](const SpeedupRows& rows) { return rows.back().columns; });
    const auto ratios = ratios_of(views, kCap), grids = grids_of(views, kPixelMachine);
    const Estimate grid = estimate_of(grids);
    const auto why = [&](const std::vector<double>& values, const char* what) {
        return fmt::format("{} {} in the mean of {} views; another picture's lies in {} with 95 %.", what,
                           with_interval(estimate_of(values), 2), values.size(), prediction_text(values, 2));
    };
    return {{paper::kSpa, "abstract", "256 PEs compute 229 times faster than one with p = 16.",
             verdict_among(paper::kSpeedup16, speedups), why(speedups, "Ours is")},
            {paper::kSpa, "Table 3", "256 PEs compute 99.2 times faster than one with p = 0 (derived).",
             verdict_among(paper::kSpeedup0, columns), why(columns, "Ours is")},
            claim_of_curves(views),
            {paper::kSpa, "beside Fig. 9", "256 PEs of CAP are 3.86 times faster than 64, by its makers.",
             verdict_among(paper::kCapRatio, ratios), why(ratios, "CAP's mapping on our scene gives")},
            {paper::kSpa, "beside Fig. 9",
             "64 nodes of the Pixel Machine are 60 times faster than one or more, by its makers.",
             verdict_of(grid.low() >= paper::kPixelMachineSpeedup, grid.high() < paper::kPixelMachineSpeedup),
             why(grids, "The Pixel Machine's mapping on our scene gives")}};
}

std::string finding_of_sides(const std::vector<SizedSpeedup>& sides) {
    const SizedSpeedup& worst = least(sides, &SizedSpeedup::efficiency);
    return finding(
        "fig9", "sizes",
        "sides"_a = joined(distinct(sides, &SizedSpeedup::side), ", ", [](std::uint32_t side) { return side; }),
        "speedups"_a =
            joined(where(sides, [](const SizedSpeedup& side) { return side.pes == side.side; }), ", ",
                   [](const SizedSpeedup& side) { return fmt::format("{:.0f} times on {} PEs", side.root, side.pes); }),
        "least"_a = worst.efficiency(), "pes"_a = worst.pes, "side"_a = worst.side);
}

double mean_efficiency(const SpeedupRows& rows, double Speedups::*speedup) {
    double sum = 0;
    for (const Speedups& row : rows) sum += row.*speedup / row.pes;
    return sum / static_cast<double>(rows.size());
}

std::string finding_of_whole(const std::string& scene, const Speedups& all) {
    std::string text =
        fmt::format("On {} PEs p = 16 gives {:.1f} times and p = 0 {:.1f} times", all.pes, all.cyclic, all.columns);
    if (!as_in_paper(scene, all.pes)) return text + ".";
    const double ratio = all.cyclic / paper::kSpeedup16;
    const char* verdict = ratio > 1.02 ? "more than" : ratio < 0.98 ? "less than" : "within 2 % of";
    return text + fmt::format("; the former is {} the {:.0f} of Kohata & Ito's abstract.", verdict, paper::kSpeedup16);
}

// Between W / 2 and W PEs some PE has two columns.
std::string finding_of_stairs(const SpeedupRows& rows) {
    const std::size_t w = rows.size(), half = w / 2;
    const auto best = std::max_element(rows.begin() + half, rows.end() - 1,
                                       [](const Speedups& a, const Speedups& b) { return a.cyclic < b.cyclic; });
    const double gain = 100 * (best->cyclic / on(rows, half).cyclic - 1);
    const Speedups square = where(std::span(rows).first(w - 1), &Speedups::is_square).back();
    const std::uint32_t side = root_offset(square.pes);
    return fmt::format(
        "Whole columns make stairs: with {} to {} PEs some PE still has two of the {}, and p = 16 gains {} over {} "
        "PEs; on {} PEs it gives {:.1f} times, {} x {} PEs in two dimensions {:.1f} times.",
        half + 1, w - 1, w, gain > 0.5 ? fmt::format("at most {:.1f} %", gain) : "nothing", half, square.pes,
        square.cyclic, side, side, square.grid);
}

std::string finding_of_folds(const SpeedupRows& rows) {
    const double c0 = mean_efficiency(rows, &Speedups::columns), b0 = mean_efficiency(rows, &Speedups::columns_block);
    const double c16 = mean_efficiency(rows, &Speedups::cyclic), b16 = mean_efficiency(rows, &Speedups::cyclic_block);
    const auto better = [](double c, double b) {
        return c > b ? "the cyclic fold" : b > c ? "the block fold" : "none";
    };
    return fmt::format(
        "Mean efficiency over all P: column split {:.3f} with the cyclic fold and {:.3f} with the block fold, p = 16 "
        "{:.3f} and {:.3f}; the better fold is {} for the column split and {} for p = 16.",
        c0, b0, c16, b16, better(c0, b0), better(c16, b16));
}

std::string finding_of_offset(const SpeedupRows& rows) {
    const SpeedupRows idle = where(rows, [](const Speedups& row) { return row.pes > 1 && row.cyclic == row.columns; });
    std::string text = fmt::format(
        "p = round(sqrt(P)) is better than p = 16 for {} of {} numbers of PEs, mean efficiency {:.3f} against {:.3f}",
        std::ranges::count_if(rows, [](const Speedups& row) { return row.pes > 1 && row.root > row.cyclic; }),
        rows.size() - 1, mean_efficiency(rows, &Speedups::root), mean_efficiency(rows, &Speedups::cyclic));
    if (idle.empty()) return text + ".";
    return text +
           fmt::format("; p = 16 gives the same as the column split for P = {}.", joined(idle, ", ", &Speedups::pes));
}

}  // namespace

StudyPage speedup_page(const std::string& scene, const CostImage& image, const std::vector<const CostImage*>& others,
                       const std::vector<const CostImage*>& sizes) {
    const SpeedupRows rows = speedups_of(image);
    auto views = each(others, [](const CostImage* one) { return speedups_of(*one); });
    if (views.empty()) views.push_back(rows);
    const auto means = means_of(views);
    StudyPage page = page_about("fig9", {{"scene", scene},
                                         {"size", image.width},
                                         {"pes", image.width},
                                         {"offset", kOffset % image.width},
                                         {"views", others.size()},
                                         {"view_seeds", fmt::format("1..{}", others.size())}});
    page.comparisons = comparisons_of(scene, rows, views, means.back());
    if (as_in_paper(scene, image.width) && !others.empty()) page.claims = claims_of(views);
    page.findings = {finding_of_whole(scene, rows.back()), finding_of_stairs(rows), finding_of_folds(rows),
                     finding_of_offset(rows)};
    page.tables = tables_of(rows, means);
    page.plots = plots_of(scene, rows, means);
    page.news = {sentence("fig9", "news")};
    if (sizes.empty()) return page;
    const auto sides = speedups_of_sizes(sizes);
    page.findings.insert(page.findings.begin() + 1, finding_of_sides(sides));
    page.tables.push_back(table_of_sides(sides));
    return page;
}

StudyPage study_fig9(Laboratory& lab, const Scenes& scenes) {
    const LabelledScene scene = one_of(scenes);
    const std::uint32_t size = lab.size(256);
    const Ensemble ensemble = ensemble_of(lab, scene, size);
    std::vector<const CostImage*> sizes = {&ensemble.picture->trace};
    if (size == 256)
        for (const std::uint32_t side : {512u, 1024u}) sizes.push_back(&lab.costs(scene, side).trace);
    return speedup_page(scene.label, ensemble.picture->trace,
                        each(ensemble.views, [](const Costs* costs) { return &costs->trace; }), sizes);
}

}  // namespace raya
