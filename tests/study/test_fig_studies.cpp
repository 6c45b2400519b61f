// The studies of figures 7, 8, 12 and 13 against plain sums, and the paper's figures against arithmetic by hand.
#include <fmt/core.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <chrono>

#include "host/cl/device.hpp"
#include "host/study/paper.hpp"
#include "host/study/studies.hpp"
#include "kernels/shared/mapping.h"
#include "tests/document.hpp"

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

void check_loads_page(const StudyPage& page, const CostImage& image, bool printed) {
    const Sums columns = loads_of(image, 0), cyclic = loads_of(image, 16);
    const auto ms = [](double cycles) { return Approx(cycles * 100e-6).epsilon(1e-14); };  // 100 ns a cycle
    CHECK(page.comparison("mean load").ours == ms(mean_of(columns)));
    CHECK(page.comparison("largest load, p = 0").ours == ms(max_of(columns)));
    CHECK(page.comparison("largest load, p = 16").ours == ms(max_of(cyclic)));
    CHECK(page.comparison("u(0)").ours == imbalance_of(columns));
    CHECK(page.comparison("u(16)").ours == imbalance_of(cyclic));
    for (const Comparison& c : page.comparisons) CHECK(c.paper.has_value() == printed);
    REQUIRE(page.tables.size() == 1);
    REQUIRE(page.tables[0].rows.size() == image.width);
    for (std::size_t pe = 0; pe < image.width; ++pe) {
        CHECK(page.tables[0].at(pe, "PE") == Cell(pe));
        CHECK(page.tables[0].at(pe, "p = 0") == Cell(columns[pe]));
        CHECK(page.tables[0].at(pe, "p = 16") == Cell(cyclic[pe]));
    }
    REQUIRE(page.plots.size() == 1);
    REQUIRE(page.plots[0].series.size() == 3);
    for (std::size_t pe = 0; pe < image.width; ++pe) {
        CHECK(page.plots[0].series[0].y.at(pe) == ms(static_cast<double>(columns[pe])));
        CHECK(page.plots[0].series[1].y.at(pe) == ms(static_cast<double>(cyclic[pe])));
    }
}

void check_best(const StudyPage& page, const std::vector<double>& u) {
    const std::size_t near = best_of(u, 17), best = best_of(u, u.size());
    const Comparison& of_all = page.comparison(fmt::format("best p of all {}", u.size()));
    CHECK(page.comparison("best p of 0..16").ours == static_cast<double>(near));
    CHECK(page.comparison("best p of 0..16").remark == fmt::format("u = {:.3f}", u[near]));
    CHECK(of_all.ours == static_cast<double>(best));
    CHECK(of_all.remark == fmt::format("u = {:.3f}", u[best]));
    const auto better = std::count_if(u.begin(), u.end(), [&](double value) { return value < u[16]; });
    CHECK_THAT(page.findings.at(1), Catch::Contains(fmt::format(" {} offsets are better than p = 16", better)));
}

void check_imbalance_page(const StudyPage& page, const CostImage& image, bool printed) {
    const std::vector<double> u = imbalances_of(image);
    for (const std::size_t p : {0, 8, 16}) CHECK(page.comparison(fmt::format("u({})", p)).ours == u[p]);
    CHECK(page.comparison("u(0)").paper.has_value() == printed);
    CHECK(page.comparison("u(16)").paper.has_value() == printed);
    CHECK_FALSE(page.comparison("u(8)").paper.has_value());
    check_best(page, u);
    REQUIRE(page.tables.at(0).rows.size() == u.size());
    for (std::size_t p = 0; p < u.size(); ++p) {
        CHECK(page.tables[0].at(p, "p") == Cell(p));
        CHECK(page.tables[0].at(p, "u") == Cell(u[p]));
    }
    REQUIRE(page.plots.size() == 2);
    CHECK(page.plots[0].series.at(0).y == std::vector<double>(u.begin(), u.begin() + 17));
    CHECK(page.plots[1].series.at(0).y == u);
    for (const StudyPlot& plot : page.plots) CHECK(plot.series.size() == (printed ? 2 : 1));
}

TEST_CASE("the paper's figures are those printed, and what follows from them", "[study]") {
    CHECK(paper::kMeanMs == Approx(253.125).epsilon(1e-12));                                // 64,800 / 256
    CHECK(paper::kImbalance0 == Approx(1.5797530864).epsilon(1e-9));                        // 653 / 253.125 - 1
    CHECK(paper::kImbalance16 == Approx(0.1180246914).epsilon(1e-9));                       // 283 / 253.125 - 1
    CHECK(paper::kSpeedup0 == Approx(99.2343032).epsilon(1e-8));                            // 64,800 / 653
    CHECK(std::abs(paper::kOnePeComputeMs / paper::kComputeMs - paper::kSpeedup16) < 0.5);  // 228.98, printed as 229
    CHECK(paper::kEfficiency0 == Approx(0.3876339969).epsilon(1e-9));
    CHECK(paper::kEfficiency16 == Approx(0.89453125).epsilon(1e-12));
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

TEST_CASE("figures 7, 8, 12 and 13 are plain sums of the pixels' costs", "[study]") {
    const std::uint32_t size = GENERATE(17u, 40u);
    CAPTURE(size);
    Session session(choose_device(""));
    Laboratory lab(session, size);
    const LabelledScene centre = embedded_scene("centre");
    check_loads_page(study_fig7(lab, {}), lab.costs(centre, size).trace, false);
    check_imbalance_page(study_fig8(lab, {}), lab.costs(centre, size).trace, false);
    const CostImage& extra = lab.costs(centre, size, AntialiasMethod::kSupersample).supersample;
    check_loads_page(study_fig12(lab, {}), extra, false);
    check_imbalance_page(study_fig13(lab, {}), extra, false);
}

TEST_CASE("a study takes the scene that is given, and calls only its own calibrated", "[study]") {
    Session session(choose_device(""));
    Laboratory lab(session, 24);
    const LabelledScene own = {"mine.nff", embedded_scene("cones").scene};
    const StudyPage fig7 = study_fig7(lab, {own}), fig8 = study_fig8(lab, {own});
    check_loads_page(fig7, lab.costs(own, 24).trace, false);
    check_imbalance_page(fig8, lab.costs(own, 24).trace, false);
    for (const StudyPage& page : {fig7, fig8}) {
        CHECK(read_back(page.settings)["scene"] == "mine.nff");
        CHECK(read_back(page.settings)["size"] == 24);
        CHECK(page.comparison("u(0)").remark.empty());
    }
    CHECK(study_fig8(lab, {}).comparison("u(0)").remark.empty());  // centre.nff, but not of the size calibrated on
}

TEST_CASE("figures 7 and 8 at the paper's size are beside the paper's figures", "[study]") {
    Session session(choose_device(""));
    Laboratory lab(session, 0);
    const StudyPage page = study_fig8(lab, {});
    check_imbalance_page(page, lab.costs(embedded_scene("centre"), 256).trace, true);
    check_loads_page(study_fig7(lab, {}), lab.costs(embedded_scene("centre"), 256).trace, true);
    CHECK(read_back(page.settings)["size"] == 256);
    CHECK(read_back(page.settings)["pes"] == 256);
    CHECK(page.comparison("u(0)").paper.value() == Approx(1.580).margin(0.0005));
    CHECK(page.comparison("u(16)").paper.value() == Approx(0.118).margin(0.0005));
    CHECK(page.comparison("best p of 0..16").paper == 16.0);
    CHECK_THAT(page.comparison("u(0)").remark, Catch::Contains("calibrated"));
}

TEST_CASE("figure 8 of all 512 offsets takes less than 10 s after the render", "[study]") {
    Session session(choose_device(""));
    Laboratory lab(session, 512);
    const StudyPage first = study_fig8(lab, {});
    const auto start = std::chrono::steady_clock::now();
    const StudyPage again = study_fig8(lab, {});
    CHECK(std::chrono::steady_clock::now() - start < std::chrono::seconds(10));
    CHECK(again.tables.at(0).rows.size() == 512);
    CHECK(again.tables.at(0).rows == first.tables.at(0).rows);
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
