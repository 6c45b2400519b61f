// Static mappings on 16 to 1,048,576 PEs: where does each fall under half, and does it take 2-D beyond a PE a column?
#include "host/study/scale.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "host/ring/mapping.hpp"
#include "host/ring/schedule.hpp"
#include "host/study/arrays.hpp"
#include "host/study/laboratory.hpp"
#include "host/study/studies.hpp"

namespace raya {
namespace {

constexpr std::uint32_t kOffset = 16;
constexpr double kHalf = 0.5;   // the efficiency under which a mapping has fallen
constexpr double kClose = 0.9;  // of the 2-D mapping's efficiency: a mapping that keeps up

// The cyclic fold and others that know no fold, then the block fold.
enum { kFixed, kRoot, kLike, kColumns, kGrid, kRandom, kFixedBlock, kRootBlock, kLikeBlock, kColumnsBlock, kWays };
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

struct Scale {
    std::uint32_t side = 0;
    std::vector<std::uint32_t> pes;
    std::vector<double> efficiency[kWays];  // of each number of PEs
    std::vector<double> bound;              // no distribution of whole pixels does better
    double largest = 0;                     // pixel, in mean pixels
};

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
    const std::string name = way == kGrid ? squarest_grid(pes) : way == kRandom ? "random:1" : "cyclic";
    return make_mapping(name, side, side, pes, offset_of(way, side, pes), way >= kFixedBlock ? "block" : "cyclic");
}

Scale scale_of(const CostImage& image) {
    Scale s;
    s.side = image.width;
    const auto total = static_cast<double>(total_cycles(image));
    s.largest = static_cast<double>(*std::max_element(image.cycles.begin(), image.cycles.end())) *
                static_cast<double>(image.cycles.size()) / total;
    for (std::uint32_t pes = 16; pes <= s.side * s.side; pes *= 2) {
        s.pes.push_back(pes);
        s.bound.push_back(total / static_cast<double>(lower_bound(image, pes)) / pes);
        for (int way = 0; way < kWays; ++way)
            s.efficiency[way].push_back(static_load(image, mapping_of(way, s.side, pes)).efficiency);
    }
    return s;
}

// The last P up to which the efficiency has been kHalf or more; 0: never.
std::uint32_t last_above_half(const Scale& s, const std::vector<double>& efficiency) {
    std::uint32_t last = 0;
    for (std::size_t i = 0; i < s.pes.size() && efficiency[i] >= kHalf; ++i) last = s.pes[i];
    return last;
}

PlotSeries series_of(const Scale& s, const std::string& label, const std::vector<double>& efficiency, bool speedup) {
    PlotSeries series{label, {}, {}, PlotStyle::kLine};
    for (std::size_t i = 0; i < s.pes.size(); ++i) {
        series.x.push_back(s.pes[i]);
        series.y.push_back(speedup ? efficiency[i] * s.pes[i] : efficiency[i]);
    }
    return series;
}

StudyPlot plot_of(const Scale& s, bool speedup) {
    StudyPlot plot{speedup ? "scale-speedup" : "scale",
                   speedup ? "Speed-up against the number of PEs, cyclic fold"
                           : "Efficiency against the number of PEs, cyclic fold",
                   "PEs",
                   speedup ? "speed-up" : "efficiency",
                   true,
                   speedup,
                   {series_of(s, "upper bound", s.bound, speedup)}};
    for (int way = 0; way < kFixedBlock; ++way)
        plot.series.push_back(series_of(s, kLabels[way], s.efficiency[way], speedup));
    return plot;
}

StudyPlot folds_plot(const Scale& s) {
    StudyPlot plot{
        "scale-folds", "Efficiency against the number of PEs, both folds", "PEs", "efficiency", true, false, {}};
    for (const int way : {kFixed, kFixedBlock, kLike, kLikeBlock, kColumns, kColumnsBlock})
        plot.series.push_back(series_of(s, kLabels[way], s.efficiency[way], false));
    return plot;
}

StudyTable efficiency_table(const Scale& s) {
    StudyTable table{"scale", "Efficiency for each number of PEs", {"P", "upper bound"}, {}, true};
    table.columns.insert(table.columns.end(), std::begin(kLabels), std::end(kLabels));
    for (std::size_t i = 0; i < s.pes.size(); ++i) {
        table.rows.push_back({std::int64_t{s.pes[i]}, s.bound[i]});
        for (const auto& efficiency : s.efficiency) table.rows.back().emplace_back(efficiency[i]);
    }
    return table;
}

StudyTable half_table(const Scale& s) {
    StudyTable table{"scale-half",
                     "Where each falls under an efficiency of 50 %",
                     {"mapping", "50 % or more up to P", "speed-up there"},
                     {},
                     true};
    const auto add = [&](const char* label, const std::vector<double>& efficiency) {
        const std::uint32_t last = last_above_half(s, efficiency);
        const auto at = std::find(s.pes.begin(), s.pes.end(), last) - s.pes.begin();
        table.rows.push_back(
            {label, std::int64_t{last}, last > 0 ? efficiency[static_cast<std::size_t>(at)] * last : 0.0});
    };
    add("upper bound", s.bound);
    for (int way = 0; way < kWays; ++way) add(kLabels[way], s.efficiency[way]);
    return table;
}

std::string finding_of_half(const Scale& s) {
    std::vector<std::string> words;
    for (int way = 0; way < kFixedBlock; ++way) {
        const std::uint32_t last = last_above_half(s, s.efficiency[way]);
        words.push_back(last > 0 ? fmt::format("{}: {}", kLabels[way], last) : fmt::format("{}: none", kLabels[way]));
    }
    return fmt::format(
        "PEs up to which half of the array's power or more is used: {}; whole pixels, however given out: {}.",
        fmt::join(words, "; "), last_above_half(s, s.bound));
}

// Numbers of PEs between one a column and one a pixel, both left out.
bool is_between(const Scale& s, std::uint32_t pes) { return pes > s.side && pes < s.side * s.side; }

std::vector<std::uint32_t> keeps_up(const Scale& s, int way) {
    std::vector<std::uint32_t> kept;
    for (std::size_t i = 0; i < s.pes.size(); ++i)
        if (is_between(s, s.pes[i]) && s.efficiency[way][i] >= kClose * s.efficiency[kGrid][i])
            kept.push_back(s.pes[i]);
    return kept;
}

std::string finding_of_2d(const Scale& s) {
    const auto sizes = static_cast<std::size_t>(
        std::count_if(s.pes.begin(), s.pes.end(), [&](auto pes) { return is_between(s, pes); }));
    std::vector<std::string> words;
    int best = kFixed;
    for (const int way : {kFixed, kRoot, kLike, kColumns, kRandom}) {
        const std::size_t kept = keeps_up(s, way).size();
        words.push_back(fmt::format("{}: {}", kLabels[way], kept));
        if (way <= kLike && kept > keeps_up(s, best).size()) best = way;
    }
    return fmt::format(
        "More PEs than pixels a side, where the paper asks for 2-D \"or the like\": of {} such arrays 2-D is kept up "
        "with on ({}). {}",
        sizes, fmt::join(words, "; "), need_of_2d(kLabels[best], keeps_up(s, best), sizes));
}

// With s = P / W rows from one row of a PE to its next, p shifts these by s p columns: not at all for multiples of W.
std::string finding_of_resonance(const Scale& s) {
    std::vector<std::string> words;
    for (const int way : {kFixed, kRoot, kLike}) {
        std::vector<std::uint32_t> lost;
        for (const std::uint32_t pes : s.pes)
            if (is_between(s, pes) && pes % s.side == 0 && pes / s.side * offset_of(way, s.side, pes) % s.side == 0)
                lost.push_back(pes);
        if (!lost.empty()) words.push_back(fmt::format("{} for P = {}", kLabels[way], fmt::join(lost, ", ")));
    }
    if (words.empty()) return "No offset here falls back to the column split where PEs share the rows of a slot.";
    return fmt::format(
        "Where PEs share the rows of a slot, an offset can cancel out: P / W rows further on the shift "
        "is a multiple of W, and the load is the column split's. So it is with {}.",
        fmt::join(words, "; "));
}

std::string finding_of_pixel(const Scale& s) {
    const double most = static_cast<double>(s.side) * s.side / s.largest;
    return fmt::format(
        "The largest pixel costs {:.1f} times the mean one, so no distribution of whole pixels gains more than {:.0f} "
        "times; that is what a PE for each pixel gives whatever the mapping, an efficiency of {:.3f}.",
        s.largest, most, 1 / s.largest);
}

std::vector<Comparison> comparisons_of(const Scale& s) {
    std::vector<Comparison> comparisons;
    const auto at_columns = static_cast<std::size_t>(
        std::find_if(s.pes.begin(), s.pes.end(), [&](auto pes) { return pes * 2 > s.side; }) - s.pes.begin());
    for (int way = 0; way < kFixedBlock; ++way)
        comparisons.push_back({fmt::format("efficiency on {} PEs, {}", s.pes[at_columns], kLabels[way]),
                               "",
                               {},
                               s.efficiency[way][at_columns],
                               ""});
    comparisons.push_back({"largest speed-up there can be",
                           "",
                           {},
                           static_cast<double>(s.side) * s.side / s.largest,
                           "all cycles / those of the largest pixel"});
    return comparisons;
}

}  // namespace

std::string need_of_2d(const std::string& best, const std::vector<std::uint32_t>& kept, std::size_t sizes) {
    if (kept.size() == sizes)
        return fmt::format("So it does not take 2-D, but it takes \"the like\": {}, its rows shared, is enough.", best);
    if (kept.empty()) return "So it does take 2-D, as the paper says.";
    return fmt::format("So it does not always take 2-D: {} does for P = {}.", best, fmt::join(kept, ", "));
}

StudyPage scale_page(const std::string& scene, const CostImage& image) {
    const Scale s = scale_of(image);
    StudyPage page;
    page.name = "scale";
    page.title = "From 16 PEs to one for each pixel";
    page.question = "How far do static mappings go, and does it take two dimensions beyond a PE for each column?";
    page.method = {
        fmt::format("{} at {} x {} on {} to {} PEs of the SPA, doubling; first pass.", scene, s.side, s.side,
                    s.pes.front(), s.pes.back()),
        "Where there are more PEs than columns, PEs share a slot: its rows go to them in turn (cyclic fold) or in runs "
        "(block fold).",
        "p = sqrt(P) or W / sqrt(P): the former up to a PE for each column, the latter beyond, where the rows of a PE "
        "lie P / W apart and the same square spacing takes a smaller offset. All rounded.",
        "2-D: A x B PEs as near to a square as a power of two allows, each has every B-th pixel of every A-th line. "
        "Random: each pixel's PE is drawn, shares even; seed 1.",
        fmt::format("Upper bound: all cycles / max(mean load, largest pixel). \"Keeps up\": {:.0f} % of the 2-D "
                    "mapping's efficiency or more.",
                    100 * kClose)};
    page.settings = {{"scene", scene}, {"size", s.side}, {"pes", s.pes}, {"offset", kOffset % s.side}, {"seed", 1}};
    page.comparisons = comparisons_of(s);
    page.tables = {half_table(s), efficiency_table(s)};
    page.plots = {plot_of(s, false), folds_plot(s), plot_of(s, true)};
    page.findings = {finding_of_half(s), finding_of_2d(s), finding_of_resonance(s), finding_of_pixel(s)};
    return page;
}

StudyPage study_scale(Laboratory& lab, const std::vector<LabelledScene>& scenes) {
    const LabelledScene scene = scenes.empty() ? embedded_scene("centre") : scenes.front();
    return scale_page(scene.label, lab.costs(scene, lab.size(1024)).trace);
}

}  // namespace raya
