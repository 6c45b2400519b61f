#include "host/study/page_writer.hpp"

#include <fmt/core.h>

#include "host/base/whole_file.hpp"
#include "host/report/text_tables.hpp"
#include "host/study/conclusion.hpp"
#include "host/study/page_text.hpp"
#include "host/study/prose.hpp"
#include "host/study/rows.hpp"

namespace raya {
namespace {

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

Json picture_json(const StudyPicture& picture) {
    return {{"name", picture.name}, {"title", picture.title}, {"words", picture.words}};
}

Json run_json(const RunRecord& run) {
    return {{"version", run.version},
            {"command", run.command},
            {"device", run.device},
            {"platform", run.platform},
            {"driver", run.driver}};
}

Json plot_json(const StudyPlot& plot) {
    return {{"name", plot.name},
            {"title", plot.title},
            {"description", description_of(plot)},
            {"x_label", plot.x_label},
            {"y_label", plot.y_label},
            {"log_x", plot.axes == Axes::kLogX || plot.axes == Axes::kLogBoth},
            {"log_y", plot.axes == Axes::kLogY || plot.axes == Axes::kLogBoth},
            {"series", json_list(plot.series, series_json)}};
}

std::string list(const std::vector<std::string>& sentences) {
    return joined(sentences, "", [](const std::string& sentence) { return "- " + sentence + '\n'; });
}

std::string table_text(const TextCells& cells) { return cells.empty() ? "" : markdown_table(cells); }

std::string repeat_text(const StudyPage& page) {
    return joined(repeat_lines(page), "", [](const auto& line) {
        const char* fence = line.second.find('`') == std::string::npos ? "`{}`" : "``` {} ```";
        return fmt::format("- {}: {}\n", line.first, fmt::format(fmt::runtime(fence), line.second));
    });
}

// Nothing for an empty text.
std::string section(const std::string& title, const std::string& text) {
    return text.empty() ? "" : fmt::format("\n## {}\n\n{}", title, text);
}

std::string table_section(const StudyTable& table) {
    const std::string file = fmt::format("[{0}.csv]({0}.csv)", table.name);
    if (!table.on_page) return section(table.title, fmt::format("{} rows, in {}.\n", table.rows.size(), file));
    const std::string cells = markdown_table(table_cells(table));
    return section(table.title, fmt::format("{}\nWith all digits: {}.\n", cells, file));
}

std::string pictures_text(const StudyPage& page) {
    return joined(page.pictures, "\n", [](const StudyPicture& picture) {
        return fmt::format("![{}]({}.png)\n\n{}\n", picture.words, picture.name, picture.title);
    });
}

std::string plots_text(const StudyPage& page, const PlotOutcome& plots) {
    if (page.plots.empty()) return {};
    if (!plots.drawn)
        return fmt::format("Not drawn: {}. Then `tools/plot.py {}.json` draws them.\n", plots.reason, page.name);
    return joined(page.plots, "\n",
                  [](const StudyPlot& plot) { return fmt::format("![{}]({}.svg)\n", plot.title, plot.name); });
}

}  // namespace

std::string table_csv(const StudyTable& table) {
    std::string text = joined(table.columns, ",", [](const Heading& h) { return csv_field(h.text()); }) + '\n';
    for (const auto& row : table.rows)
        text += joined(row, ",", [](const Cell& cell) { return csv_field(exact_text(cell)); }) + '\n';
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
            {"run", run_json(page.run)},
            {"beside", page.beside},
            {"comparisons", json_list(page.comparisons, comparison_json)},
            {"claims", json_list(page.claims, claim_json)},
            {"findings", page.findings},
            {"tables", json_list(page.tables, table_json)},
            {"plots", json_list(page.plots, plot_json)},
            {"pictures", json_list(page.pictures, picture_json)},
            {"news", page.news}};
}

std::string page_markdown(const StudyPage& page, const PlotOutcome& plots) {
    std::string text = fmt::format("# {}\n\n{}\n", page.title, page.question);
    text += section("How it was done", list(page.method));
    if (!page.clock.empty()) text += fmt::format("\nTimes: {}\n", page.clock);
    text += section(comparison_title(page), table_text(comparison_cells(page)));
    text += section("What the papers say", table_text(claim_cells(page)));
    text += section("What is seen", list(page.findings));
    text += section("What is new", list(page.news));
    text += section("Pictures", pictures_text(page));
    for (const StudyTable& table : page.tables) text += table_section(table);
    text += section("Plots", plots_text(page, plots));
    text += section("How to repeat it", repeat_text(page));
    return text + fmt::format("\nEverything on this page, for programs: [{0}.json]({0}.json).\n", page.name);
}

PlotOutcome write_page(const std::filesystem::path& folder, const StudyPage& page) {
    check_page(page);
    // A scene's label may be a path in any encoding; JSON must be UTF-8.
    const std::string json = page_json(page).dump(2);
    for (const StudyTable& table : page.tables) write_whole_file(folder / (table.name + ".csv"), table_csv(table));
    for (const StudyPicture& picture : page.pictures) write_whole_file(folder / (picture.name + ".png"), picture.png);
    write_whole_file(folder / (page.name + ".json"), json + '\n');
    PlotOutcome plots = draw_plots(folder, page);
    write_whole_file(folder / (page.name + ".md"), page_markdown(page, plots));
    return plots;
}

std::string index_markdown(std::span<const StudyPage> pages) {
    const StudyPage about = page_about("laboratory", {});
    std::string text = fmt::format("# {}\n\n{}\n\n{}", about.title, about.question, list(about.method));
    text += section("Conclusion", list(verdict_sentences(pages)));
    const std::string not_seen = list(claims_with(pages, ClaimVerdict::kNotReproduced));
    if (!not_seen.empty()) text += "\nNot reproduced:\n\n" + not_seen;
    for (const StudyPage& page : pages) {
        text += fmt::format("\n## [{}]({}.md)\n\n{}\n", page.title, page.name, page.question);
        if (!page.comparisons.empty()) text += '\n' + table_text(comparison_cells(page));
        if (!page.findings.empty()) text += fmt::format("\n{}\n", page.findings.front());
    }
    return text;
}

void write_index(const std::filesystem::path& folder, std::span<const StudyPage> pages) {
    write_whole_file(folder / "index.md", index_markdown(pages));
}

}  // namespace raya
