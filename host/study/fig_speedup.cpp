// Fig. 9: speed-up against the number of PEs, column split and cyclic mapping, and 2-D interleaving beside them.
#include <cmath>

#include "host/ring/schedule.hpp"
#include "host/study/arrays.hpp"
#include "host/study/paper.hpp"
#include "host/study/prose.hpp"
#include "host/study/rows.hpp"
#include "host/study/studies.hpp"

namespace raya {
namespace {

constexpr std::uint32_t kOffset = 16;  // the paper's for 256 PEs

// Speed-ups of one number of PEs.
struct Row {
    std::uint32_t pes = 0;
    double columns = 0, columns_block = 0;  // p = 0, folds cyclic and block
    double cyclic = 0, cyclic_block = 0;    // p = 16
    double root = 0, root_block = 0;        // p = round(sqrt(P))
    double grid = 0;                        // A x A; 0 where P is no square
};
using Rows = std::vector<Row>;  // of 1, 2, .. W PEs

const Row& on(const Rows& rows, std::size_t pes) { return rows[pes - 1]; }

auto efficiency(double Row::*speedup) {
    return [=](const Row& row) { return row.*speedup / row.pes; };
}

// The loads of a PE for each slot, as an image of one row: with no more PEs than slots every PE has whole ones.
CostImage slots_of(const CostImage& image, std::uint32_t offset) {
    return {image.width, 1, static_load(image, cyclic(image.width, image.height, image.width, offset)).per_pe};
}

double speedup_of(const CostImage& slots, std::uint32_t pes, Fold fold) {
    return static_load(slots, cyclic(slots.width, 1, pes, 0, fold)).speedup;
}

Rows rows_of(const CostImage& image) {
    const std::uint32_t w = image.width;
    const CostImage columns = slots_of(image, 0), shifted = slots_of(image, kOffset % w);
    CostImage root;
    Rows rows;
    for (std::uint32_t pes = 1; pes <= w; ++pes) {
        const std::uint32_t a = root_offset(pes);
        if (pes == 1 || a != root_offset(pes - 1)) root = slots_of(image, a);
        rows.push_back({pes, speedup_of(columns, pes, Fold::kCyclic), speedup_of(columns, pes, Fold::kBlock),
                        speedup_of(shifted, pes, Fold::kCyclic), speedup_of(shifted, pes, Fold::kBlock),
                        speedup_of(root, pes, Fold::kCyclic), speedup_of(root, pes, Fold::kBlock),
                        a * a == pes ? static_load(image, squarest_grid(w, image.height, pes)).speedup : 0});
    }
    return rows;
}

bool is_square(const Row& row) { return row.grid > 0; }

std::vector<StudyPlot> plots_of(const std::string& scene, const Rows& rows) {
    const double w = rows.back().pes;
    const Rows squares = where(rows, is_square);
    StudyPlot speedup{"fig9", "Speed-up against the number of PEs, cyclic fold", "PEs", "speed-up"};
    speedup.series = {line("ideal", rows, &Row::pes, &Row::pes), line("p = 16", rows, &Row::pes, &Row::cyclic),
                      line("p = round(sqrt(P))", rows, &Row::pes, &Row::root),
                      line("p = 0, column split", rows, &Row::pes, &Row::columns),
                      line("2-D, A x A PEs", squares, &Row::pes, &Row::grid, PlotStyle::kPoints)};
    if (as_in_paper(scene, rows.back().pes)) {
        speedup.series.push_back(
            {"paper, p = 0 and 16", {w, w}, {paper::kSpeedup0, paper::kSpeedup16}, PlotStyle::kPaper});
        speedup.series.push_back(
            {"Pixel Machine, its own scene, 60 or more", {64}, {paper::kPixelMachineSpeedup}, PlotStyle::kPaper});
    }
    StudyPlot folds{"fig9-folds", "Efficiency against the number of PEs, both folds", "PEs", "efficiency"};
    folds.series = {line("p = 16, cyclic fold", rows, &Row::pes, efficiency(&Row::cyclic)),
                    line("p = 16, block fold", rows, &Row::pes, efficiency(&Row::cyclic_block)),
                    line("p = 0, cyclic fold", rows, &Row::pes, efficiency(&Row::columns)),
                    line("p = 0, block fold", rows, &Row::pes, efficiency(&Row::columns_block)),
                    line("2-D, A x A PEs", squares, &Row::pes, efficiency(&Row::grid), PlotStyle::kPoints)};
    return {speedup, folds};
}

std::vector<StudyTable> tables_of(const Rows& rows) {
    return {table_of("fig9-squares", "Speed-up on square numbers of PEs, cyclic fold",
                     where(rows, [](const Row& row) { return is_square(row) && row.pes > 1; }),
                     {{"P", &Row::pes},
                      {"A x A, 2-D", &Row::grid},
                      {"p = 0", &Row::columns},
                      {"p = 16", &Row::cyclic},
                      {"p = sqrt(P)", &Row::root}}),
            table_of("fig9", "Speed-up for each number of PEs", rows,
                     {{"P", &Row::pes},
                      {"p = 0, cyclic fold", &Row::columns},
                      {"p = 0, block fold", &Row::columns_block},
                      {"p = 16, cyclic fold", &Row::cyclic},
                      {"p = 16, block fold", &Row::cyclic_block},
                      {"p = round(sqrt(P)), cyclic fold", &Row::root},
                      {"p = round(sqrt(P)), block fold", &Row::root_block}},
                     false)};
}

std::vector<Comparison> comparisons_of(const std::string& scene, const Rows& rows) {
    const Row& all = rows.back();
    const auto paper = [&](double value) { return printed(value, scene, all.pes); };
    const std::size_t squares = where(rows, is_square).size();
    const std::size_t more = squares / 2 * 2, fewer = more / 2;  // A of four times as many PEs, and of fewer
    const double most = on(rows, more * more).grid, fewest = on(rows, fewer * fewer).grid;
    return {{fmt::format("speed-up on {} PEs, p = 16", all.pes), "", paper(paper::kSpeedup16), all.cyclic},
            {fmt::format("speed-up on {} PEs, p = 0", all.pes), "", paper(paper::kSpeedup0), all.columns,
             "the paper's from its tables; centre at 256 x 256 is calibrated on its u(0)"},
            {fmt::format("CAP's mapping, {0} x {0} PEs over {1} x {1}", more, fewer), "", paper(paper::kCapRatio),
             most / fewest, "the paper's from the makers of CAP, who had another scene"},
            {fmt::format("Pixel Machine's mapping, {0} x {0} PEs", fewer), "", paper(paper::kPixelMachineSpeedup),
             fewest, "the paper: 60 or more, from the makers, who had another scene"}};
}

double mean_efficiency(const Rows& rows, double Row::*speedup) {
    double sum = 0;
    for (const Row& row : rows) sum += row.*speedup / row.pes;
    return sum / static_cast<double>(rows.size());
}

std::string finding_of_whole(const std::string& scene, const Row& all) {
    std::string text =
        fmt::format("On {} PEs p = 16 gives {:.1f} times and p = 0 {:.1f} times", all.pes, all.cyclic, all.columns);
    if (!as_in_paper(scene, all.pes)) return text + ".";
    const double ratio = all.cyclic / paper::kSpeedup16;
    const char* verdict = ratio > 1.02 ? "more than" : ratio < 0.98 ? "less than" : "within 2 % of";
    return text + fmt::format("; the former is {} the paper's {:.0f}.", verdict, paper::kSpeedup16);
}

// Between W / 2 and W PEs some PE has two columns.
std::string finding_of_stairs(const Rows& rows) {
    const std::size_t w = rows.size(), half = w / 2;
    const auto best = std::max_element(rows.begin() + half, rows.end() - 1,
                                       [](const Row& a, const Row& b) { return a.cyclic < b.cyclic; });
    const double gain = 100 * (best->cyclic / on(rows, half).cyclic - 1);
    const Row square = where(std::span(rows).first(w - 1), is_square).back();
    const std::uint32_t side = root_offset(square.pes);
    return fmt::format(
        "Whole columns make stairs: with {} to {} PEs some PE still has two of the {}, and p = 16 gains {} over {} "
        "PEs; on {} PEs it gives {:.1f} times, {} x {} PEs in two dimensions {:.1f} times.",
        half + 1, w - 1, w, gain > 0.5 ? fmt::format("at most {:.1f} %", gain) : "nothing", half, square.pes,
        square.cyclic, side, side, square.grid);
}

std::string finding_of_folds(const Rows& rows) {
    const double c0 = mean_efficiency(rows, &Row::columns), b0 = mean_efficiency(rows, &Row::columns_block);
    const double c16 = mean_efficiency(rows, &Row::cyclic), b16 = mean_efficiency(rows, &Row::cyclic_block);
    const auto better = [](double c, double b) {
        return c > b ? "the cyclic fold" : b > c ? "the block fold" : "none";
    };
    return fmt::format(
        "Mean efficiency over all P: column split {:.3f} with the cyclic fold and {:.3f} with the block fold, p = 16 "
        "{:.3f} and {:.3f}; the better fold is {} for the column split and {} for p = 16.",
        c0, b0, c16, b16, better(c0, b0), better(c16, b16));
}

std::string finding_of_offset(const Rows& rows) {
    const Rows idle = where(rows, [](const Row& row) { return row.pes > 1 && row.cyclic == row.columns; });
    std::string text = fmt::format(
        "p = round(sqrt(P)) is better than p = 16 for {} of {} numbers of PEs, mean efficiency {:.3f} against {:.3f}",
        std::ranges::count_if(rows, [](const Row& row) { return row.pes > 1 && row.root > row.cyclic; }),
        rows.size() - 1, mean_efficiency(rows, &Row::root), mean_efficiency(rows, &Row::cyclic));
    if (idle.empty()) return text + ".";
    return text + fmt::format("; p = 16 gives the same as the column split for P = {}.", joined(idle, ", ", &Row::pes));
}

}  // namespace

StudyPage speedup_page(const std::string& scene, const CostImage& image) {
    const Rows rows = rows_of(image);
    StudyPage page = page_about(
        "fig9", {{"scene", scene}, {"size", image.width}, {"pes", image.width}, {"offset", kOffset % image.width}});
    page.comparisons = comparisons_of(scene, rows);
    page.findings = {finding_of_whole(scene, rows.back()), finding_of_stairs(rows), finding_of_folds(rows),
                     finding_of_offset(rows)};
    page.tables = tables_of(rows);
    page.plots = plots_of(scene, rows);
    return page;
}

StudyPage study_fig9(Laboratory& lab, const Scenes& scenes) {
    const LabelledScene scene = one_of(scenes);
    return speedup_page(scene.label, lab.costs(scene, lab.size(256)).trace);
}

}  // namespace raya
