// Are offsets beyond sqrt(P) worse? Each offset's imbalance over several scenes beside its lattice.
#include "host/study/lattice.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "host/ring/schedule.hpp"
#include "host/study/arrays.hpp"
#include "host/study/prose.hpp"
#include "host/study/rows.hpp"
#include "host/study/studies.hpp"

namespace raya {
namespace {

// One offset of the cyclic mapping, over all scenes.
struct Offset {
    std::uint32_t p;
    double length;          // of the shortest vector, pixels
    std::vector<double> u;  // of each scene
    double mean_u = 0, mean_rank = 0;
    std::int64_t wins = 0;  // scenes in which u is lower than the reference's
};
using Offsets = std::vector<Offset>;

struct Lattice {
    std::uint32_t side;       // N = P
    std::uint32_t reference;  // the offset nearest to sqrt(P)
    std::vector<std::string> scenes;
    Offsets all;
    Offsets longer = {}, as_long = {};  // beyond the reference, with a longer vector or one as long

    const Offset& own() const { return all[reference]; }
    const Offset& best() const { return least(all, &Offset::mean_u); }
    Offsets some(const std::vector<std::uint32_t>& offsets) const {
        return each(offsets, [&](std::uint32_t p) { return all[p]; });
    }
};

Lattice lattice_of(const std::vector<const Costs*>& scenes) {
    const std::uint32_t side = scenes.front()->trace.width;
    Lattice lattice{side, root_offset(side), each(scenes, &Costs::label), {}};
    std::vector<std::uint32_t> every(side);
    std::iota(every.begin(), every.end(), 0u);
    for (const std::uint32_t p : every)
        lattice.all.push_back({p, std::sqrt(static_cast<double>(shortest_square(p, side))), {}});
    for (const Costs* costs : scenes) {
        const std::vector<double> u = imbalance_of_offsets(costs->trace, side, RAYA_FOLD_CYCLIC, every),
                                  ranks = ranks_of(u);
        for (Offset& offset : lattice.all) {
            offset.u.push_back(u[offset.p]);
            offset.mean_u += u[offset.p] / static_cast<double>(scenes.size());
            offset.mean_rank += ranks[offset.p] / static_cast<double>(scenes.size());
            offset.wins += u[offset.p] < u[lattice.reference];
        }
    }
    const SpreadOffsets spread = well_spread_offsets(side, lattice.reference);
    lattice.longer = lattice.some(spread.longer);
    lattice.as_long = lattice.some(spread.as_long);
    return lattice;
}

std::vector<StudyTable> tables_of(const Lattice& lattice) {
    Offsets chosen = lattice.some({0, lattice.reference});
    for (const Offsets* group : {&lattice.longer, &lattice.as_long})
        chosen.insert(chosen.end(), group->begin(), group->end());
    if (std::ranges::find(chosen, lattice.best().p, &Offset::p) == chosen.end()) chosen.push_back(lattice.best());
    std::vector<Column<Offset>> columns = {{"p", &Offset::p},
                                           {"shortest vector", &Offset::length, "pixels"},
                                           {"mean u", &Offset::mean_u},
                                           {"mean rank", &Offset::mean_rank}};
    std::vector<Column<Offset>> whole = columns;
    for (std::size_t n = 0; n < lattice.scenes.size(); ++n)
        whole.push_back({"u, " + lattice.scenes[n], [n](const Offset& offset) { return offset.u[n]; }});
    columns.back().label = fmt::format("mean rank of {}", lattice.side);
    columns.push_back({fmt::format("scenes better than p = {}", lattice.reference), &Offset::wins});
    return {table_of("lattice-chosen",
                     fmt::format("p = 0, p = {}, those that spread as well or better, and the best of all",
                                 lattice.reference),
                     chosen, columns),
            table_of("lattice", "Every offset", lattice.all, whole, false)};
}

// Mean u, against the offset or against its shortest vector.
template <class X>
StudyPlot plot_of(const Lattice& lattice, const char* name, const char* title, const char* x_label, X x,
                  PlotStyle style) {
    const auto points = [&](const std::string& label, const Offsets& some) {
        return line(label, some, x, &Offset::mean_u, PlotStyle::kPoints);
    };
    return {name,
            title,
            x_label,
            fmt::format("u, mean of {} scenes", lattice.scenes.size()),
            Axes::kLogY,
            {line("every offset", lattice.all, x, &Offset::mean_u, style),
             points(fmt::format("beyond {}, longer vector", lattice.reference), lattice.longer),
             points(fmt::format("beyond {}, as long", lattice.reference), lattice.as_long),
             points(fmt::format("p = {}", lattice.reference), {lattice.own()})}};
}

double mean_of(const std::vector<double>& values) {
    return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

// Of each scene's u with the shortest vector, over the offsets whose vector is so long or longer.
std::vector<double> correlations_of(const Lattice& lattice, double least_length) {
    const Offsets some = where(lattice.all, [&](const Offset& offset) { return offset.length >= least_length; });
    std::vector<double> correlations;
    for (std::size_t n = 0; n < lattice.scenes.size(); ++n)
        correlations.push_back(rank_correlation(each(some, &Offset::length),
                                                each(some, [n](const Offset& offset) { return offset.u[n]; })));
    return correlations;
}

double mean_u_of(const Offsets& offsets) { return mean_of(each(offsets, &Offset::mean_u)); }

std::int64_t better_of(const Lattice& lattice, const Offsets& offsets) {
    return std::ranges::count_if(offsets, [&](const Offset& offset) { return offset.mean_u < lattice.own().mean_u; });
}

std::string group_text(const Lattice& lattice, const Offsets& offsets, const char* vector) {
    if (offsets.empty()) return fmt::format("none has a vector {}", vector);
    return fmt::format("{} have a vector {}, of which {} have a lower mean u than p = {}, their mean {:.4f}",
                       offsets.size(), vector, better_of(lattice, offsets), lattice.reference, mean_u_of(offsets));
}

std::string finding_of_spread(const Lattice& lattice) {
    Offsets both = lattice.longer;
    both.insert(both.end(), lattice.as_long.begin(), lattice.as_long.end());
    const double own = lattice.own().mean_u;
    const char* verdict =
        both.empty() || better_of(lattice, both) == 0 ? "So nothing is gained beyond sqrt(P), as the paper says."
        : mean_u_of(both) <= own ? "So these are not worse on the whole: against the paper, offsets beyond sqrt(P) do "
                                   "more than turn the direction of the bias."
                                 : "So these are worse on the whole, as the paper says, but not each of them.";
    return fmt::format("Of the offsets beyond {} (u = {:.4f}), {}; {}. {}", lattice.reference, own,
                       group_text(lattice, lattice.longer, "longer than its own"),
                       group_text(lattice, lattice.as_long, "as long"), verdict);
}

std::string finding_of_best(const Lattice& lattice) {
    const Offset &best = lattice.best(), &own = lattice.own();
    return fmt::format(
        "Best of all {} is p = {}, mean u = {:.4f}: a largest load {:.1f} % below that of p = {}, which has a mean "
        "rank of {:.1f}.",
        lattice.side, best.p, best.mean_u, 100 * (1 - (1 + best.mean_u) / (1 + own.mean_u)), own.p, own.mean_rank);
}

std::string finding_of_rest(const Lattice& lattice) {
    const Offset& own = lattice.own();
    const std::uint32_t mirror = lattice.side - own.p;
    const Offsets rest = where(lattice.all, [&](const Offset& offset) {
        return offset.p > own.p && offset.p < mirror && offset.length < own.length;
    });
    return fmt::format("Of the {} offsets from {} to {} with a shorter vector, {} are worse than p = {}.", rest.size(),
                       own.p + 1, mirror - 1,
                       std::ranges::count_if(rest, [&](const Offset& offset) { return offset.mean_u > own.mean_u; }),
                       own.p);
}

std::string finding_of_correlation(const Lattice& lattice, const std::vector<double>& correlations) {
    constexpr double kTells = -0.5;
    const auto [least, most] = std::minmax_element(correlations.begin(), correlations.end());
    const char* verdict = *most <= kTells   ? "in every scene a longer shortest vector goes with a lower u"
                          : *least > kTells ? "in no scene does the shortest vector tell much about u"
                                            : "the shortest vector tells u in some scenes and not in others";
    const double half = lattice.own().length / 2;
    return fmt::format(
        "Rank correlation of u with the shortest vector over all offsets: {:.2f} to {:.2f}; {} (\"tells\": {} or "
        "below). Over the offsets with a vector of {:.1f} pixels or more it is {:.2f} in the mean.",
        *least, *most, verdict, kTells, half, mean_of(correlations_of(lattice, half)));
}

std::vector<Comparison> comparisons_of(const Lattice& lattice, const std::vector<double>& correlations) {
    const Offset& best = lattice.best();
    std::vector<Comparison> all = {
        {fmt::format("mean u, p = {}", lattice.reference), "", std::nullopt, lattice.own().mean_u},
        {"lowest mean u of all offsets", "", std::nullopt, best.mean_u, fmt::format("p = {}", best.p)}};
    const auto add = [&](const char* vector, const Offsets& offsets) {
        all.push_back({fmt::format("offsets beyond {}, {}", lattice.reference, vector), "", std::nullopt,
                       double(offsets.size()), joined(offsets, ", ", &Offset::p)});
        all.push_back({fmt::format("... better than p = {}", lattice.reference), "", std::nullopt,
                       double(better_of(lattice, offsets)),
                       "the paper: beyond sqrt(P) only the direction of the bias turns"});
    };
    add("longer vector", lattice.longer);
    add("as long", lattice.as_long);
    all.push_back(
        {"rank correlation of u and shortest vector", "", std::nullopt, mean_of(correlations), "mean of the scenes"});
    return all;
}

Scenes five_scenes() {
    const std::vector<std::string> names = {"centre", "mirrors", "glass", "random-12", "random-30"};
    return where(paper_like_scenes(),
                 [&](const LabelledScene& scene) { return std::ranges::count(names, scene.label) > 0; });
}

}  // namespace

std::uint64_t shortest_square(std::uint32_t offset, std::uint32_t side) {
    std::uint64_t least = std::uint64_t{side} * side;  // (0, N)
    for (std::uint64_t rows = 1; rows * rows < least; ++rows) {
        const std::uint64_t right = rows * offset % side, columns = std::min(right, side - right);
        least = std::min(least, rows * rows + columns * columns);
    }
    return least;
}

SpreadOffsets well_spread_offsets(std::uint32_t side, std::uint32_t reference) {
    SpreadOffsets offsets;
    const std::uint64_t own = shortest_square(reference, side);
    for (std::uint32_t p = reference + 1; p < side; ++p) {
        if (p == side - reference) continue;
        if (shortest_square(p, side) > own) offsets.longer.push_back(p);
        if (shortest_square(p, side) == own) offsets.as_long.push_back(p);
    }
    return offsets;
}

std::vector<double> ranks_of(const std::vector<double>& values) {
    std::vector<std::size_t> order(values.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return values[a] < values[b]; });
    std::vector<double> ranks(values.size());
    for (std::size_t first = 0; first < order.size();) {
        std::size_t last = first;  // one behind the values that are equal
        while (last < order.size() && values[order[last]] == values[order[first]]) ++last;
        const double shared = static_cast<double>(first + 1 + last) / 2;
        for (; first < last; ++first) ranks[order[first]] = shared;
    }
    return ranks;
}

double rank_correlation(const std::vector<double>& a, const std::vector<double>& b) {
    const std::vector<double> ra = ranks_of(a), rb = ranks_of(b);
    const double mean = (static_cast<double>(a.size()) + 1) / 2;
    double both = 0, of_a = 0, of_b = 0;
    for (std::size_t i = 0; i < a.size(); ++i) {
        both += (ra[i] - mean) * (rb[i] - mean);
        of_a += (ra[i] - mean) * (ra[i] - mean);
        of_b += (rb[i] - mean) * (rb[i] - mean);
    }
    return of_a > 0 && of_b > 0 ? both / std::sqrt(of_a * of_b) : 0;
}

StudyPage lattice_page(const std::vector<const Costs*>& scenes) {
    const Lattice lattice = lattice_of(scenes);
    const std::vector<double> correlations = correlations_of(lattice, 0);
    const std::uint32_t side = lattice.side, reference = lattice.reference;
    StudyPage page =
        page_about("lattice", {{"scenes", lattice.scenes}, {"size", side}, {"pes", side}, {"reference", reference}},
                   {{"labels", fmt::format("{}", fmt::join(lattice.scenes, ", "))},
                    {"length", fmt::format("{:.2f}", lattice.own().length)},
                    {"mirror", side - reference}});
    page.comparisons = comparisons_of(lattice, correlations);
    page.findings = {finding_of_spread(lattice), finding_of_best(lattice), finding_of_rest(lattice),
                     finding_of_correlation(lattice, correlations)};
    page.tables = tables_of(lattice);
    page.plots = {plot_of(lattice, "lattice", "Imbalance against the shortest distance between two pixels of a PE",
                          "shortest vector of the lattice (pixels)", &Offset::length, PlotStyle::kPoints),
                  plot_of(lattice, "lattice-offsets", "Imbalance against the offset", "offset p (pixels)", &Offset::p,
                          PlotStyle::kLine)};
    return page;
}

StudyPage study_lattice(Laboratory& lab, const Scenes& scenes) {
    return lattice_page(each(scenes.empty() ? five_scenes() : scenes,
                             [&](const LabelledScene& scene) { return &lab.costs(scene, lab.size(256)); }));
}

}  // namespace raya
