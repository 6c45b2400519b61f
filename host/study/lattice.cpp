// Are offsets beyond sqrt(P) worse? Each offset's imbalance over several scenes beside its lattice.
#include "host/study/lattice.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "host/ring/schedule.hpp"
#include "host/study/studies.hpp"

namespace raya {
namespace {

struct Offsets {
    std::uint32_t side = 0, reference = 0;  // N = P, and the offset nearest to sqrt(P)
    std::vector<const Costs*> scenes;
    std::vector<std::vector<double>> u;  // scene x offset
    std::vector<double> length;          // of the shortest vector, pixels
    std::vector<double> mean_u, mean_rank;
    SpreadOffsets spread;

    // Scenes in which an offset has a lower u than the reference.
    std::int64_t wins(std::uint32_t p) const {
        return std::count_if(u.begin(), u.end(), [&](const auto& scene) { return scene[p] < scene[reference]; });
    }
    bool better(std::uint32_t p) const { return mean_u[p] < mean_u[reference]; }
    std::uint32_t best() const {
        return static_cast<std::uint32_t>(std::min_element(mean_u.begin(), mean_u.end()) - mean_u.begin());
    }
};

std::vector<double> mean_of(const std::vector<std::vector<double>>& rows) {
    std::vector<double> mean(rows.front().size());
    for (const auto& row : rows)
        for (std::size_t i = 0; i < row.size(); ++i) mean[i] += row[i] / static_cast<double>(rows.size());
    return mean;
}

Offsets offsets_of(const std::vector<const Costs*>& scenes) {
    Offsets all;
    all.side = scenes.front()->trace.width;
    all.reference = static_cast<std::uint32_t>(std::lround(std::sqrt(all.side)));
    all.scenes = scenes;
    all.spread = well_spread_offsets(all.side, all.reference);
    std::vector<std::uint32_t> every(all.side);
    std::iota(every.begin(), every.end(), 0u);
    std::vector<std::vector<double>> ranks;
    for (const Costs* costs : scenes) {
        all.u.push_back(imbalance_of_offsets(costs->trace, all.side, RAYA_FOLD_CYCLIC, every));
        ranks.push_back(ranks_of(all.u.back()));
    }
    for (const std::uint32_t p : every)
        all.length.push_back(std::sqrt(static_cast<double>(shortest_square(p, all.side))));
    all.mean_u = mean_of(all.u);
    all.mean_rank = mean_of(ranks);
    return all;
}

StudyTable chosen_table(const Offsets& all) {
    std::vector<std::uint32_t> chosen = {0, all.reference};
    for (const auto* group : {&all.spread.longer, &all.spread.as_long})
        chosen.insert(chosen.end(), group->begin(), group->end());
    if (std::find(chosen.begin(), chosen.end(), all.best()) == chosen.end()) chosen.push_back(all.best());
    StudyTable table{
        "lattice-chosen",
        fmt::format("p = 0, p = {}, those that spread as well or better, and the best of all", all.reference),
        {"p", "shortest vector (pixels)", "mean u", fmt::format("mean rank of {}", all.side),
         fmt::format("scenes better than p = {}", all.reference)},
        {},
        true};
    for (const std::uint32_t p : chosen)
        table.rows.push_back({std::int64_t{p}, all.length[p], all.mean_u[p], all.mean_rank[p], all.wins(p)});
    return table;
}

StudyTable whole_table(const Offsets& all) {
    StudyTable table{"lattice", "Every offset", {"p", "shortest vector (pixels)", "mean u", "mean rank"}, {}, false};
    for (const Costs* costs : all.scenes) table.columns.push_back("u, " + costs->label);
    for (std::uint32_t p = 0; p < all.side; ++p) {
        table.rows.push_back({std::int64_t{p}, all.length[p], all.mean_u[p], all.mean_rank[p]});
        for (const auto& scene : all.u) table.rows.back().emplace_back(scene[p]);
    }
    return table;
}

// Mean u of some offsets, against the offset or against its shortest vector.
PlotSeries series_of(const Offsets& all, const std::string& label, const std::vector<std::uint32_t>& offsets,
                     bool by_length, PlotStyle style) {
    PlotSeries series{label, {}, {}, style};
    for (const std::uint32_t p : offsets) {
        series.x.push_back(by_length ? all.length[p] : p);
        series.y.push_back(all.mean_u[p]);
    }
    return series;
}

std::vector<StudyPlot> plots_of(const Offsets& all) {
    std::vector<std::uint32_t> every(all.side);
    std::iota(every.begin(), every.end(), 0u);
    const auto plot = [&](const char* name, const char* title, const char* x, bool by_length) {
        const PlotStyle style = by_length ? PlotStyle::kPoints : PlotStyle::kLine;
        return StudyPlot{
            name,
            title,
            x,
            fmt::format("u, mean of {} scenes", all.scenes.size()),
            false,
            true,
            {series_of(all, "every offset", every, by_length, style),
             series_of(all, fmt::format("beyond {}, longer vector", all.reference), all.spread.longer, by_length,
                       PlotStyle::kPoints),
             series_of(all, fmt::format("beyond {}, as long", all.reference), all.spread.as_long, by_length,
                       PlotStyle::kPoints),
             series_of(all, fmt::format("p = {}", all.reference), {all.reference}, by_length, PlotStyle::kPoints)}};
    };
    return {plot("lattice", "Imbalance against the shortest distance between two pixels of a PE",
                 "shortest vector of the lattice (pixels)", true),
            plot("lattice-offsets", "Imbalance against the offset", "offset p (pixels)", false)};
}

// Of each scene's u with the shortest vector, over the offsets whose vector is so long or longer.
std::vector<double> correlations_of(const Offsets& all, double least_length) {
    std::vector<double> correlations;
    for (const auto& scene : all.u) {
        std::vector<double> length, u;
        for (std::uint32_t p = 0; p < all.side; ++p) {
            if (all.length[p] < least_length) continue;
            length.push_back(all.length[p]);
            u.push_back(scene[p]);
        }
        correlations.push_back(rank_correlation(length, u));
    }
    return correlations;
}

double mean_of(const std::vector<double>& values) {
    return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

double mean_u_of(const Offsets& all, const std::vector<std::uint32_t>& offsets) {
    std::vector<double> u;
    for (const std::uint32_t p : offsets) u.push_back(all.mean_u[p]);
    return mean_of(u);
}

std::int64_t better_of(const Offsets& all, const std::vector<std::uint32_t>& offsets) {
    return std::count_if(offsets.begin(), offsets.end(), [&](auto p) { return all.better(p); });
}

std::string group_text(const Offsets& all, const std::vector<std::uint32_t>& offsets, const char* vector) {
    if (offsets.empty()) return fmt::format("none has a vector {}", vector);
    return fmt::format("{} have a vector {}, of which {} have a lower mean u than p = {}, their mean {:.4f}",
                       offsets.size(), vector, better_of(all, offsets), all.reference, mean_u_of(all, offsets));
}

std::string finding_of_spread(const Offsets& all) {
    std::vector<std::uint32_t> both = all.spread.longer;
    both.insert(both.end(), all.spread.as_long.begin(), all.spread.as_long.end());
    const double own = all.mean_u[all.reference];
    std::string text = fmt::format("Of the offsets beyond {} (u = {:.4f}), {}; {}. ", all.reference, own,
                                   group_text(all, all.spread.longer, "longer than its own"),
                                   group_text(all, all.spread.as_long, "as long"));
    if (both.empty() || better_of(all, both) == 0)
        return text + "So nothing is gained beyond sqrt(P), as the paper says.";
    if (mean_u_of(all, both) <= own)
        return text +
               "So these are not worse on the whole: against the paper, offsets beyond sqrt(P) do more than turn "
               "the direction of the bias.";
    return text + "So these are worse on the whole, as the paper says, but not each of them.";
}

std::string finding_of_best(const Offsets& all) {
    const std::uint32_t best = all.best();
    const double gain = 100 * (1 - (1 + all.mean_u[best]) / (1 + all.mean_u[all.reference]));
    return fmt::format(
        "Best of all {} is p = {}, mean u = {:.4f}: a largest load {:.1f} % below that of p = {}, which has a mean "
        "rank of {:.1f}.",
        all.side, best, all.mean_u[best], gain, all.reference, all.mean_rank[all.reference]);
}

std::string finding_of_rest(const Offsets& all) {
    std::uint32_t worse = 0, rest = 0;
    for (std::uint32_t p = all.reference + 1; p < all.side - all.reference; ++p) {
        if (all.length[p] >= all.length[all.reference]) continue;
        ++rest;
        worse += all.mean_u[p] > all.mean_u[all.reference];
    }
    return fmt::format("Of the {} offsets from {} to {} with a shorter vector, {} are worse than p = {}.", rest,
                       all.reference + 1, all.side - all.reference - 1, worse, all.reference);
}

std::string finding_of_correlation(const Offsets& all, const std::vector<double>& correlations) {
    constexpr double kTells = -0.5;
    const auto [least, most] = std::minmax_element(correlations.begin(), correlations.end());
    const char* verdict = *most <= kTells   ? "in every scene a longer shortest vector goes with a lower u"
                          : *least > kTells ? "in no scene does the shortest vector tell much about u"
                                            : "the shortest vector tells u in some scenes and not in others";
    const double half = all.length[all.reference] / 2;
    return fmt::format(
        "Rank correlation of u with the shortest vector over all offsets: {:.2f} to {:.2f}; {} (\"tells\": {} or "
        "below). Over the offsets with a vector of {:.1f} pixels or more it is {:.2f} in the mean.",
        *least, *most, verdict, kTells, half, mean_of(correlations_of(all, half)));
}

std::vector<Comparison> comparisons_of(const Offsets& all, const std::vector<double>& correlations) {
    const std::uint32_t best = all.best();
    std::vector<Comparison> comparisons = {
        {fmt::format("mean u, p = {}", all.reference), "", {}, all.mean_u[all.reference], ""},
        {"lowest mean u of all offsets", "", {}, all.mean_u[best], fmt::format("p = {}", best)}};
    const auto add = [&](const char* vector, const std::vector<std::uint32_t>& offsets) {
        comparisons.push_back({fmt::format("offsets beyond {}, {}", all.reference, vector),
                               "",
                               {},
                               static_cast<double>(offsets.size()),
                               fmt::format("{}", fmt::join(offsets, ", "))});
        comparisons.push_back({fmt::format("... better than p = {}", all.reference),
                               "",
                               {},
                               static_cast<double>(better_of(all, offsets)),
                               "the paper: beyond sqrt(P) only the direction of the bias turns"});
    };
    add("longer vector", all.spread.longer);
    add("as long", all.spread.as_long);
    comparisons.push_back(
        {"rank correlation of u and shortest vector", "", {}, mean_of(correlations), "mean of the scenes"});
    return comparisons;
}

std::vector<LabelledScene> five_scenes() {
    const std::vector<std::string> names = {"centre", "mirrors", "glass", "random-12", "random-30"};
    std::vector<LabelledScene> chosen;
    for (LabelledScene& scene : paper_like_scenes())
        if (std::find(names.begin(), names.end(), scene.label) != names.end()) chosen.push_back(std::move(scene));
    return chosen;
}

}  // namespace

StudyPage lattice_page(const std::vector<const Costs*>& scenes) {
    const Offsets all = offsets_of(scenes);
    const std::vector<double> correlations = correlations_of(all, 0);
    std::vector<std::string> labels;
    for (const Costs* costs : scenes) labels.push_back(costs->label);
    StudyPage page;
    page.name = "lattice";
    page.title = "Offsets beyond sqrt(P)";
    page.question = fmt::format("Is every offset beyond sqrt(P) = {} worse, as the paper says?", all.reference);
    page.method = {
        fmt::format("{} at {} x {} on {} PEs of the SPA, a PE for each column; first pass.", fmt::join(labels, ", "),
                    all.side, all.side, all.side),
        "The pixels of a PE form a lattice. Its shortest vector, the least distance between two pixels of one PE, "
        "says how well an offset can spread what is costly; measured in the image, and the same on the torus.",
        fmt::format("Offsets are set against p = {}, vector {:.2f} pixels; p = {}, its mirror, is in no group.",
                    all.reference, all.length[all.reference], all.side - all.reference)};
    page.settings = {{"scenes", labels}, {"size", all.side}, {"pes", all.side}, {"reference", all.reference}};
    page.comparisons = comparisons_of(all, correlations);
    page.tables = {chosen_table(all), whole_table(all)};
    page.plots = plots_of(all);
    page.findings = {finding_of_spread(all), finding_of_best(all), finding_of_rest(all),
                     finding_of_correlation(all, correlations)};
    return page;
}

StudyPage study_lattice(Laboratory& lab, const std::vector<LabelledScene>& scenes) {
    std::vector<const Costs*> costs;
    for (const LabelledScene& scene : scenes.empty() ? five_scenes() : scenes)
        costs.push_back(&lab.costs(scene, lab.size(256)));
    return lattice_page(costs);
}

}  // namespace raya
