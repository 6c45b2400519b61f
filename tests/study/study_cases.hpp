// Random cost images, and laws that hold of every study page.
#pragma once
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <random>
#include <set>

#include "host/ring/cost_image.hpp"
#include "host/study/page.hpp"

namespace raya {

/// Costs 1..9, and of some pixels a hundred times that: loads as uneven as those of glass before a sky.
inline CostImage random_costs(std::mt19937& random, std::uint32_t side) {
    CostImage image{side, side, {}};
    const auto dear = static_cast<std::uint32_t>(random() % 12);  // of 64 pixels
    for (std::uint32_t i = 0; i < side * side; ++i)
        image.cycles.push_back((1 + random() % 9) * (random() % 64 < dear ? 100 : 1));
    return image;
}

inline CostImage even_costs(std::uint32_t side) {
    return {side, side, std::vector<std::uint64_t>(std::size_t{side} * side, 1)};
}

/// The largest load and what follows from it, summed by an owner(row, column) that a test writes down by itself.
struct PlainLoad {
    double sum = 0, max = 0;
    std::uint32_t pes = 0;
    double speedup() const { return sum / max; }
    double efficiency() const { return speedup() / pes; }
    double imbalance() const { return (max - sum / pes) / (sum / pes); }
};

template <typename Owner>
PlainLoad plain_load(const CostImage& image, std::uint32_t pes, Owner owner) {
    std::vector<double> loads(pes);
    for (std::uint32_t row = 0; row < image.height; ++row)
        for (std::uint32_t column = 0; column < image.width; ++column)
            loads.at(owner(row, column)) += static_cast<double>(image.cycles[row * image.width + column]);
    PlainLoad load{0, *std::max_element(loads.begin(), loads.end()), pes};
    for (const double one : loads) load.sum += one;
    return load;
}

/// Column of the image that is sheared by p.
inline std::uint32_t sheared(std::uint32_t row, std::uint32_t column, std::uint32_t p, std::uint32_t width) {
    const std::int64_t c = (std::int64_t{column} - std::int64_t{row} * p) % width;
    return static_cast<std::uint32_t>(c < 0 ? c + width : c);
}

inline bool says(const StudyPage& page, const std::string& words) {
    return std::ranges::any_of(page.findings,
                               [&](const std::string& finding) { return finding.find(words) != finding.npos; });
}

/// Nothing is without a name or called as another; rows fit their columns; figures are finite; findings are sentences.
inline void check_page(const StudyPage& page) {
    CHECK_FALSE(page.title.empty());
    CHECK_FALSE(page.question.empty());
    CHECK_FALSE(page.method.empty());
    CHECK_FALSE(page.findings.empty());
    const auto finite = [](double value) { return std::isfinite(value); };
    std::set<std::string> names;
    for (const StudyTable& table : page.tables) {
        CAPTURE(table.name);
        CHECK(names.insert(table.name).second);
        CHECK_FALSE(table.rows.empty());
        for (const auto& row : table.rows) {
            REQUIRE(row.size() == table.columns.size());
            CHECK(std::ranges::all_of(
                row, [&](const Cell& cell) { return !std::get_if<double>(&cell) || finite(cell.number()); }));
        }
    }
    names.clear();
    for (const StudyPlot& plot : page.plots) {
        CAPTURE(plot.name);
        CHECK(names.insert(plot.name).second);
        CHECK_FALSE((plot.x_label.empty() || plot.y_label.empty()));
        CHECK_FALSE(plot.series.empty());
        for (const PlotSeries& series : plot.series) {
            CHECK(series.x.size() == series.y.size());
            CHECK((std::ranges::all_of(series.x, finite) && std::ranges::all_of(series.y, finite)));
        }
        CHECK_FALSE(plot.series.front().x.empty());
    }
    CHECK(
        std::ranges::all_of(page.comparisons, [&](const Comparison& c) { return !c.what.empty() && finite(c.ours); }));
    for (const std::string& finding : page.findings) {
        CAPTURE(finding);
        CHECK(finding.find("nan") == std::string::npos);
        CHECK(finding.find("inf") == std::string::npos);
        CHECK((!finding.empty() && finding.back() == '.'));
    }
}

}  // namespace raya
