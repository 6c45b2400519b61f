// What must hold of any study's page, for tests.
#pragma once
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <set>
#include <string>
#include <variant>

#include "host/study/page.hpp"

namespace raya {

/// Rows fit their columns, series are of one length, figures finite, names and labels there and told apart.
inline void check_shape(const StudyPage& page) {
    CHECK(!page.title.empty());
    CHECK(!page.question.empty());
    CHECK(!page.method.empty());
    CHECK(!page.findings.empty());
    for (const std::string& finding : page.findings) CHECK(!finding.empty());
    std::set<std::string> names;
    for (const StudyTable& table : page.tables) {
        CAPTURE(table.name);
        CHECK(names.insert(table.name).second);
        CHECK(!table.rows.empty());
        for (const auto& row : table.rows) {
            REQUIRE(row.size() == table.columns.size());
            for (const Cell& cell : row)
                if (const double* number = std::get_if<double>(&cell)) CHECK(std::isfinite(*number));
        }
    }
    names.clear();
    for (const StudyPlot& plot : page.plots) {
        CAPTURE(plot.name);
        CHECK(names.insert(plot.name).second);
        CHECK(!plot.x_label.empty());
        CHECK(!plot.y_label.empty());
        for (const PlotSeries& series : plot.series) {
            CHECK(series.x.size() == series.y.size());
            CHECK(!series.x.empty());
            CHECK(std::all_of(series.y.begin(), series.y.end(), [](double y) { return std::isfinite(y); }));
        }
    }
    for (const Comparison& comparison : page.comparisons) CHECK(std::isfinite(comparison.ours));
}

inline const StudyTable& table_of(const StudyPage& page, const std::string& name) {
    const auto found = std::find_if(page.tables.begin(), page.tables.end(),
                                    [&](const StudyTable& table) { return table.name == name; });
    REQUIRE(found != page.tables.end());
    return *found;
}

inline const Comparison& comparison_of(const StudyPage& page, const std::string& what) {
    CAPTURE(what);
    const auto found = std::find_if(page.comparisons.begin(), page.comparisons.end(),
                                    [&](const Comparison& comparison) { return comparison.what == what; });
    REQUIRE(found != page.comparisons.end());
    return *found;
}

inline double cell_number(const Cell& cell) {
    if (const std::int64_t* whole = std::get_if<std::int64_t>(&cell)) return static_cast<double>(*whole);
    return std::get<double>(cell);
}

}  // namespace raya
