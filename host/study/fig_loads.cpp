// Figs 7 and 12: the load of each PE, of the first pass and of supersampling, over the mean load.
#include <span>

#include "host/ring/schedule.hpp"
#include "host/study/arrays.hpp"
#include "host/study/balance.hpp"
#include "host/study/prose.hpp"
#include "host/study/studies.hpp"

namespace raya {
namespace {

constexpr std::uint32_t kOffset = 16;  // the paper's
constexpr double kFlat = 0.1;  // ours: mean loads by which the middle may differ from the sides and yet be called flat

// The loads of one picture under the column split and the cyclic mapping.
struct Loads {
    Load columns, cyclic;
};

Loads loads_of(const CostImage& image) {
    return {static_load(image, cyclic(image.width, 0)), static_load(image, cyclic(image.width, kOffset % image.width))};
}

// Over the mean load; 1 where there is no load.
double share(const Load& load, std::size_t pe) {
    return load.mean > 0 ? static_cast<double>(load.per_pe[pe]) / load.mean : 1;
}

struct PeLoad {
    std::size_t pe;
    std::uint64_t columns, cyclic;               // cycles, of the picture
    double columns_share, cyclic_share;          // over the mean load
    Estimate columns_of_views, cyclic_of_views;  // shares
};

// Mean load of the PEs `first` to `last` - 1, over that of all.
double mean_between(const Load& load, std::size_t first, std::size_t last) {
    double sum = 0;
    for (std::size_t pe = first; pe < last; ++pe) sum += share(load, pe);
    return sum / static_cast<double>(last - first);
}

// Mean loads of the middle quarter of the PEs, and of the quarter at both sides.
double middle_of(const Load& load) {
    const std::size_t size = load.per_pe.size(), eighth = size / 8, middle = size / 2;
    return mean_between(load, middle - eighth, middle + eighth);
}
double sides_of(const Load& load) {
    const std::size_t size = load.per_pe.size(), eighth = size / 8;
    return (mean_between(load, 0, eighth) + mean_between(load, size - eighth, size)) / 2;
}

double columns_hump(const Loads& loads) { return middle_of(loads.columns) - sides_of(loads.columns); }
double cyclic_hump(const Loads& loads) { return middle_of(loads.cyclic) - sides_of(loads.cyclic); }
double columns_u(const Loads& loads) { return loads.columns.imbalance; }
double cyclic_u(const Loads& loads) { return loads.cyclic.imbalance; }

std::vector<Claim> claims_of(const BalancePass& pass, const std::vector<Loads>& views) {
    const Estimate columns = mean_of_each(views, columns_hump), cyclic = mean_of_each(views, cyclic_hump);
    const bool flat = cyclic.low() >= -kFlat && cyclic.high() <= kFlat;
    const bool uneven = cyclic.high() < -kFlat || cyclic.low() > kFlat;
    const char* const place = pass.first ? "Fig. 7" : "Fig. 12";
    const std::string over = fmt::format("Over {} views a PE of the middle quarter carries ", views.size());
    return {{paper::kSpa, place, "With p = 0 the load has a hump in the middle.",
             verdict_of(columns.low() > 0, columns.high() <= 0),
             over + with_interval(columns, 2) + " mean loads more than one of the quarter at the sides."},
            {paper::kSpa, place, "With p = 16 the load is flat.", verdict_of(flat, uneven),
             over + with_interval(cyclic, 2) +
                 fmt::format(" mean loads more than one at the sides; flat is called what is within {}.", kFlat)}};
}

std::vector<PeLoad> rows_of(const Loads& picture, const std::vector<Loads>& views) {
    std::vector<PeLoad> rows;
    for (std::size_t pe = 0; pe < picture.columns.per_pe.size(); ++pe)
        rows.push_back({pe, picture.columns.per_pe[pe], picture.cyclic.per_pe[pe], share(picture.columns, pe),
                        share(picture.cyclic, pe),
                        mean_of_each(views, [&](const Loads& loads) { return share(loads.columns, pe); }),
                        mean_of_each(views, [&](const Loads& loads) { return share(loads.cyclic, pe); })});
    return rows;
}

std::vector<StudyPlot> plots_of(const BalancePass& pass, const std::vector<PeLoad>& rows) {
    const std::string y = "load / mean load";
    const double last = pass.size - 1.0;
    StudyPlot picture{pass.first ? "fig7" : "fig12", fmt::format("Load of each PE, {}, {}", pass.scene, pass.phase()),
                      "PE", y};
    picture.series = {line("p = 0, column split", rows, &PeLoad::pe, &PeLoad::columns_share),
                      line("p = 16, cyclic mapping", rows, &PeLoad::pe, &PeLoad::cyclic_share),
                      {"mean", {0, last}, {1, 1}}};
    StudyPlot views = picture;
    views.name += "-views";
    views.title = fmt::format("Load of each PE, {}, mean of {} views", pass.phase(), pass.ensemble.views.size());
    const auto some =
        where(rows, [&](const PeLoad& row) { return row.pe % std::max<std::size_t>(rows.size() / 64, 1) == 0; });
    views.series[0] = line_with_bars("p = 0, column split", some, &PeLoad::pe, &PeLoad::columns_of_views);
    views.series[1] = line_with_bars("p = 16, cyclic mapping", some, &PeLoad::pe, &PeLoad::cyclic_of_views);
    return {picture, views};
}

std::vector<Comparison> comparisons_of(const BalancePass& pass, const Loads& picture, const std::vector<Loads>& views) {
    const Estimate columns = mean_of_each(views, columns_u), cyclic = mean_of_each(views, cyclic_u);
    const char* const calibrated = pass.in_paper() ? "calibrated on: see scenes/README.md" : "";
    return {{"u(0)", "", pass.paper(paper::kImbalance0), columns_u(picture), calibrated, Source::kDerived},
            {"u(16)", "", pass.paper(paper::kImbalance16), cyclic_u(picture),
             pass.in_paper() ? paper::kImbalance16Rounding : "", Source::kDerived},
            {"u(0), mean of views", "", pass.paper(paper::kImbalance0), columns.mean, "", Source::kDerived,
             columns.half_width},
            {"u(16), mean of views", "", pass.paper(paper::kImbalance16), cyclic.mean, "", Source::kDerived,
             cyclic.half_width}};
}

std::string finding_of(const Loads& picture) {
    const Load& cyclic = picture.cyclic;
    return finding("fig7", "picture", "middle"_a = middle_of(picture.columns), "outer"_a = sides_of(picture.columns),
                   "lightest"_a = cyclic.mean > 0 ? static_cast<double>(cyclic.min) / cyclic.mean : 1,
                   "heaviest"_a = 1 + cyclic.imbalance);
}

std::string finding_of_views(const std::vector<Loads>& views) {
    return finding("fig7", "views", "views"_a = views.size(),
                   "columns"_a = with_interval(mean_of_each(views, columns_u)),
                   "columns_range"_a = range_text(each(views, columns_u)),
                   "cyclic"_a = with_interval(mean_of_each(views, cyclic_u)),
                   "cyclic_range"_a = range_text(each(views, cyclic_u)));
}

StudyPage loads_page(const std::string& name, const BalancePass& pass) {
    const Loads picture = loads_of(pass.image(*pass.ensemble.picture));
    const auto views = each(pass.ensemble.views, [&](const Costs* costs) { return loads_of(pass.image(*costs)); });
    const auto rows = rows_of(picture, views);
    Json settings = settings_of(pass);
    settings["offsets"] = std::vector{0u, kOffset % pass.size};
    StudyPage page = page_about(name, settings);
    page.comparisons = comparisons_of(pass, picture, views);
    page.claims = claims_of(pass, views);
    page.findings = {finding_of(picture), finding_of_views(views)};
    const auto mean = [](Estimate PeLoad::*of) { return [=](const PeLoad& row) { return (row.*of).mean; }; };
    const auto half = [](Estimate PeLoad::*of) { return [=](const PeLoad& row) { return (row.*of).half_width; }; };
    page.tables = {table_of(page.name, "Load of each PE", rows,
                            {{"PE", &PeLoad::pe},
                             {"p = 0", &PeLoad::columns, "cycles"},
                             {"p = 16", &PeLoad::cyclic, "cycles"},
                             {"p = 0, mean of views", mean(&PeLoad::columns_of_views)},
                             {"p = 0, +-", half(&PeLoad::columns_of_views)},
                             {"p = 16, mean of views", mean(&PeLoad::cyclic_of_views)},
                             {"p = 16, +-", half(&PeLoad::cyclic_of_views)}},
                            false)};
    page.plots = plots_of(pass, rows);
    page.news = {sentence("fig7", "news")};
    return page;
}

}  // namespace

StudyPage study_fig7(Laboratory& lab, const Scenes& scenes) {
    return loads_page("fig7", balance_pass(lab, scenes, AntialiasMethod::kNone));
}

StudyPage study_fig12(Laboratory& lab, const Scenes& scenes) {
    return loads_page("fig12", balance_pass(lab, scenes, AntialiasMethod::kSupersample));
}

}  // namespace raya
