#include "host/page/html.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cstdlib>

#include "host/report/text_tables.hpp"

namespace raya {
namespace {

constexpr const char* kNarrowSpace = "\u202f";
constexpr std::size_t kOpenRows = 24, kMostRows = 400;

// "35", "35 ms", "35 ± 5", "inf", "-", "12 345" with a narrow space: what a column of numbers has.
bool is_number(const std::string& cell) {
    if (cell == "-" || cell.empty()) return true;
    const std::string html = replaced(cell, kNarrowSpace, "");
    char* end = nullptr;
    std::strtod(html.c_str(), &end);
    return end != html.c_str() && (*end == '\0' || *end == ' ');
}

bool is_numeric(const TextCells& html, std::size_t column) {
    bool any = false;
    for (std::size_t row = 1; row < html.size(); ++row) {
        if (!is_number(html[row][column])) return false;
        any = any || html[row][column].size() > 1 || html[row][column] != "-";
    }
    return any;
}

// n: of numbers; w: of sentences, which want width; else nothing.
std::string class_of(const TextCells& html, std::size_t column) {
    constexpr std::size_t kSentence = 60;  // characters, tags among them
    if (is_numeric(html, column)) return " class=\"n\"";
    const bool wide = std::ranges::any_of(html, [&](const auto& row) { return row[column].size() > kSentence; });
    return wide ? " class=\"w\"" : "";
}

std::string row_of(const std::vector<std::string>& html, const std::vector<std::string>& classes, const char* tag) {
    std::string text = "<tr>";
    for (std::size_t i = 0; i < html.size(); ++i)
        text += fmt::format("<{}{}>{}</{}>", tag, classes[i], html[i], std::string(tag, 2));
    return text + "</tr>\n";
}

// Without the header.
std::size_t rows_of(const HtmlTable& table) { return table.html.empty() ? 0 : table.html.size() - 1; }

}  // namespace

std::string html_text(const std::string& text) {
    std::string html = replaced(text, "&", "&amp;");
    html = replaced(html, "<", "&lt;");
    html = replaced(html, ">", "&gt;");
    html = replaced(html, "\"", "&quot;");
    return replaced(html, "'", "&#39;");
}

std::string html_prose(const std::string& text) {
    std::string html = replaced(html_text(text), "+-", "±");
    for (std::size_t at = html.find('`'); at != std::string::npos; at = html.find('`', at)) {
        const std::size_t end = html.find('`', at + 1);
        if (end == std::string::npos) break;
        html.replace(end, 1, "</code>");
        html.replace(at, 1, "<code>");
    }
    return html;
}

std::string html_list(const std::vector<std::string>& sentences) {
    if (sentences.empty()) return {};
    std::string items;
    for (const std::string& sentence : sentences) items += "<li>" + html_prose(sentence) + "</li>\n";
    return "<ul>\n" + items + "</ul>\n";
}

std::string html_section(const std::string& title, const std::string& html) {
    return html.empty() ? "" : fmt::format("<h3>{}</h3>\n{}", html_prose(title), html);
}

TextCells html_cells(TextCells cells) {
    for (auto& row : cells)
        for (std::string& cell : row) cell = html_prose(cell);
    return cells;
}

std::string html_table(const HtmlTable& table) {
    if (table.html.empty()) return {};
    std::vector<std::string> classes;
    for (std::size_t i = 0; i < table.html[0].size(); ++i) classes.push_back(class_of(table.html, i));
    std::string text = fmt::format(
        "<div class=\"wide\" tabindex=\"0\" role=\"region\" aria-label=\"{0}\"><table aria-label=\"{0}\">\n<thead>",
        html_text(table.label));
    text += row_of(table.html[0], classes, "th scope=\"col\"") + "</thead>\n<tbody>\n";
    for (std::size_t row = 1; row < table.html.size(); ++row) text += row_of(table.html[row], classes, "td");
    return text + "</tbody></table></div>\n";
}

std::string html_cut_table(const HtmlTable& table, const std::string& rest) {
    HtmlTable shown = table;
    shown.html.resize(std::min(shown.html.size(), kMostRows + 1));
    const std::size_t rows = rows_of(table);
    const std::string cut =
        rows > kMostRows ? fmt::format("The first {} of {} rows. ", kMostRows, rows) : std::string();
    return html_table(shown) + fmt::format("<p class=\"note\">{}{}</p>\n", cut, rest);
}

std::string html_folded_table(const HtmlTable& table, const std::string& rest) {
    const std::string text = html_cut_table(table, rest);
    const std::size_t rows = rows_of(table);
    if (rows <= kOpenRows) return text;
    return fmt::format("<details><summary>{} rows</summary>\n{}</details>\n", rows, text);
}

std::string html_picture(const HtmlPicture& picture) {
    return fmt::format(
        "<figure>\n<img class=\"picture\" alt=\"{}\" src=\"data:image/png;base64,{}\">\n"
        "<figcaption>{}</figcaption>\n</figure>\n",
        html_text(picture.words), html_text(picture.base64_png), html_prose(picture.title));
}

}  // namespace raya
