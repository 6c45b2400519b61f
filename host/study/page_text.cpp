#include "host/study/page_text.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <stdexcept>

#include "host/study/rows.hpp"

namespace raya {
namespace {

std::string shown(double value) {
    if (value == 0) return "0";  // not -0
    const double size = std::abs(value);
    return size >= 1e4 && size < 1e15 ? fmt::format("{:.0f}", value) : fmt::format("{:.5g}", value);
}

std::string with_unit(const std::string& number, const std::string& unit) {
    return unit.empty() ? number : number + ' ' + unit;
}

bool has_paper(const StudyPage& page) {
    return std::ranges::any_of(page.comparisons, [](const Comparison& c) { return c.paper.has_value(); });
}

std::string paper_text(const Comparison& c) {
    if (!c.paper) return "-";
    return with_unit(shown(*c.paper), c.unit) + (c.source == Source::kDerived ? " (derived)" : "");
}

std::string ours_text(const Comparison& c) {
    const std::string ours = c.half_width ? fmt::format("{} +- {:.2g}", shown(c.ours), *c.half_width) : shown(c.ours);
    return with_unit(ours, c.unit);
}

// "from 1 to 3", of what is finite.
std::string range_text(const std::vector<double>& values) {
    std::vector<double> finite;
    std::ranges::copy_if(values, std::back_inserter(finite), [](double v) { return std::isfinite(v); });
    if (finite.empty()) return "without a finite value";
    const auto [low, high] = std::ranges::minmax(finite);
    return low == high ? "at " + shown(low) : fmt::format("from {} to {}", shown(low), shown(high));
}

std::string series_text(const PlotSeries& s) {
    const std::string points = fmt::format("{} point{}", s.y.size(), s.y.size() == 1 ? "" : "s");
    return fmt::format("{}: {}, {}{}", s.label, points, range_text(s.y),
                       s.half_widths.empty() ? "" : ", with 95 % intervals");
}

std::string axis_text(const std::string& label, bool logarithmic, const std::vector<double>& values) {
    return fmt::format("{}{}, {}", label, logarithmic ? ", logarithmic" : "", range_text(values));
}

void check_table(const StudyTable& table) {
    for (const auto& row : table.rows)
        if (row.size() != table.columns.size())
            throw std::invalid_argument(fmt::format("table {}: a row of {} cells under {} columns", table.name,
                                                    row.size(), table.columns.size()));
}

}  // namespace

std::string exact_text(const Cell& cell) {
    return std::visit([](const auto& value) { return fmt::format("{}", value); }, cell);
}

std::string shown_text(const Cell& cell) {
    if (const auto* value = std::get_if<double>(&cell)) return shown(*value);
    return exact_text(cell);
}

std::optional<double> ratio_of(const Comparison& c) {
    if (!c.paper || *c.paper == 0) return {};
    return c.ours / *c.paper;
}

const char* verdict_text(ClaimVerdict verdict) {
    constexpr const char* kTexts[] = {"reproduced", "not reproduced", "cannot be told"};
    return kTexts[static_cast<int>(verdict)];
}

TextCells comparison_cells(const StudyPage& page) {
    if (page.comparisons.empty()) return {};
    if (!has_paper(page)) {
        TextCells cells = {{"", "ours", "remark"}};
        for (const Comparison& c : page.comparisons) cells.push_back({c.what, ours_text(c), c.remark});
        return cells;
    }
    TextCells cells = {{"", page.beside.empty() ? "paper" : page.beside, "ours", "ours / theirs", "remark"}};
    for (const Comparison& c : page.comparisons) {
        const std::optional<double> ratio = ratio_of(c);
        cells.push_back({c.what, paper_text(c), ours_text(c), ratio ? fmt::format("{:.3g}", *ratio) : "-", c.remark});
    }
    return cells;
}

std::string comparison_title(const StudyPage& page) {
    if (!has_paper(page)) return "Chief figures";
    return page.beside.empty() ? "Beside the papers" : "Beside " + page.beside;
}

TextCells claim_cells(const StudyPage& page) {
    if (page.claims.empty()) return {};
    TextCells cells = {{"paper", "says", "verdict", "why"}};
    for (const Claim& c : page.claims)
        cells.push_back({fmt::format("{}, {}", c.paper, c.place), c.words, verdict_text(c.verdict), c.why});
    return cells;
}

TextCells table_cells(const StudyTable& table) {
    TextCells cells = {each(table.columns, &Heading::text)};
    for (const auto& row : table.rows) cells.push_back(each(row, shown_text));
    return cells;
}

TextCells point_cells(const StudyPlot& plot) {
    const bool bars = std::ranges::any_of(plot.series, [](const PlotSeries& s) { return !s.half_widths.empty(); });
    TextCells cells = {{"series", plot.x_label, plot.y_label}};
    if (bars) cells[0].emplace_back("+-");
    for (const PlotSeries& s : plot.series)
        for (std::size_t i = 0; i < std::min(s.x.size(), s.y.size()); ++i) {
            cells.push_back({s.label, shown(s.x[i]), shown(s.y[i])});
            if (bars) cells.back().push_back(i < s.half_widths.size() ? fmt::format("{:.2g}", s.half_widths[i]) : "-");
        }
    return cells;
}

std::string description_of(const StudyPlot& plot) {
    std::vector<double> x, y;
    for (const PlotSeries& s : plot.series) {
        x.insert(x.end(), s.x.begin(), s.x.end());
        y.insert(y.end(), s.y.begin(), s.y.end());
    }
    const bool log_x = plot.axes == Axes::kLogX || plot.axes == Axes::kLogBoth;
    const bool log_y = plot.axes == Axes::kLogY || plot.axes == Axes::kLogBoth;
    return fmt::format("Across: {}. Up: {}. Series: {}.", axis_text(plot.x_label, log_x, x),
                       axis_text(plot.y_label, log_y, y), joined(plot.series, "; ", series_text));
}

std::vector<std::pair<std::string, std::string>> repeat_lines(const StudyPage& page) {
    std::vector<std::pair<std::string, std::string>> lines;
    if (!page.run.command.empty()) {
        lines.emplace_back("command", page.run.command);
        lines.emplace_back("version", "raya " + page.run.version);
        lines.emplace_back("device",
                           fmt::format("{} ({}, driver {})", page.run.device, page.run.platform, page.run.driver));
    }
    for (const std::string& key : page.settings.keys()) {
        const Json& value = page.settings.at(key);
        lines.emplace_back(key, value.is_text() ? value.text() : value.dump());
    }
    return lines;
}

void check_page(const StudyPage& page) {
    std::set<std::string> tables, plots;
    for (const StudyTable& table : page.tables) {
        if (!tables.insert(table.name).second) throw std::invalid_argument("two tables are called " + table.name);
        check_table(table);
    }
    for (const StudyPlot& plot : page.plots)
        if (!plots.insert(plot.name).second) throw std::invalid_argument("two plots are called " + plot.name);
    for (const StudyPicture& picture : page.pictures)  // both are files NAME.png
        if (!plots.insert(picture.name).second) throw std::invalid_argument("two pictures are called " + picture.name);
}

}  // namespace raya
