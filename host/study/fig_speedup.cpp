// Fig. 9: speed-up against the number of PEs, column split and cyclic mapping, and 2-D interleaving beside them.
#include "host/study/fig_speedup.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "host/ring/mapping.hpp"
#include "host/ring/schedule.hpp"
#include "host/study/arrays.hpp"
#include "host/study/laboratory.hpp"
#include "host/study/paper.hpp"
#include "host/study/studies.hpp"

namespace raya {
namespace {

constexpr std::uint32_t kOffset = 16;  // the paper's for 256 PEs

// Speed-ups of 1, 2, .. W PEs, and of A x A PEs.
struct Speedups {
    std::uint32_t width = 0;                     // W
    std::vector<double> columns, columns_block;  // p = 0, folds cyclic and block
    std::vector<double> cyclic, cyclic_block;    // p = 16
    std::vector<double> root, root_block;        // p = round(sqrt(P))
    std::vector<double> grid;                    // A = 1, 2, .. floor(sqrt(W))

    double at(const std::vector<double>& series, std::uint32_t pes) const { return series[pes - 1]; }
};

// The loads of a PE for each slot, as an image of one row: with no more PEs than slots every PE has whole ones.
CostImage slots_of(const CostImage& image, std::uint32_t offset) {
    const raya_mapping mapping = make_mapping("cyclic", image.width, image.height, image.width, offset, "cyclic");
    return {image.width, 1, static_load(image, mapping).per_pe};
}

double speedup_of(const CostImage& slots, std::uint32_t pes, const char* fold) {
    return static_load(slots, make_mapping("column", slots.width, 1, pes, 0, fold)).speedup;
}

Speedups speedups_of(const CostImage& image) {
    const std::uint32_t w = image.width;
    const CostImage columns = slots_of(image, 0), cyclic = slots_of(image, kOffset % w);
    CostImage root;
    Speedups s;
    s.width = w;
    for (std::uint32_t pes = 1; pes <= w; ++pes) {
        if (pes == 1 || root_offset(pes) != root_offset(pes - 1)) root = slots_of(image, root_offset(pes));
        s.columns.push_back(speedup_of(columns, pes, "cyclic"));
        s.columns_block.push_back(speedup_of(columns, pes, "block"));
        s.cyclic.push_back(speedup_of(cyclic, pes, "cyclic"));
        s.cyclic_block.push_back(speedup_of(cyclic, pes, "block"));
        s.root.push_back(speedup_of(root, pes, "cyclic"));
        s.root_block.push_back(speedup_of(root, pes, "block"));
    }
    for (std::uint32_t a = 1; a * a <= w; ++a) {
        const raya_mapping grid = make_mapping(fmt::format("grid:{0}x{0}", a), w, image.height, a * a, 0, "cyclic");
        s.grid.push_back(static_load(image, grid).speedup);
    }
    return s;
}

PlotSeries series_of(const std::string& label, const std::vector<double>& speedups, bool efficiency) {
    PlotSeries series{label, {}, {}, PlotStyle::kLine};
    for (std::size_t i = 0; i < speedups.size(); ++i) {
        const auto pes = static_cast<double>(i + 1);
        series.x.push_back(pes);
        series.y.push_back(efficiency ? speedups[i] / pes : speedups[i]);
    }
    return series;
}

PlotSeries grid_series(const Speedups& s, bool efficiency) {
    PlotSeries series{"2-D, A x A PEs", {}, {}, PlotStyle::kPoints};
    for (std::size_t a = 1; a <= s.grid.size(); ++a) {
        const auto pes = static_cast<double>(a * a);
        series.x.push_back(pes);
        series.y.push_back(efficiency ? s.grid[a - 1] / pes : s.grid[a - 1]);
    }
    return series;
}

std::vector<StudyPlot> plots_of(const Speedups& s) {
    const double w = s.width;
    std::vector<double> ideal(s.width);
    std::iota(ideal.begin(), ideal.end(), 1.0);
    StudyPlot speedup{"fig9",
                      "Speed-up against the number of PEs, cyclic fold",
                      "PEs",
                      "speed-up",
                      false,
                      false,
                      {series_of("ideal", ideal, false), series_of("p = 16", s.cyclic, false),
                       series_of("p = round(sqrt(P))", s.root, false),
                       series_of("p = 0, column split", s.columns, false), grid_series(s, false)}};
    if (s.width == paper::kPes) {
        speedup.series.push_back(
            {"paper, p = 0 and 16", {w, w}, {paper::kSpeedup0, paper::kSpeedup16}, PlotStyle::kPaper});
        speedup.series.push_back(
            {"Pixel Machine, its own scene, 60 or more", {64}, {paper::kPixelMachineSpeedup}, PlotStyle::kPaper});
    }
    return {speedup,
            {"fig9-folds",
             "Efficiency against the number of PEs, both folds",
             "PEs",
             "efficiency",
             false,
             false,
             {series_of("p = 16, cyclic fold", s.cyclic, true), series_of("p = 16, block fold", s.cyclic_block, true),
              series_of("p = 0, cyclic fold", s.columns, true), series_of("p = 0, block fold", s.columns_block, true),
              grid_series(s, true)}}};
}

StudyTable table_of(const Speedups& s) {
    StudyTable table{"fig9",
                     "Speed-up for each number of PEs",
                     {"P", "p = 0, cyclic fold", "p = 0, block fold", "p = 16, cyclic fold", "p = 16, block fold",
                      "p = round(sqrt(P)), cyclic fold", "p = round(sqrt(P)), block fold"},
                     {},
                     false};
    for (std::uint32_t pes = 1; pes <= s.width; ++pes) {
        table.rows.push_back({std::int64_t{pes}});
        for (const auto* column : {&s.columns, &s.columns_block, &s.cyclic, &s.cyclic_block, &s.root, &s.root_block})
            table.rows.back().emplace_back(s.at(*column, pes));
    }
    return table;
}

StudyTable squares_table(const Speedups& s) {
    StudyTable table{"fig9-squares",
                     "Speed-up on square numbers of PEs, cyclic fold",
                     {"P", "A x A, 2-D", "p = 0", "p = 16", "p = sqrt(P)"},
                     {},
                     true};
    for (std::uint32_t a = 2; a <= s.grid.size(); ++a)
        table.rows.push_back(
            {std::int64_t{a * a}, s.grid[a - 1], s.at(s.columns, a * a), s.at(s.cyclic, a * a), s.at(s.root, a * a)});
    return table;
}

std::vector<Comparison> comparisons_of(const Speedups& s) {
    const auto paper = [&](double value) {
        return s.width == paper::kPes ? std::optional<double>(value) : std::nullopt;
    };
    const std::size_t more = s.grid.size() / 2 * 2, fewer = more / 2;  // A of four times as many PEs, and of fewer
    const double most = s.grid[more - 1], least = s.grid[fewer - 1];
    return {{fmt::format("speed-up on {} PEs, p = 16", s.width), "", paper(paper::kSpeedup16), s.cyclic.back(), ""},
            {fmt::format("speed-up on {} PEs, p = 0", s.width), "", paper(paper::kSpeedup0), s.columns.back(),
             "the paper's from its tables; centre at 256 x 256 is calibrated on its u(0)"},
            {fmt::format("CAP's mapping, {0} x {0} PEs over {1} x {1}", more, fewer), "", paper(paper::kCapRatio),
             most / least, "the paper's from the makers of CAP, who had another scene"},
            {fmt::format("Pixel Machine's mapping, {0} x {0} PEs", fewer), "", paper(paper::kPixelMachineSpeedup),
             least, "the paper: 60 or more, from the makers, who had another scene"}};
}

double mean_efficiency(const std::vector<double>& speedups) {
    double sum = 0;
    for (std::size_t i = 0; i < speedups.size(); ++i) sum += speedups[i] / static_cast<double>(i + 1);
    return sum / static_cast<double>(speedups.size());
}

std::string finding_of_whole(const Speedups& s) {
    std::string text = fmt::format("On {} PEs p = 16 gives {:.1f} times and p = 0 {:.1f} times", s.width,
                                   s.cyclic.back(), s.columns.back());
    if (s.width != paper::kPes) return text + ".";
    const double ratio = s.cyclic.back() / paper::kSpeedup16;
    const char* verdict = ratio > 1.02 ? "more than" : ratio < 0.98 ? "less than" : "within 2 % of";
    return text + fmt::format("; the former is {} the paper's {:.0f}.", verdict, paper::kSpeedup16);
}

// Between W / 2 and W PEs some PE has two columns.
std::string finding_of_stairs(const Speedups& s) {
    const std::uint32_t half = s.width / 2;
    const auto best = *std::max_element(s.cyclic.begin() + half, s.cyclic.end() - 1);
    const double gain = 100 * (best / s.at(s.cyclic, half) - 1);
    std::uint32_t side = 1;  // of the largest square below W
    while ((side + 1) * (side + 1) < s.width) ++side;
    std::string text = fmt::format("Whole columns make stairs: with {} to {} PEs some PE still has two of the {}, and ",
                                   half + 1, s.width - 1, s.width);
    text += gain > 0.5 ? fmt::format("p = 16 gains at most {:.1f} % over {} PEs", gain, half)
                       : fmt::format("p = 16 gains nothing over {} PEs", half);
    return text + fmt::format("; on {} PEs it gives {:.1f} times, {} x {} PEs in two dimensions {:.1f} times.",
                              side * side, s.at(s.cyclic, side * side), side, side, s.grid[side - 1]);
}

std::string finding_of_folds(const Speedups& s) {
    const double c0 = mean_efficiency(s.columns), b0 = mean_efficiency(s.columns_block);
    const double c16 = mean_efficiency(s.cyclic), b16 = mean_efficiency(s.cyclic_block);
    const auto better = [](double c, double b) {
        return c > b ? "the cyclic fold" : b > c ? "the block fold" : "none";
    };
    return fmt::format(
        "Mean efficiency over all P: column split {:.3f} with the cyclic fold and {:.3f} with the block fold, p = 16 "
        "{:.3f} and {:.3f}; the better fold is {} for the column split and {} for p = 16.",
        c0, b0, c16, b16, better(c0, b0), better(c16, b16));
}

std::string finding_of_offset(const Speedups& s) {
    std::vector<std::uint32_t> idle;  // where p = 16 does what p = 0 does
    std::uint32_t root_wins = 0;
    for (std::uint32_t pes = 2; pes <= s.width; ++pes) {
        if (s.at(s.cyclic, pes) == s.at(s.columns, pes)) idle.push_back(pes);
        root_wins += s.at(s.root, pes) > s.at(s.cyclic, pes);
    }
    std::string text = fmt::format(
        "p = round(sqrt(P)) is better than p = 16 for {} of {} numbers of PEs, mean efficiency {:.3f} against {:.3f}",
        root_wins, s.width - 1, mean_efficiency(s.root), mean_efficiency(s.cyclic));
    if (idle.empty()) return text + ".";
    return text + fmt::format("; p = 16 gives the same as the column split for P = {}.", fmt::join(idle, ", "));
}

}  // namespace

StudyPage speedup_page(const std::string& scene, const CostImage& image) {
    const Speedups s = speedups_of(image);
    StudyPage page;
    page.name = "fig9";
    page.title = "Fig. 9: speed-up against the number of PEs";
    page.question = "How many times faster do P PEs compute the image than one?";
    page.method = {
        fmt::format("{} at {} x {} on 1 to {} PEs of the SPA, every number; first pass.", scene, image.width,
                    image.height, s.width),
        "Speed-up = sum of all loads / largest load, from one cost image: modelled computing alone, without transfers.",
        "The paper does not say which offset it took for fewer than 256 PEs, nor which PE has which columns then. "
        "p = 16 throughout is drawn, and p = round(sqrt(P)) as well; both folds are computed.",
        "CAP's and the Pixel Machine's mapping: A x A PEs, each has every A-th pixel of every A-th line. The paper "
        "quotes those machines' own measurements; here their mapping meets the same scene as the others."};
    page.settings = {{"scene", scene}, {"size", image.width}, {"pes", s.width}, {"offset", kOffset % s.width}};
    page.comparisons = comparisons_of(s);
    page.tables = {squares_table(s), table_of(s)};
    page.plots = plots_of(s);
    page.findings = {finding_of_whole(s), finding_of_stairs(s), finding_of_folds(s), finding_of_offset(s)};
    return page;
}

StudyPage study_fig9(Laboratory& lab, const std::vector<LabelledScene>& scenes) {
    const LabelledScene scene = scenes.empty() ? embedded_scene("centre") : scenes.front();
    return speedup_page(scene.label, lab.costs(scene, lab.size(256)).trace);
}

}  // namespace raya
