#include "host/study/page_writer.hpp"

#include <fmt/core.h>

#include <cmath>
#include <set>
#include <stdexcept>

#include "host/files/whole_file.hpp"
#include "host/report/text_tables.hpp"
#include "host/study/rows.hpp"

namespace raya {
namespace {

using Cells = std::vector<std::vector<std::string>>;

std::string exact(const Cell& cell) {
    return std::visit([](const auto& value) { return fmt::format("{}", value); }, cell);
}

// Five digits, and never an exponent where all digits fit: a reader compares figures by their lengths.
std::string shown(double value) {
    if (value == 0) return "0";  // not -0
    const double size = std::abs(value);
    return size >= 1e4 && size < 1e15 ? fmt::format("{:.0f}", value) : fmt::format("{:.5g}", value);
}

std::string shown(const Cell& cell) {
    if (const auto* value = std::get_if<double>(&cell)) return shown(*value);
    return exact(cell);
}

// Empty where the paper has no number, or none to divide by.
std::optional<double> ratio_of(const Comparison& c) {
    if (!c.paper || *c.paper == 0) return {};
    return c.ours / *c.paper;
}

Json optional_json(const std::optional<double>& value) { return value ? json_number(*value) : nullptr; }

template <typename T, typename F>
Json json_list(const std::vector<T>& items, F json_of) {
    auto list = Json::list();
    for (const T& item : items) list.push_back(json_of(item));
    return list;
}

Json comparison_json(const Comparison& c) {
    return {{"what", c.what},
            {"unit", c.unit},
            {"paper", optional_json(c.paper)},
            {"ours", json_number(c.ours)},
            {"ratio", optional_json(ratio_of(c))},
            {"remark", c.remark},
            {"source", c.source == Source::kPrinted ? "printed" : "derived"},
            {"half_width", optional_json(c.half_width)}};
}

const char* verdict_text(ClaimVerdict verdict) {
    constexpr const char* kTexts[] = {"reproduced", "not reproduced", "cannot be told"};
    return kTexts[static_cast<int>(verdict)];
}

Json claim_json(const Claim& c) {
    return {{"paper", c.paper},
            {"place", c.place},
            {"words", c.words},
            {"verdict", verdict_text(c.verdict)},
            {"why", c.why}};
}

Json table_json(const StudyTable& table) {
    return {{"name", table.name},
            {"title", table.title},
            {"columns", json_list(table.columns, [](const Heading& heading) { return heading.text(); })},
            {"rows", json_list(table.rows, [](const auto& row) { return json_list(row, cell_json); })}};
}

Json series_json(const PlotSeries& s) {
    constexpr const char* kStyles[] = {"line", "points", "steps", "paper"};
    return {{"label", s.label},
            {"style", kStyles[static_cast<int>(s.style)]},
            {"x", json_list(s.x, json_number)},
            {"y", json_list(s.y, json_number)},
            {"half_widths", json_list(s.half_widths, json_number)}};
}

Json plot_json(const StudyPlot& plot) {
    return {{"name", plot.name},
            {"title", plot.title},
            {"x_label", plot.x_label},
            {"y_label", plot.y_label},
            {"log_x", plot.axes == Axes::kLogX || plot.axes == Axes::kLogBoth},
            {"log_y", plot.axes == Axes::kLogY || plot.axes == Axes::kLogBoth},
            {"series", json_list(plot.series, series_json)}};
}

std::string with_unit(const std::string& number, const std::string& unit) {
    return unit.empty() ? number : number + ' ' + unit;
}

std::string comparison_table(const std::vector<Comparison>& comparisons) {
    Cells cells = {{"", "paper", "ours", "ours / paper", "remark"}};
    for (const Comparison& c : comparisons) {
        const std::optional<double> ratio = ratio_of(c);
        const std::string paper = c.paper ? with_unit(shown(*c.paper), c.unit) : "-";
        const std::string ours =
            c.half_width ? fmt::format("{} +- {:.2g}", shown(c.ours), *c.half_width) : shown(c.ours);
        cells.push_back({c.what, c.paper && c.source == Source::kDerived ? paper + " (derived)" : paper,
                         with_unit(ours, c.unit), ratio ? fmt::format("{:.3g}", *ratio) : "-", c.remark});
    }
    return markdown_table(cells);
}

std::string claims_table(const std::vector<Claim>& claims) {
    if (claims.empty()) return {};
    Cells cells = {{"paper", "says", "verdict", "why"}};
    for (const Claim& c : claims)
        cells.push_back({fmt::format("{}, {}", c.paper, c.place), c.words, verdict_text(c.verdict), c.why});
    return markdown_table(cells);
}

std::string list(const std::vector<std::string>& sentences) {
    return joined(sentences, "", [](const std::string& sentence) { return "- " + sentence + '\n'; });
}

// Nothing for an empty text.
std::string section(const std::string& title, const std::string& text) {
    return text.empty() ? "" : fmt::format("\n## {}\n\n{}", title, text);
}

std::string table_section(const StudyTable& table) {
    const std::string file = fmt::format("[{0}.csv]({0}.csv)", table.name);
    if (!table.on_page) return section(table.title, fmt::format("{} rows, in {}.\n", table.rows.size(), file));
    Cells cells = {each(table.columns, &Heading::text)};
    for (const auto& row : table.rows) cells.push_back(each(row, [](const Cell& cell) { return shown(cell); }));
    return section(table.title, fmt::format("{}\nWith all digits: {}.\n", markdown_table(cells), file));
}

std::string plots_text(const StudyPage& page, const PlotOutcome& plots) {
    if (page.plots.empty()) return {};
    if (!plots.drawn)
        return fmt::format("Not drawn: {}. Then `tools/plot.py {}.json` draws them.\n", plots.reason, page.name);
    return joined(page.plots, "\n",
                  [](const StudyPlot& plot) { return fmt::format("![{}]({}.svg)\n", plot.title, plot.name); });
}

void check_names(const StudyPage& page) {
    std::set<std::string> tables, plots;
    for (const StudyTable& table : page.tables) {
        if (!tables.insert(table.name).second) throw std::invalid_argument("two tables are called " + table.name);
        for (const auto& row : table.rows)
            if (row.size() != table.columns.size())
                throw std::invalid_argument(fmt::format("table {}: a row of {} cells under {} columns", table.name,
                                                        row.size(), table.columns.size()));
    }
    for (const StudyPlot& plot : page.plots)
        if (!plots.insert(plot.name).second) throw std::invalid_argument("two plots are called " + plot.name);
}

}  // namespace

std::string table_csv(const StudyTable& table) {
    std::string text = joined(table.columns, ",", [](const Heading& h) { return csv_field(h.text()); }) + '\n';
    for (const auto& row : table.rows)
        text += joined(row, ",", [](const Cell& cell) { return csv_field(exact(cell)); }) + '\n';
    return text;
}

Json cell_json(const Cell& cell) {
    if (const auto* value = std::get_if<double>(&cell)) return json_number(*value);
    if (const auto* count = std::get_if<std::int64_t>(&cell)) return *count;
    return cell.text();
}

Json page_json(const StudyPage& page) {
    return {{"study", page.name},
            {"title", page.title},
            {"question", page.question},
            {"method", page.method},
            {"settings", page.settings},
            {"clock", page.clock},
            {"comparisons", json_list(page.comparisons, comparison_json)},
            {"claims", json_list(page.claims, claim_json)},
            {"findings", page.findings},
            {"tables", json_list(page.tables, table_json)},
            {"plots", json_list(page.plots, plot_json)},
            {"news", page.news}};
}

std::string page_markdown(const StudyPage& page, const PlotOutcome& plots) {
    std::string text = fmt::format("# {}\n\n{}\n", page.title, page.question);
    text += section("How it was done", list(page.method));
    if (!page.clock.empty()) text += fmt::format("\nTimes: {}\n", page.clock);
    if (!page.comparisons.empty()) text += section("Beside the paper", comparison_table(page.comparisons));
    text += section("What the papers say", claims_table(page.claims));
    text += section("What is seen", list(page.findings));
    text += section("What is new", list(page.news));
    for (const StudyTable& table : page.tables) text += table_section(table);
    text += section("Plots", plots_text(page, plots));
    return text + fmt::format("\nEverything on this page, for programs: [{0}.json]({0}.json).\n", page.name);
}

PlotOutcome write_page(const std::filesystem::path& folder, const StudyPage& page) {
    check_names(page);
    // A scene's label may be a path in any encoding; JSON must be UTF-8.
    const std::string json = page_json(page).dump(2);
    for (const StudyTable& table : page.tables) write_whole_file(folder / (table.name + ".csv"), table_csv(table));
    write_whole_file(folder / (page.name + ".json"), json + '\n');
    PlotOutcome plots = draw_plots(folder, page);
    write_whole_file(folder / (page.name + ".md"), page_markdown(page, plots));
    return plots;
}

std::string index_markdown(std::span<const StudyPage> pages) {
    std::string text =
        "# The load laboratory\n\nThe figures and tables of the paper (Kohata and Ito, 1993), computed again, and what "
        "goes beyond them, in the order in which they are best read.\n";
    for (const StudyPage& page : pages) {
        text += fmt::format("\n## [{}]({}.md)\n\n{}\n", page.title, page.name, page.question);
        if (!page.comparisons.empty()) text += '\n' + comparison_table(page.comparisons);
        if (!page.findings.empty()) text += fmt::format("\n{}\n", page.findings.front());
    }
    return text;
}

void write_index(const std::filesystem::path& folder, std::span<const StudyPage> pages) {
    write_whole_file(folder / "index.md", index_markdown(pages));
}

}  // namespace raya
