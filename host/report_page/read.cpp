#include "host/report_page/read.hpp"

#include <fmt/core.h>

#include "host/page/html.hpp"
#include "host/page/html_document.hpp"

namespace raya {
namespace {

// A link to each part: its id and heading stand as html_part() has written them.
std::string contents_of(const std::string& parts) {
    const std::string begin = "<section id=\"", heading = "\">\n<h2>";
    std::string items;
    for (std::size_t at = parts.find(begin); at != std::string::npos; at = parts.find(begin, at + 1)) {
        const std::size_t id = at + begin.size(), id_end = parts.find(heading, id), title = id_end + heading.size();
        items += fmt::format("<li><a href=\"#{}\">{}</a></li>\n", parts.substr(id, id_end - id),
                             parts.substr(title, parts.find("</h2>", title) - title));
    }
    return "<nav class=\"parts\" aria-label=\"Contents\">\n<ul>\n" + items + "</ul>\n</nav>\n";
}

std::string pairs(const char* list, const char* row, const char* row_end,
                  const std::vector<std::pair<std::string, std::string>>& rows) {
    std::string html;
    for (const auto& [name, text] : rows)
        if (!text.empty()) html += fmt::format("{}<dt>{}</dt><dd>{}</dd>{}\n", row, html_prose(name), text, row_end);
    return html.empty() ? html : fmt::format("<dl{}>\n{}</dl>\n", list, html);
}

}  // namespace

std::string grouped(std::uint64_t number) {
    std::string text = fmt::format("{}", number);
    for (std::size_t at = text.size(); at > 3;) text.insert(at -= 3, "\u202f");
    return text;
}

std::string count_of(const Json& number) { return grouped(number.whole()); }

std::string fixed(double value, int digits) { return fmt::format("{:.{}f}", value, digits); }

std::string percent_of(double share, int digits) { return fmt::format("{:.{}f} %", 100 * share, digits); }

std::vector<double> numbers_of(const Json& list) {
    std::vector<double> numbers;
    for (const Json& number : list.elements()) numbers.push_back(number.number());
    return numbers;
}

std::string text_or_nothing(const Json& object, std::string_view key) {
    const Json* const member = object.find(key);
    return member == nullptr || member->is_null() ? "" : member->text();
}

std::string html_definitions(const std::vector<std::pair<std::string, std::string>>& rows) {
    return pairs("", "", "", rows);
}

std::string html_tiles(const std::vector<std::pair<std::string, std::string>>& tiles) {
    return pairs(" class=\"chief\"", "<div>", "</div>", tiles);
}

std::string html_part(const std::string& id, const std::string& title, const std::string& html) {
    if (html.empty()) return {};
    return fmt::format("<section id=\"{}\">\n<h2>{}</h2>\n{}</section>\n", id, html_prose(title), html);
}

std::string framed_page(const PageFrame& f) {
    const std::string header = fmt::format("<header>\n<p class=\"kicker\">{}</p>\n<h1>{}</h1>\n{}</header>\n",
                                           html_text(f.kicker), html_text(f.title), f.lead);
    return html_document({.title = f.kicker + ": " + f.title,
                          .html = header + contents_of(f.parts) + "<main>\n" + f.parts +
                                  "</main>\n<footer>\n<p class=\"note\">" + f.made + "</p>\n</footer>\n",
                          .scripts = {"host/page/assets/tables.js"}});
}

}  // namespace raya
