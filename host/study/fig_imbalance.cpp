// Figs 8 and 13: the imbalance u of each offset, of the first pass and of supersampling: one picture and many views,
// beside the lattice of each offset.
#include <cmath>
#include <numeric>
#include <span>

#include "host/ring/schedule.hpp"
#include "host/study/arrays.hpp"
#include "host/study/balance.hpp"
#include "host/study/lattice.hpp"
#include "host/study/prose.hpp"
#include "host/study/studies.hpp"

namespace raya {
namespace {

constexpr double kAlreadyGood = 0.9;  // ours: the part of all that an offset of 0..n gains over p = 0

// One offset, in the picture and in each view.
struct Offset {
    std::uint32_t p;
    double u;
    std::vector<double> views;
    Estimate mean{};
    std::size_t best_of_near = 0;  // views in which none of 0..n is better

    double mean_u() const { return mean.mean; }
    double half_width() const { return mean.half_width; }
    double least() const { return std::ranges::min(views); }
    double most() const { return std::ranges::max(views); }
};
using Offsets = std::vector<Offset>;

// All offsets, and n, the paper's best, the root of the number of PEs.
struct Imbalance {
    std::uint32_t root;
    Offsets all;

    std::size_t views() const { return all[0].views.size(); }
    std::span<const Offset> near() const { return std::span(all).first(root + 1); }
    const Offset& own() const { return all[root]; }
    const Offset& best_near() const { return least(near(), &Offset::mean_u); }
};

// Of u(p) - u(n) in the same view, so sure that what is said of all `tests` offsets holds with 95 %.
Estimate difference(const Offset& offset, const Offset& own, std::size_t tests) {
    std::vector<double> differences;
    for (std::size_t i = 0; i < own.views.size(); ++i) differences.push_back(offset.views[i] - own.views[i]);
    return estimate_of(differences, each_of(tests));
}

Imbalance imbalance_of(const BalancePass& pass) {
    std::vector<std::uint32_t> offsets(pass.size);
    std::iota(offsets.begin(), offsets.end(), 0u);
    const auto u_of = [&](const Costs* costs) {
        return imbalance_of_offsets(pass.image(*costs), pass.size, RAYA_FOLD_CYCLIC, offsets);
    };
    const std::vector<double> picture = u_of(pass.ensemble.picture);
    const auto views = each(pass.ensemble.views, u_of);
    Imbalance imbalance{root_offset(pass.size), {}};
    for (const std::uint32_t p : offsets) {
        Offset offset{p, picture[p], each(views, [&](const std::vector<double>& u) { return u[p]; })};
        offset.mean = estimate_of(offset.views);
        for (const std::vector<double>& u : views)
            offset.best_of_near += u[p] <= *std::min_element(u.begin(), u.begin() + imbalance.root + 1);
        imbalance.all.push_back(std::move(offset));
    }
    return imbalance;
}

// --- what the paper says

Claim claim_of_best(const BalancePass& pass, const Imbalance& im) {
    const std::size_t tests = im.near().size() - 1;
    std::vector<std::uint32_t> better, worse;
    for (const Offset& offset : im.near()) {
        const Estimate d = difference(offset, im.own(), tests);
        if (offset.p != im.root && d.low() > 0) worse.push_back(offset.p);
        if (offset.p != im.root && d.high() < 0) better.push_back(offset.p);
    }
    const Offset& best = im.best_near();
    std::string why =
        finding("fig8", "best", "root"_a = im.root, "views"_a = im.views(), "own"_a = with_interval(im.own().mean),
                "best"_a = best.p, "least"_a = with_interval(best.mean), "worse"_a = worse.size(), "others"_a = tests,
                "better"_a = better.size(), "first"_a = im.own().best_of_near);
    return {paper::kSpa, pass.first ? "Fig. 8" : "Fig. 13",
            "Of the offsets 0..n on n x n PEs p = n gives the best balance.",
            verdict_of(worse.size() == tests, !better.empty()), std::move(why)};
}

Claim claim_of_half(const Imbalance& im) {
    const std::uint32_t half = im.root / 2;
    std::vector<double> parts;
    for (std::size_t i = 0; i < im.views(); ++i) {
        double best = im.all[0].views[i];
        for (const Offset& offset : im.near()) best = std::min(best, offset.views[i]);
        const double gain = im.all[0].views[i] - best;
        parts.push_back(gain > 0 ? (im.all[0].views[i] - im.all[half].views[i]) / gain : 1);
    }
    const Estimate part = estimate_of(parts);
    return {paper::kSpa, "Fig. 8", "The balance is already good at p = 8, half of n.",
            verdict_of(part.low() >= kAlreadyGood, part.high() < kAlreadyGood),
            finding("fig8", "half", "half"_a = half, "part"_a = with_interval(part, 2), "rule"_a = kAlreadyGood)};
}

Claim claim_of_draw(const Imbalance& im) {
    return {paper::kSpa, "Fig. 8", "u is 0.118 at p = 16 (derived from Table 3).",
            verdict_among(paper::kImbalance16, im.own().views),
            finding("fig8", "draw", "views"_a = im.views(), "range"_a = range_text(im.own().views),
                    "prediction"_a = prediction_text(im.own().views), "mean"_a = with_interval(im.own().mean))};
}

Claim claim_of_gain(const BalancePass& pass, const Imbalance& im) {
    const Estimate gain = difference(im.all[0], im.own(), 1);
    return {paper::kSpa, pass.first ? "Fig. 8" : "Fig. 13", "The cyclic mapping with p = n balances better than p = 0.",
            verdict_of(gain.low() > 0, gain.high() <= 0),
            fmt::format("u falls by {} from p = 0 to p = {} in the same view, {} views.", with_interval(gain), im.root,
                        im.views())};
}

std::vector<Claim> claims_of(const BalancePass& pass, const Imbalance& im) {
    std::vector<Claim> claims = {claim_of_gain(pass, im), claim_of_best(pass, im)};
    if (pass.first) claims.push_back(claim_of_half(im));
    if (pass.in_paper()) claims.push_back(claim_of_draw(im));
    return claims;
}

// --- the page

std::vector<Comparison> comparisons_of(const BalancePass& pass, const Imbalance& im) {
    const auto paper = [&](std::uint32_t p) -> std::optional<double> {
        return p == 0 ? pass.paper(paper::kImbalance0) : p == 16 ? pass.paper(paper::kImbalance16) : std::nullopt;
    };
    std::vector<Comparison> all;
    for (const std::uint32_t p : {0u, 8u, 16u}) {
        const Offset& offset = im.all[p % pass.size];
        const char* const remark = !pass.in_paper() ? ""
                                   : p == 0         ? "calibrated on: see scenes/README.md"
                                   : p == 16        ? paper::kImbalance16Rounding
                                                    : "the paper: \"already good\"";
        all.push_back({fmt::format("u({})", p), "", paper(p), offset.u, remark, Source::kDerived});
        all.push_back({fmt::format("u({}), mean of views", p), "", paper(p), offset.mean_u(),
                       fmt::format("{} of single views", range_text(offset.views)), Source::kDerived,
                       offset.half_width()});
    }
    const auto best = [](const Offset& offset, double u) {
        return std::pair(double(offset.p), fmt::format("u = {:.3f}", u));
    };
    const auto add = [&](const std::string& what, const Offset& offset, double u) {
        const auto [p, remark] = best(offset, u);
        all.push_back({what, "", std::nullopt, p, remark});
    };
    const Offset &one = least(im.near(), &Offset::u), &of_all = least(im.all, &Offset::u),
                 &mean_of_all = least(im.all, &Offset::mean_u);
    add(fmt::format("best p of 0..{}", im.root), one, one.u);
    all.back().paper = pass.paper(16);
    add(fmt::format("best p of 0..{}, mean of views", im.root), im.best_near(), im.best_near().mean_u());
    all.back().paper = pass.paper(16);
    add(fmt::format("best p of all {}", im.all.size()), of_all, of_all.u);
    add(fmt::format("best p of all {}, mean of views", im.all.size()), mean_of_all, mean_of_all.mean_u());
    return all;
}

std::vector<StudyTable> tables_of(const std::string& name, std::uint32_t side, const Imbalance& im) {
    const std::vector<Column<Offset>> columns = {
        {"p", &Offset::p},
        {"u", &Offset::u},
        {"mean u", &Offset::mean_u},
        {"+-", &Offset::half_width},
        {"least u", &Offset::least},
        {"largest u", &Offset::most},
        {fmt::format("best of 0..{}", im.root), &Offset::best_of_near, "views"},
        {"shortest vector",
         [side](const Offset& offset) { return std::sqrt(static_cast<double>(shortest_square(offset.p, side))); },
         "pixels"}};
    return {table_of(name + "-near",
                     fmt::format("Offsets 0..{}: the picture's u and that of {} views", im.root, im.views()), im.near(),
                     columns),
            table_of(name, "Imbalance for each offset", im.all, columns, false)};
}

std::vector<StudyPlot> plots_of(const std::string& name, const BalancePass& pass, const Imbalance& im) {
    const std::string over = "Imbalance against ", axis = "offset p (pixels)";
    std::vector<StudyPlot> plots = {{name, over + "the offset, " + pass.phase(), axis, "u"},
                                    {name + "-all", over + "every offset, " + pass.phase(), axis, "u", Axes::kLogY}};
    const std::string mean = fmt::format("mean of {} views", im.views());
    const auto few = where(im.all, [&](const Offset& offset) { return offset.p % 4 == 0; });
    plots[0].series = {line_with_bars(mean, im.near(), &Offset::p, &Offset::mean),
                       line(pass.scene + ", one picture", im.near(), &Offset::p, &Offset::u),
                       line("least of the views", im.near(), &Offset::p, &Offset::least),
                       line("largest of the views", im.near(), &Offset::p, &Offset::most)};
    plots[1].series = {line(mean, im.all, &Offset::p, &Offset::mean_u),
                       line_with_bars("its interval, every fourth", few, &Offset::p, &Offset::mean, PlotStyle::kPoints),
                       line(pass.scene + ", one picture", im.all, &Offset::p, &Offset::u)};
    for (StudyPlot& plot : plots)
        if (pass.in_paper())
            plot.series.push_back({"Kohata & Ito, from their tables",
                                   {0, 16},
                                   {paper::kImbalance0, paper::kImbalance16},
                                   PlotStyle::kPaper});
    return plots;
}

std::string finding_of_views(const Imbalance& im) {
    const auto at = [&](std::uint32_t p) { return with_interval(im.all[p % im.all.size()].mean); };
    return finding("fig8", "views", "views"_a = im.views(), "at_0"_a = at(0), "at_8"_a = at(8), "at_16"_a = at(16));
}

std::string finding_of_picture(const Imbalance& im) {
    const auto at = [&](std::uint32_t p) { return im.all[p % im.all.size()].u; };
    const Offset &near = least(im.near(), &Offset::u), &best = least(im.all, &Offset::u);
    const auto better = std::ranges::count_if(im.all, [&](const Offset& offset) { return offset.u < at(16); });
    return finding("fig8", "picture", "at_0"_a = at(0), "at_8"_a = at(8), "at_16"_a = at(16), "root"_a = im.root,
                   "near"_a = near.p, "near_u"_a = near.u, "count"_a = im.all.size(), "best"_a = best.p,
                   "best_u"_a = best.u, "better"_a = better);
}

StudyPage imbalance_page(const std::string& name, const BalancePass& pass) {
    const Imbalance im = imbalance_of(pass);
    StudyPage page = page_about(name, settings_of(pass), {{"tests", im.near().size() - 1}});
    page.comparisons = comparisons_of(pass, im);
    page.claims = claims_of(pass, im);
    page.findings = {finding_of_views(im), page.claims[1].why, finding_of_picture(im)};
    page.tables = tables_of(name, pass.size, im);
    page.plots = plots_of(name, pass, im);
    page.news = {sentence("fig8", "news")};
    return page;
}

}  // namespace

StudyPage study_fig8(Laboratory& lab, const Scenes& scenes) {
    return imbalance_page("fig8", balance_pass(lab, scenes, AntialiasMethod::kNone));
}

StudyPage study_fig13(Laboratory& lab, const Scenes& scenes) {
    return imbalance_page("fig13", balance_pass(lab, scenes, AntialiasMethod::kSupersample));
}

}  // namespace raya
