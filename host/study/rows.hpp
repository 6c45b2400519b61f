// A study's rows: what is read from them once, for tables, plots, comparisons and sentences alike.
//
// A study computes rows, plain structs whose members and member functions are its figures. A column says what a figure
// is called; a plot, a comparison and a finding name the same member. `figure` below is anything that std::invoke takes
// with a row: a member, a member function, a lambda.
#pragma once
#include <fmt/core.h>

#include <algorithm>
#include <functional>
#include <ranges>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "host/study/page.hpp"

namespace raya {

/// One figure of a row and what to call it.
template <class Row>
struct Column {
    std::string label;  // no other column of the table has it
    std::function<Cell(const Row&)> figure;
    std::string unit = {};
};

template <class Rows>
using RowOf = std::ranges::range_value_t<Rows>;

template <class Rows>
StudyTable table_of(std::string name, std::string title, const Rows& rows,
                    const std::type_identity_t<std::vector<Column<RowOf<Rows>>>>& columns, bool on_page = true) {
    StudyTable table{std::move(name), std::move(title), {}, {}, on_page};
    for (const auto& column : columns) table.columns.push_back({column.label, column.unit});
    for (const auto& row : rows) {
        table.rows.emplace_back();
        for (const auto& column : columns) table.rows.back().push_back(column.figure(row));
    }
    return table;
}

/// One figure over another.
template <class Rows, class X, class Y>
PlotSeries line(std::string label, const Rows& rows, X x, Y y, PlotStyle style = PlotStyle::kLine) {
    PlotSeries series{std::move(label), {}, {}, style};
    for (const auto& row : rows) {
        series.x.push_back(static_cast<double>(std::invoke(x, row)));
        series.y.push_back(static_cast<double>(std::invoke(y, row)));
    }
    return series;
}

/// The rows for which `holds` does.
template <class Rows, class Holds>
std::vector<RowOf<Rows>> where(const Rows& rows, Holds holds) {
    std::vector<RowOf<Rows>> some;
    std::ranges::copy_if(rows, std::back_inserter(some), holds);
    return some;
}

/// What a figure is in each row, in order.
template <class Rows, class Figure>
auto each(const Rows& rows, Figure figure) {
    std::vector<std::decay_t<std::invoke_result_t<Figure, const RowOf<Rows>&>>> all;
    for (const auto& row : rows) all.push_back(std::invoke(figure, row));  // NOLINT: a view has no size
    return all;
}

/// The values that a figure takes, in the order in which they are first met.
template <class Rows, class Figure>
auto distinct(const Rows& rows, Figure figure) {
    auto all = each(rows, figure), some = decltype(all){};
    for (const auto& value : all)
        if (std::ranges::find(some, value) == some.end()) some.push_back(value);
    return some;
}

/// A line for each value of `label`, of the rows that have it.
template <class Rows, class Label, class X, class Y>
std::vector<PlotSeries> lines(const Rows& rows, Label label, X x, Y y, PlotStyle style = PlotStyle::kLine) {
    std::vector<PlotSeries> all;
    for (const std::string& one : distinct(rows, label))
        all.push_back(
            line(one, where(rows, [&](const auto& row) { return std::invoke(label, row) == one; }), x, y, style));
    return all;
}

/// The first row in which a figure is least; one row at least.
template <class Rows, class Figure>
const RowOf<Rows>& least(const Rows& rows, Figure figure) {
    return *std::ranges::min_element(rows, {}, figure);
}

/// What is said of each row, with `separator` between: a part of a sentence.
template <class Rows, class Words>
std::string joined(const Rows& rows, std::string_view separator, Words words) {
    std::string text;
    bool first = true;
    for (const auto& row : rows) {
        if (!std::exchange(first, false)) text += separator;
        text += fmt::format("{}", std::invoke(words, row));
    }
    return text;
}

}  // namespace raya
