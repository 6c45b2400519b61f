// Static mappings on 16 to 1,048,576 PEs: where does each fall under half, and does it take 2-D beyond a PE a column?
#include <array>
#include <cmath>
#include <span>

#include "host/ring/schedule.hpp"
#include "host/study/arrays.hpp"
#include "host/study/ensemble.hpp"
#include "host/study/paper.hpp"
#include "host/study/prose.hpp"
#include "host/study/rows.hpp"
#include "host/study/studies.hpp"

namespace raya {
namespace {

constexpr std::uint32_t kOffset = 16;
constexpr double kHalf = 0.5;   // the efficiency under which a mapping has fallen
constexpr double kClose = 0.9;  // of the 2-D mapping's efficiency: a mapping that keeps up

// The cyclic fold and others that know no fold, then the block fold.
enum Way { kFixed, kRoot, kLike, kColumns, kGrid, kRandom, kFixedBlock, kRootBlock, kLikeBlock, kColumnsBlock, kWays };
constexpr const char* kLabels[kWays] = {"p = 16",
                                        "p = sqrt(P)",
                                        "p = sqrt(P) or W / sqrt(P)",
                                        "column split",
                                        "2-D, A x B PEs",
                                        "random",
                                        "p = 16, block fold",
                                        "p = sqrt(P), block fold",
                                        "p = sqrt(P) or W / sqrt(P), block fold",
                                        "column split, block fold"};

// Efficiencies on one number of PEs.
struct Row {
    std::uint32_t pes;
    double bound;  // no distribution of whole pixels does better
    std::array<double, kWays> of;

    bool keeps_up(int way) const { return of[way] >= kClose * of[kGrid]; }
};
using Rows = std::vector<Row>;

auto efficiency(int way) {
    return [way](const Row& row) { return row.of[way]; };
}

// p of a cyclic mapping, rounded. Where P > W the PEs of a slot take its rows in turn, so the rows of a PE are P / W
// apart; the next of its pixels lies sqrt(W W / P) to the side, a square's side, for p = W / sqrt(P).
std::uint32_t offset_of(int way, std::uint32_t side, std::uint32_t pes) {
    const double root = std::sqrt(pes);
    const auto rounded = [&](double p) { return static_cast<std::uint32_t>(std::lround(p)) % side; };
    if (way == kFixed || way == kFixedBlock) return kOffset % side;
    if (way == kRoot || way == kRootBlock) return rounded(root);
    if (way == kLike || way == kLikeBlock) return rounded(std::min(root, side / root));
    return 0;
}

raya_mapping mapping_of(int way, std::uint32_t side, std::uint32_t pes) {
    if (way == kGrid) return squarest_grid(side, side, pes);
    if (way == kRandom) return random_pixels(side, side, pes);
    return cyclic(side, side, pes, offset_of(way, side, pes), way >= kFixedBlock ? Fold::kBlock : Fold::kCyclic);
}

Rows rows_of(const CostImage& image) {
    const auto total = static_cast<double>(total_cycles(image));
    Rows rows;
    for (std::uint32_t pes = 16; pes <= image.width * image.width; pes *= 2) {
        rows.push_back({pes, total / static_cast<double>(lower_bound(image, pes)) / pes, {}});
        for (int way = 0; way < kWays; ++way)
            rows.back().of[way] = static_load(image, mapping_of(way, image.width, pes)).efficiency;
    }
    return rows;
}

// Of one number of PEs in many pictures: the efficiency of each mapping, and that over the 2-D mapping's.
struct MeanRow {
    std::uint32_t pes;
    Estimate bound;
    std::array<Estimate, kWays> of, beside_2d;
};

std::vector<MeanRow> means_of(const std::vector<Rows>& pictures) {
    std::vector<MeanRow> means;
    for (std::size_t n = 0; n < pictures.front().size(); ++n) {
        MeanRow mean{
            pictures.front()[n].pes, mean_of_each(pictures, [n](const Rows& rows) { return rows[n].bound; }), {}, {}};
        for (int way = 0; way < kWays; ++way) {
            mean.of[way] = mean_of_each(pictures, [=](const Rows& rows) { return rows[n].of[way]; });
            mean.beside_2d[way] =
                mean_of_each(pictures, [=](const Rows& rows) { return rows[n].of[way] / rows[n].of[kGrid]; });
        }
        means.push_back(mean);
    }
    return means;
}

// The last P up to which the efficiency has been kHalf or more, and the speed-up there; 0: never.
struct Half {
    std::string label;
    std::uint32_t pes = 0;
    double speedup = 0;

    template <class Efficiency>
    Half(const char* name, const Rows& rows, Efficiency efficiency) : label(name) {
        for (const Row& row : rows) {
            if (std::invoke(efficiency, row) < kHalf) break;
            pes = row.pes;
            speedup = std::invoke(efficiency, row) * row.pes;
        }
    }
};

std::vector<Half> halves_of(const Rows& rows) {
    std::vector<Half> all = {{"upper bound", rows, &Row::bound}};
    for (int way = 0; way < kWays; ++way) all.emplace_back(kLabels[way], rows, efficiency(way));
    return all;
}

std::vector<StudyPlot> plots_of(const Rows& rows) {
    StudyPlot plain{"scale", "Efficiency against the number of PEs, cyclic fold", "PEs", "efficiency", Axes::kLogX};
    StudyPlot folds{"scale-folds", "Efficiency against the number of PEs, both folds", "PEs", "efficiency",
                    Axes::kLogX};
    StudyPlot speedup{"scale-speedup", "Speed-up against the number of PEs, cyclic fold", "PEs", "speed-up",
                      Axes::kLogBoth};
    const auto times_pes = [](auto figure) {
        return [=](const Row& row) { return std::invoke(figure, row) * row.pes; };
    };
    plain.series = {line("upper bound", rows, &Row::pes, &Row::bound)};
    speedup.series = {line("upper bound", rows, &Row::pes, times_pes(&Row::bound))};
    for (int way = 0; way < kFixedBlock; ++way) {
        plain.series.push_back(line(kLabels[way], rows, &Row::pes, efficiency(way)));
        speedup.series.push_back(line(kLabels[way], rows, &Row::pes, times_pes(efficiency(way))));
    }
    for (const int way : {kFixed, kFixedBlock, kLike, kLikeBlock, kColumns, kColumnsBlock})
        folds.series.push_back(line(kLabels[way], rows, &Row::pes, efficiency(way)));
    return {plain, folds, speedup};
}

std::vector<StudyTable> tables_of(const Rows& rows) {
    std::vector<Column<Row>> columns = {{"P", &Row::pes}, {"upper bound", &Row::bound}};
    for (int way = 0; way < kWays; ++way) columns.push_back({kLabels[way], efficiency(way)});
    return {
        table_of("scale-half", "Where each falls under an efficiency of 50 %", halves_of(rows),
                 {{"mapping", &Half::label}, {"50 % or more up to P", &Half::pes}, {"speed-up there", &Half::speedup}}),
        table_of("scale", "Efficiency for each number of PEs", rows, columns)};
}

std::string finding_of_half(const Rows& rows) {
    const std::vector<Half> halves = halves_of(rows);
    return fmt::format(
        "PEs up to which half of the array's power or more is used: {}; whole pixels, however given out: {}.",
        joined(std::span(halves).subspan(1, kFixedBlock), "; ",
               [](const Half& half) {
                   return fmt::format("{}: {}", half.label, half.pes > 0 ? std::to_string(half.pes) : "none");
               }),
        halves.front().pes);
}

// `between`: more PEs than one a column, fewer than one a pixel.
std::string finding_of_2d(const Rows& between) {
    const auto kept = [&](int way) { return where(between, [&](const Row& row) { return row.keeps_up(way); }); };
    int best = kFixed;
    for (const int way : {kRoot, kLike})
        if (kept(way).size() > kept(best).size()) best = way;
    const std::vector<int> others = {kFixed, kRoot, kLike, kColumns, kRandom};
    return fmt::format(
        "More PEs than pixels a side, where Kohata & Ito ask for 2-D \"or the like\": of {} such arrays 2-D is kept up "
        "with on ({}). {}",
        between.size(),
        joined(others, "; ", [&](int way) { return fmt::format("{}: {}", kLabels[way], kept(way).size()); }),
        need_of_2d(kLabels[best], each(kept(best), &Row::pes), between.size()));
}

// The cyclic mappings on more PEs than columns, over many pictures. 2-D is needed where none of them keeps up on any
// array; it is not where one keeps up on all.
Claim claim_of_2d(const std::vector<MeanRow>& between, std::size_t pictures) {
    bool none = true;
    int best = kFixed;
    double best_least = 0;
    for (const int way : {kFixed, kRoot, kLike}) {
        double low = 1e9;
        for (const MeanRow& row : between) {
            none = none && row.beside_2d[way].high() < kClose;
            low = std::min(low, row.beside_2d[way].low());
        }
        if (low > best_least) best = way, best_least = low;
    }
    const MeanRow& worst = least(between, [&](const MeanRow& row) { return row.beside_2d[best].mean; });
    return {paper::kSpa, "conclusions", "More PEs than pixels a side need 2-D or the like.",
            verdict_of(none, best_least >= kClose),
            finding("scale", "2-D", "pictures"_a = pictures, "arrays"_a = between.size(), "best"_a = kLabels[best],
                    "worst"_a = with_interval(worst.beside_2d[best], 2), "pes"_a = worst.pes, "close"_a = kClose)};
}

StudyTable table_of_means(const std::vector<MeanRow>& means) {
    std::vector<Column<MeanRow>> columns = {{"P", &MeanRow::pes},
                                            {"upper bound", [](const MeanRow& row) { return row.bound.mean; }}};
    for (int way = 0; way < kFixedBlock; ++way) {
        columns.push_back({kLabels[way], [way](const MeanRow& row) { return row.of[way].mean; }});
        columns.push_back(
            {std::string(kLabels[way]) + ", +-", [way](const MeanRow& row) { return row.of[way].half_width; }});
    }
    return table_of("scale-views", "Efficiency for each number of PEs, mean of the pictures", means, columns, false);
}

StudyPlot plot_of_means(const std::vector<MeanRow>& means, std::size_t pictures) {
    StudyPlot plot{"scale-views", fmt::format("Efficiency against the number of PEs, mean of {} pictures", pictures),
                   "PEs", "efficiency", Axes::kLogX};
    for (int way = 0; way < kFixedBlock; ++way)
        plot.series.push_back(
            line_with_bars(kLabels[way], means, &MeanRow::pes, [way](const MeanRow& row) { return row.of[way]; }));
    return plot;
}

// With s = P / W rows from one row of a PE to its next, p shifts these by s p columns: not at all for multiples of W.
std::string finding_of_resonance(const Rows& between, std::uint32_t side) {
    std::vector<std::string> words;
    for (const int way : {kFixed, kRoot, kLike}) {
        const Rows lost = where(between, [&](const Row& row) {
            return row.pes % side == 0 && row.pes / side * offset_of(way, side, row.pes) % side == 0;
        });
        if (!lost.empty()) words.push_back(fmt::format("{} for P = {}", kLabels[way], joined(lost, ", ", &Row::pes)));
    }
    if (words.empty()) return "No offset here falls back to the column split where PEs share the rows of a slot.";
    return fmt::format(
        "Where PEs share the rows of a slot, an offset can cancel out: P / W rows further on the shift is a multiple "
        "of W, and the load is the column split's. So it is with {}.",
        fmt::join(words, "; "));
}

std::vector<Comparison> comparisons_of(const Rows& rows, std::uint32_t side, double most) {
    const Row& row = *std::ranges::find_if(rows, [&](const Row& one) { return one.pes * 2 > side; });
    std::vector<Comparison> all;
    for (int way = 0; way < kFixedBlock; ++way)
        all.push_back({fmt::format("efficiency on {} PEs, {}", row.pes, kLabels[way]), "", std::nullopt, row.of[way]});
    all.push_back({"largest speed-up there can be", "", std::nullopt, most, "all cycles / those of the largest pixel"});
    return all;
}

}  // namespace

std::string need_of_2d(const std::string& best, const std::vector<std::uint32_t>& kept, std::size_t sizes) {
    if (kept.size() == sizes)
        return fmt::format("So it does not take 2-D, but it takes \"the like\": {}, its rows shared, is enough.", best);
    if (kept.empty()) return "So it does take 2-D, as Kohata & Ito say.";
    return fmt::format("So it does not always take 2-D: {} does for P = {}.", best, fmt::join(kept, ", "));
}

StudyPage scale_page(const std::string& scene, const CostImage& image, const std::vector<const CostImage*>& views) {
    const std::uint32_t side = image.width;
    const Rows rows = rows_of(image);
    const Rows between = where(rows, [&](const Row& row) { return row.pes > side && row.pes < side * side; });
    const double largest = static_cast<double>(std::ranges::max(image.cycles)) *
                           static_cast<double>(image.cycles.size()) /
                           static_cast<double>(total_cycles(image));  // pixel, in mean pixels
    const double most = static_cast<double>(side) * side / largest;
    StudyPage page = page_about(
        "scale",
        {{"scene", scene},
         {"size", side},
         {"pes", each(rows, &Row::pes)},
         {"offset", kOffset % side},
         {"seed", 1},
         {"views", views.size()}},
        {{"fewest", rows.front().pes}, {"most", rows.back().pes}, {"close", fmt::format("{:.0f}", 100 * kClose)}});
    page.comparisons = comparisons_of(rows, side, most);
    page.findings = {
        finding_of_half(rows), finding_of_2d(between), finding_of_resonance(between, side),
        fmt::format(
            "The largest pixel costs {:.1f} times the mean one, so no distribution of whole pixels gains more than "
            "{:.0f} times; that is what a PE for each pixel gives whatever the mapping, an efficiency of {:.3f}.",
            largest, most, 1 / largest)};
    page.tables = tables_of(rows);
    page.plots = plots_of(rows);
    page.news = {sentence("scale", "news")};
    if (views.size() < 2) return page;
    const auto pictures = each(views, [](const CostImage* view) { return rows_of(*view); });
    const auto means = means_of(pictures);
    page.claims = {claim_of_2d(
        where(means, [&](const MeanRow& row) { return row.pes > side && row.pes < side * side; }), pictures.size())};
    page.tables.push_back(table_of_means(means));
    page.plots.push_back(plot_of_means(means, pictures.size()));
    return page;
}

StudyPage study_scale(Laboratory& lab, const Scenes& scenes) {
    const LabelledScene scene = one_of(scenes);
    constexpr std::size_t kViews = 8;
    const Ensemble ensemble = ensemble_of(lab, scene, lab.size(1024), AntialiasMethod::kNone, kViews);
    return scale_page(scene.label, ensemble.picture->trace,
                      each(ensemble.views, [](const Costs* costs) { return &costs->trace; }));
}

}  // namespace raya
