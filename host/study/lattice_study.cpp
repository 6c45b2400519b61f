// Are offsets beyond sqrt(P) worse? Each offset's imbalance over several scenes beside its lattice.
#include <algorithm>
#include <cmath>
#include <numeric>

#include "host/ring/schedule.hpp"
#include "host/study/arrays.hpp"
#include "host/study/lattice.hpp"
#include "host/study/lattice_rows.hpp"
#include "host/study/paper.hpp"
#include "host/study/prose.hpp"
#include "host/study/rows.hpp"
#include "host/study/studies.hpp"

namespace raya {
namespace {

constexpr double kNothing = 0.02;  // ours: a part of the mean load that is no gain worth an offset

using Offset = LatticeOffset;
using Offsets = LatticeOffsets;

std::vector<StudyTable> tables_of(const Lattice& lattice) {
    Offsets chosen = lattice.some({0, lattice.reference});
    for (const Offsets* group : {&lattice.longer, &lattice.as_long})
        chosen.insert(chosen.end(), group->begin(), group->end());
    if (std::ranges::find(chosen, lattice.best().p, &Offset::p) == chosen.end()) chosen.push_back(lattice.best());
    std::vector<Column<Offset>> columns = {{"p", &Offset::p},
                                           {"shortest vector", &Offset::length, "pixels"},
                                           {"mean u", &Offset::mean_u},
                                           {"+-", &Offset::half_width},
                                           {"mean rank", &Offset::mean_rank}};
    std::vector<Column<Offset>> whole = columns;
    for (const SceneViews& scene : lattice.scenes)
        whole.push_back({"u, " + scene.label, [&scene](const Offset& offset) { return scene.mean_u(offset); }});
    whole.push_back({"n x n blocks shared", [](const Offset& offset) { return offset.blocks ? "yes" : "no"; }});
    columns.back().label = fmt::format("mean rank of {}", lattice.side);
    columns.push_back({fmt::format("pictures better than p = {}", lattice.reference), &Offset::wins});
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
        return line_with_bars(label, some, x, &Offset::mean, PlotStyle::kPoints);
    };
    return {name,
            title,
            x_label,
            fmt::format("u, mean of {} pictures", lattice.pictures()),
            Axes::kLogY,
            {line("every offset", lattice.all, x, &Offset::mean_u, style),
             points(fmt::format("beyond {}, longer vector", lattice.reference), lattice.longer),
             points(fmt::format("beyond {}, as long", lattice.reference), lattice.as_long),
             points(fmt::format("p = {}", lattice.reference), {lattice.own()})}};
}

double mean_of(const std::vector<double>& values) { return estimate_of(values).mean; }

// Of each picture's u with the shortest vector, over the offsets whose vector is so long or longer.
std::vector<double> correlations_of(const Lattice& lattice, double least_length) {
    const Offsets some = where(lattice.all, [&](const Offset& offset) { return offset.length >= least_length; });
    std::vector<double> correlations;
    for (std::size_t n = 0; n < lattice.pictures(); ++n)
        correlations.push_back(rank_correlation(each(some, &Offset::length),
                                                each(some, [n](const Offset& offset) { return offset.u[n]; })));
    return correlations;
}

double mean_u_of(const Offsets& offsets) { return mean_of(each(offsets, &Offset::mean_u)); }

std::int64_t better_of(const Lattice& lattice, const Offsets& offsets) {
    return std::ranges::count_if(offsets,
                                 [&](const Offset& offset) { return offset.mean_u() < lattice.own().mean_u(); });
}

std::string group_text(const Lattice& lattice, const Offsets& offsets, const char* vector) {
    if (offsets.empty()) return fmt::format("none has a vector {}", vector);
    return fmt::format("{} have a vector {}, of which {} have a lower mean u than p = {}, their mean {:.4f}",
                       offsets.size(), vector, better_of(lattice, offsets), lattice.reference, mean_u_of(offsets));
}

Offsets both_of(const Lattice& lattice) {
    Offsets both = lattice.longer;
    both.insert(both.end(), lattice.as_long.begin(), lattice.as_long.end());
    return both;
}

std::string finding_of_spread(const Lattice& lattice) {
    const Offsets both = both_of(lattice);
    std::string verdict = "So nothing can be gained beyond sqrt(P).";
    if (!both.empty()) {
        const Estimate gain = difference(both, lattice.own());
        verdict = fmt::format("In the same picture their mean u is {} above that of p = {}: {}.",
                              with_interval(gain, 4), lattice.reference,
                              gain.high() < 0  ? "they are better on the whole"
                              : gain.low() > 0 ? "they are worse on the whole"
                                               : "no difference can be told");
    }
    return fmt::format("Of the offsets beyond {} (u = {}), {}; {}. {}", lattice.reference,
                       with_interval(lattice.own().mean, 4), group_text(lattice, lattice.longer, "longer than its own"),
                       group_text(lattice, lattice.as_long, "as long"), verdict);
}

// Whether 0..n is enough: no offset beyond gains more than nothing over the best of them, or one does.
Claim claim_of_enough(const Lattice& lattice) {
    const Offset& near = lattice.best_near();
    const auto beyond = std::span<const Offset>(lattice.all).subspan(lattice.reference + 1);
    bool none = true, one = false;
    std::size_t better = 0;
    for (const Offset& offset : beyond) {
        const Estimate gain = difference({&offset, 1}, near, beyond.size());
        none = none && gain.low() >= -kNothing;
        one = one || gain.high() < -kNothing;
        better += gain.high() < 0;
    }
    const Offset& best = least(beyond, &Offset::mean_u);
    return {paper::kSpa, "section on the cyclic mapping",
            "Offsets beyond n = sqrt(P) only turn the direction of the bias, so 0..n is enough.", verdict_of(none, one),
            finding("lattice", "enough", "pictures"_a = lattice.pictures(), "near"_a = near.p,
                    "near_u"_a = with_interval(near.mean), "best"_a = best.p, "best_u"_a = with_interval(best.mean),
                    "better"_a = better, "beyond"_a = beyond.size(), "nothing"_a = kNothing)};
}

Claim claim_of_blocks(const Lattice& lattice) {
    const bool shared = lattice.own().blocks && lattice.reference * lattice.reference == lattice.side;
    const Offsets all = where(lattice.all, &Offset::blocks);
    return {paper::kSpa, "section on the cyclic mapping",
            "With p = n on n x n PEs every n x n block is shared by all PEs, a pixel each.",
            verdict_of(shared, !shared),
            finding("lattice", "blocks", "own"_a = shared ? "do" : "do not", "n"_a = lattice.reference,
                    "count"_a = all.size(), "others"_a = joined(all, ", ", &Offset::p))};
}

std::string finding_of_best(const Lattice& lattice) {
    const Offset &best = lattice.best(), &own = lattice.own();
    return fmt::format(
        "Best of all {} is p = {}, mean u = {:.4f}: a largest load {:.1f} % below that of p = {}, which has a mean "
        "rank of {:.1f}.",
        lattice.side, best.p, best.mean_u(), 100 * (1 - (1 + best.mean_u()) / (1 + own.mean_u())), own.p,
        own.mean_rank);
}

std::string finding_of_rest(const Lattice& lattice) {
    const Offset& own = lattice.own();
    const std::uint32_t mirror = lattice.side - own.p;
    const Offsets rest = where(lattice.all, [&](const Offset& offset) {
        return offset.p > own.p && offset.p < mirror && offset.length < own.length;
    });
    return fmt::format(
        "Of the {} offsets from {} to {} with a shorter vector, {} are worse than p = {}.", rest.size(), own.p + 1,
        mirror - 1, std::ranges::count_if(rest, [&](const Offset& offset) { return offset.mean_u() > own.mean_u(); }),
        own.p);
}

std::string finding_of_correlation(const Lattice& lattice, const std::vector<double>& correlations) {
    constexpr double kTells = -0.5;
    const auto [least, most] = std::minmax_element(correlations.begin(), correlations.end());
    const char* verdict = *most <= kTells   ? "in every picture a longer shortest vector goes with a lower u"
                          : *least > kTells ? "in no picture does the shortest vector tell much about u"
                                            : "the shortest vector tells u in some pictures and not in others";
    const double half = lattice.own().length / 2;
    return fmt::format(
        "Rank correlation of u with the shortest vector over all offsets: {:.2f} to {:.2f}; {} (\"tells\": {} or "
        "below). Over the offsets with a vector of {:.1f} pixels or more it is {:.2f} in the mean.",
        *least, *most, verdict, kTells, half, mean_of(correlations_of(lattice, half)));
}

std::vector<Comparison> comparisons_of(const Lattice& lattice, const std::vector<double>& correlations) {
    const Offset& best = lattice.best();
    std::vector<Comparison> all = {{fmt::format("mean u, p = {}", lattice.reference), "", std::nullopt,
                                    lattice.own().mean_u(), "", Source::kPrinted, lattice.own().half_width()},
                                   {"lowest mean u of all offsets", "", std::nullopt, best.mean_u(),
                                    fmt::format("p = {}", best.p), Source::kPrinted, best.half_width()}};
    const auto add = [&](const char* vector, const Offsets& offsets) {
        all.push_back({fmt::format("offsets beyond {}, {}", lattice.reference, vector), "", std::nullopt,
                       double(offsets.size()), joined(offsets, ", ", &Offset::p)});
        all.push_back({fmt::format("... better than p = {}", lattice.reference), "", std::nullopt,
                       double(better_of(lattice, offsets)),
                       "Kohata & Ito: beyond sqrt(P) only the direction of the bias turns"});
    };
    add("longer vector", lattice.longer);
    add("as long", lattice.as_long);
    all.push_back(
        {"rank correlation of u and shortest vector", "", std::nullopt, mean_of(correlations), "mean of the pictures"});
    return all;
}

Scenes five_scenes() {
    const std::vector<std::string> names = {"centre", "mirrors", "glass", "random-12", "random-30"};
    return where(paper_like_scenes(),
                 [&](const LabelledScene& scene) { return std::ranges::count(names, scene.label) > 0; });
}

}  // namespace

StudyPage lattice_page(const std::vector<Ensemble>& scenes) {
    const Lattice lattice = lattice_of(scenes);
    const std::vector<double> correlations = correlations_of(lattice, 0);
    const std::uint32_t side = lattice.side, reference = lattice.reference;
    const auto labels = each(lattice.scenes, &SceneViews::label);
    StudyPage page = page_about(
        "lattice",
        {{"scenes", labels},
         {"size", side},
         {"pes", side},
         {"reference", reference},
         {"pictures", lattice.pictures()},
         {"views", each(lattice.scenes, [](const SceneViews& scene) { return scene.last - scene.first; })}},
        {{"labels",
          joined(lattice.scenes, ", ",
                 [](const SceneViews& s) { return fmt::format("{} ({} views)", s.label, s.last - s.first); })},
         {"length", fmt::format("{:.2f}", lattice.own().length)},
         {"mirror", side - reference}});
    page.comparisons = comparisons_of(lattice, correlations);
    page.claims = {claim_of_blocks(lattice)};
    if (lattice.pictures() > 1) page.claims.push_back(claim_of_enough(lattice));
    page.findings = {finding_of_spread(lattice), finding_of_best(lattice), finding_of_rest(lattice),
                     finding_of_correlation(lattice, correlations)};
    page.tables = tables_of(lattice);
    page.plots = {plot_of(lattice, "lattice", "Imbalance against the shortest distance between two pixels of a PE",
                          "shortest vector of the lattice (pixels)", &Offset::length, PlotStyle::kPoints),
                  plot_of(lattice, "lattice-offsets", "Imbalance against the offset", "offset p (pixels)", &Offset::p,
                          PlotStyle::kLine)};
    page.news = {sentence("lattice", "news")};
    return page;
}

StudyPage study_lattice(Laboratory& lab, const Scenes& scenes) {
    constexpr std::size_t kOthers = 16;  // views of each scene but the first, whose views Fig. 8 has too
    std::vector<Ensemble> ensembles;
    for (const LabelledScene& scene : scenes.empty() ? five_scenes() : scenes)
        ensembles.push_back(
            ensemble_of(lab, scene, lab.size(256), AntialiasMethod::kNone, ensembles.empty() ? kMostViews : kOthers));
    return lattice_page(ensembles);
}

}  // namespace raya
