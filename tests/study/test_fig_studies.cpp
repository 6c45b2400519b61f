// The studies of figures 7, 8, 12 and 13 against plain sums, and the paper's figures against arithmetic by hand.
#include <fmt/core.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <chrono>
#include <cmath>
#include <functional>

#include "host/cl/device.hpp"
#include "host/scene/random_view.hpp"
#include "host/study/ensemble.hpp"
#include "host/study/paper.hpp"
#include "host/study/studies.hpp"
#include "kernels/shared/mapping.h"
#include "tests/document.hpp"
#include "tests/study/study_cases.hpp"

namespace raya {
namespace {

using Sums = std::vector<std::uint64_t>;

// One PE for each column.
Sums loads_of(const CostImage& image, std::uint32_t p) {
    const std::uint32_t size = image.width;
    Sums loads(size);
    for (std::uint32_t row = 0; row < size; ++row)
        for (std::uint32_t column = 0; column < size; ++column)
            loads[raya_owner({size, size, size, p, RAYA_FOLD_CYCLIC}, row, column)] +=
                image.cycles[row * std::size_t{size} + column];
    return loads;
}

std::size_t root_of(std::uint32_t size) { return static_cast<std::size_t>(std::sqrt(size) + 0.5); }

double mean_of(const Sums& loads) {
    std::uint64_t sum = 0;
    for (std::uint64_t load : loads) sum += load;
    return static_cast<double>(sum) / static_cast<double>(loads.size());
}

double max_of(const Sums& loads) { return static_cast<double>(*std::max_element(loads.begin(), loads.end())); }

double imbalance_of(const Sums& loads) { return (max_of(loads) - mean_of(loads)) / mean_of(loads); }

std::vector<double> imbalances_of(const CostImage& image) {
    std::vector<double> all;
    for (std::uint32_t p = 0; p < image.width; ++p) all.push_back(imbalance_of(loads_of(image, p)));
    return all;
}

// The first offset of the least imbalance among the first `count`.
std::size_t best_of(const std::vector<double>& u, std::size_t count) {
    std::size_t best = 0;
    for (std::size_t p = 1; p < count; ++p)
        if (u[p] < u[best]) best = p;
    return best;
}

// A scene's picture and its views, each rendered by itself.
struct Pictures {
    std::uint32_t size;
    CostImage own;
    std::vector<CostImage> views;
};

Pictures pictures_of(Session& session, const LabelledScene& scene, std::uint32_t size, bool first = true) {
    const auto image = [&](const Scene& one) {
        Laboratory lab(session, 0);
        const Costs& costs =
            lab.costs({"x", one}, size, first ? AntialiasMethod::kNone : AntialiasMethod::kSupersample);
        return first ? costs.trace : costs.supersample;
    };
    Pictures pictures{size, image(scene.scene), {}};
    for (std::uint64_t seed = 1; seed <= view_count(scene.scene, size); ++seed)
        pictures.views.push_back(image(random_view(scene.scene, seed)));
    return pictures;
}

// Mean and half width of 95 %, Student's t of many by a table: 2.00 of 63 degrees of freedom.
void check_estimate(double mean, double half_width, const std::vector<double>& values) {
    double sum = 0, squares = 0;
    for (const double value : values) sum += value;
    const auto n = static_cast<double>(values.size());
    for (const double value : values) squares += (value - sum / n) * (value - sum / n);
    CHECK(mean == Approx(sum / n).epsilon(1e-12));
    REQUIRE(values.size() == 64);
    CHECK(half_width == Approx(1.99834 * std::sqrt(squares / (n - 1) / n)).epsilon(1e-5));
}

std::vector<double> of_each(const std::vector<CostImage>& views,
                            const std::function<double(const CostImage&)>& figure) {
    std::vector<double> values;
    for (const CostImage& view : views) values.push_back(figure(view));
    return values;
}

void check_loads_page(const StudyPage& page, const Pictures& pictures, bool printed) {
    check_page(page);
    const CostImage& image = pictures.own;
    const Sums columns = loads_of(image, 0), cyclic = loads_of(image, 16);
    CHECK(page.comparison("u(0)").ours == imbalance_of(columns));
    CHECK(page.comparison("u(16)").ours == imbalance_of(cyclic));
    for (const std::uint32_t p : {0u, 16u}) {
        const Comparison& mean = page.comparison(fmt::format("u({}), mean of views", p));
        check_estimate(mean.ours, mean.half_width.value(),
                       of_each(pictures.views, [&](const CostImage& view) { return imbalance_of(loads_of(view, p)); }));
    }
    for (const Comparison& c : page.comparisons) {
        CHECK(c.paper.has_value() == printed);
        CHECK(c.source == Source::kDerived);  // neither figure prints a number
    }
    REQUIRE(page.tables.size() == 1);
    REQUIRE(page.tables[0].rows.size() == image.width);
    for (std::size_t pe = 0; pe < image.width; ++pe) {
        CHECK(page.tables[0].at(pe, "PE") == Cell(pe));
        CHECK(page.tables[0].at(pe, "p = 0") == Cell(columns[pe]));
        CHECK(page.tables[0].at(pe, "p = 16") == Cell(cyclic[pe]));
        CHECK(page.plots.at(0).series.at(0).y.at(pe) ==
              Approx(static_cast<double>(columns[pe]) / mean_of(columns)).epsilon(1e-14));
        CHECK(page.plots[0].series.at(1).y.at(pe) ==
              Approx(static_cast<double>(cyclic[pe]) / mean_of(cyclic)).epsilon(1e-14));
    }
    const std::size_t pe = image.width / 2;
    check_estimate(page.value(page.name, pe, "p = 0, mean of views"), page.value(page.name, pe, "p = 0, +-"),
                   of_each(pictures.views, [&](const CostImage& view) {
                       const Sums loads = loads_of(view, 0);
                       return static_cast<double>(loads[pe]) / mean_of(loads);
                   }));
    CHECK(page.claims.size() == 2);
    CHECK_FALSE(page.news.empty());
}

// What the page says of the best offset, recomputed: how often n is best, and what its figures are in the picture.
void check_best(const StudyPage& page, const Pictures& pictures, const std::vector<double>& u,
                const std::vector<std::vector<double>>& views) {
    const std::size_t root = root_of(pictures.size), near = best_of(u, root + 1), best = best_of(u, u.size());
    const Comparison& of_all = page.comparison(fmt::format("best p of all {}", u.size()));
    CHECK(page.comparison(fmt::format("best p of 0..{}", root)).ours == static_cast<double>(near));
    CHECK(of_all.ours == static_cast<double>(best));
    CHECK(of_all.remark == fmt::format("u = {:.3f}", u[best]));
    const auto better = std::count_if(u.begin(), u.end(), [&](double value) { return value < u[16]; });
    CHECK_THAT(page.findings.at(2), Catch::Contains(fmt::format(" {} offsets are better than p = 16", better)));
    const auto wins = std::count_if(views.begin(), views.end(), [&](const std::vector<double>& view) {
        return view[root] <= *std::min_element(view.begin(), view.begin() + static_cast<std::ptrdiff_t>(root) + 1);
    });
    CHECK_THAT(page.findings.at(1),
               Catch::Contains(fmt::format("p = {} is the best of them in {} of {} views", root, wins, views.size())));
}

void check_imbalance_page(const StudyPage& page, const Pictures& pictures, bool printed) {
    check_page(page);
    const std::vector<double> u = imbalances_of(pictures.own);
    std::vector<std::vector<double>> views;
    for (const CostImage& view : pictures.views) views.push_back(imbalances_of(view));
    for (const std::size_t p : {0, 8, 16}) {
        CHECK(page.comparison(fmt::format("u({})", p)).ours == u[p]);
        CHECK(page.comparison(fmt::format("u({})", p)).source == Source::kDerived);
    }
    CHECK(page.comparison("u(0)").paper.has_value() == printed);
    CHECK(page.comparison("u(16)").paper.has_value() == printed);
    CHECK_FALSE(page.comparison("u(8)").paper.has_value());
    check_best(page, pictures, u, views);
    const StudyTable& table = page.table(page.name);
    REQUIRE(table.rows.size() == u.size());
    for (std::size_t p = 0; p < u.size(); ++p) {
        CHECK(table.at(p, "p") == Cell(p));
        CHECK(table.at(p, "u") == Cell(u[p]));
    }
    for (const std::size_t p : {1, 8, 16}) {
        std::vector<double> values;
        for (const auto& view : views) values.push_back(view[p]);
        check_estimate(table.at(p, "mean u").number(), table.at(p, "+-").number(), values);
        CHECK(table.at(p, "least u").number() == *std::min_element(values.begin(), values.end()));
        CHECK(table.at(p, "largest u").number() == *std::max_element(values.begin(), values.end()));
    }
    REQUIRE(page.plots.size() == 2);
    CHECK(page.plots[1].series.at(2).y == u);
    for (const StudyPlot& plot : page.plots) {
        const bool has = std::any_of(plot.series.begin(), plot.series.end(),
                                     [](const PlotSeries& series) { return series.style == PlotStyle::kPaper; });
        CHECK(has == printed);
    }
}

TEST_CASE("the paper's figures are those printed, and what follows from them", "[study]") {
    CHECK(paper::kMeanMs == Approx(253.125).epsilon(1e-12));                           // 64,800 / 256
    CHECK(paper::kImbalance0 == Approx(1.5797530864).margin(5e-4));                    // 653 / 253.125 - 1
    CHECK(paper::kImbalance16 == Approx(0.1180246914).margin(5e-4));                   // 283 / 253.125 - 1
    CHECK(paper::kImbalance16Least == Approx(282.5 * 256 / 64'850 - 1).margin(5e-4));  // by the rounding of both
    CHECK(paper::kImbalance16Most == Approx(283.5 * 256 / 64'750 - 1).margin(5e-4));
    CHECK(paper::kSpeedup0 == Approx(99.2343032).margin(0.05));                             // 64,800 / 653
    CHECK(std::abs(paper::kOnePeComputeMs / paper::kComputeMs - paper::kSpeedup16) < 0.5);  // 228.98, printed as 229
    CHECK(paper::kEfficiency0 == Approx(0.3876339969).margin(5e-4));
    CHECK(paper::kEfficiency16 == Approx(0.89453125).margin(5e-4));
    CHECK(paper::kObjectsMs + paper::kComputeMs + paper::kImageMs + paper::kDisplayMs == paper::kTotalMs);
    CHECK(paper::kObjectsMs + paper::kOnePeComputeMs + paper::kImageMs + paper::kDisplayMs == paper::kOnePeTotalMs);
    CHECK(paper::kPcMs + 1130 == 297'040);  // Table 2, totals
    CHECK(paper::kWorkstationMs + 300 == 29'100);
    CHECK(paper::kTrace0Ms + paper::kFilter0Ms == 662);  // Table 3, totals
    CHECK(paper::kTrace16Ms + paper::kFilter16Ms == 302);
    CHECK(paper::kExchange0Ms + paper::kSupersample0Ms == 741);  // Table 4, totals
    CHECK(paper::kExchange16Ms + paper::kSupersample16Ms == 419);
    CHECK(32 * paper::kRotationMs == paper::kFilter16Ms - paper::kFilter0Ms);
    CHECK(32 * paper::kRotationMs == paper::kExchange16Ms - paper::kExchange0Ms);
    CHECK(paper::kTrace16Ms == paper::kComputeMs);
    CHECK(paper::kCapRatio == 3.86);
    CHECK(paper::kPixelMachineSpeedup == 60);
}

TEST_CASE("figures 7, 8, 12 and 13 are plain sums of the pixels' costs", "[study][slow]") {
    const std::uint32_t size = GENERATE(17u, 40u);
    CAPTURE(size);
    Session session(choose_device(""));
    Laboratory lab(session, size);
    const LabelledScene centre = embedded_scene("centre");
    const Pictures first = pictures_of(session, centre, size), again = pictures_of(session, centre, size, false);
    check_loads_page(study_fig7(lab, {}), first, false);
    check_imbalance_page(study_fig8(lab, {}), first, false);
    check_loads_page(study_fig12(lab, {}), again, false);
    check_imbalance_page(study_fig13(lab, {}), again, false);
}

TEST_CASE("a study takes the scene that is given, and calls only its own calibrated", "[study]") {
    Session session(choose_device(""));
    Laboratory lab(session, 24);
    const LabelledScene own = {"mine.nff", embedded_scene("cones").scene};
    const StudyPage fig7 = study_fig7(lab, {own}), fig8 = study_fig8(lab, {own});
    const Pictures pictures = pictures_of(session, own, 24);
    check_loads_page(fig7, pictures, false);
    check_imbalance_page(fig8, pictures, false);
    for (const StudyPage& page : {fig7, fig8}) {
        CHECK(read_back(page.settings)["scene"] == "mine.nff");
        CHECK(read_back(page.settings)["size"] == 24);
        CHECK(page.comparison("u(0)").remark.empty());
    }
    CHECK(study_fig8(lab, {}).comparison("u(0)").remark.empty());  // centre.nff, but not of the size calibrated on
}

TEST_CASE("figures 7 and 8 at the paper's size are beside the paper's figures", "[study][slow]") {
    Session session(choose_device(""));
    Laboratory lab(session, 0);
    const StudyPage page = study_fig8(lab, {});
    check_page(page);
    CHECK(read_back(page.settings)["views"] == 64);
    CHECK(read_back(page.settings)["size"] == 256);
    CHECK(read_back(page.settings)["pes"] == 256);
    CHECK(page.comparison("u(0)").paper == 1.58);
    CHECK(page.comparison("u(16)").paper == 0.118);
    CHECK(page.comparison("best p of 0..16").paper == 16.0);
    CHECK(page.claims.size() == 4);
    CHECK_THAT(page.comparison("u(0)").remark, Catch::Contains("calibrated"));
}

TEST_CASE("figure 8 of all 512 offsets takes less than 10 s after the renders", "[.][long]") {
    Session session(choose_device(""));
    Laboratory lab(session, 512);
    const StudyPage first = study_fig8(lab, {});
    const auto start = std::chrono::steady_clock::now();
    const StudyPage again = study_fig8(lab, {});
    CHECK(std::chrono::steady_clock::now() - start < std::chrono::seconds(10));
    CHECK(again.table("fig8").rows.size() == 512);
    CHECK(again.table("fig8").rows == first.table("fig8").rows);
}

TEST_CASE("studies have names of their own, and each page has its study's", "[study]") {
    Session session(choose_device(""));
    Laboratory lab(session, 20);
    for (const char* name : {"fig7", "fig8", "fig12", "fig13"}) {
        CAPTURE(name);
        const auto same = [&](const Study& study) { return study.name == name; };
        REQUIRE(std::count_if(studies().begin(), studies().end(), same) == 1);
        const Study& study = *std::find_if(studies().begin(), studies().end(), same);
        CHECK_FALSE(study.summary.empty());
        CHECK(study.run(lab, {}).name == name);
    }
}

}  // namespace
}  // namespace raya
