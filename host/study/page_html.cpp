#include "host/study/page_html.hpp"

#include <fmt/core.h>

#include "host/base/base64.hpp"
#include "host/page/html.hpp"
#include "host/study/html_figure.hpp"
#include "host/study/page_text.hpp"
#include "host/study/rows.hpp"

namespace raya {
namespace {

std::string link_to(const std::string& file) { return fmt::format("<a href=\"{0}\">{0}</a>", html_text(file)); }

std::string claims_html(const StudyPage& page) {
    TextCells cells = html_cells(claim_cells(page));
    for (std::size_t i = 0; i < page.claims.size(); ++i) cells[i + 1][2] = html_verdict(page.claims[i].verdict);
    return html_table({page.title + ": claims", cells});
}

std::string comparisons_html(const StudyPage& page) {
    return html_table({page.title + ": figures", html_cells(comparison_cells(page))});
}

std::string table_html(const StudyTable& table) {
    const std::string rest = "With all digits: " + link_to(table.name + ".csv") + '.';
    return html_section(table.title, html_folded_table({table.title, html_cells(table_cells(table))}, rest));
}

std::string picture_html(const StudyPicture& picture) {
    return html_picture({picture.title, picture.words, base64(picture.png)});
}

std::string figures_html(const StudyPage& page, const PageFiles& files) {
    std::string html;
    for (std::size_t i = 0; i < page.plots.size(); ++i)
        html += html_figure(page.plots[i], i < files.svgs.size() ? files.svgs[i] : "",
                            files.plots.drawn ? "its file is missing" : files.plots.reason, page.name + ".json");
    return html;
}

std::string repeat_html(const StudyPage& page) {
    const auto lines = repeat_lines(page);
    if (lines.empty()) return {};
    const auto line = [](const auto& one) {
        return fmt::format("<dt>{}</dt><dd><code>{}</code></dd>\n", html_text(one.first), html_text(one.second));
    };
    return "<dl>\n" + joined(lines, "", line) + "</dl>\n" +
           "<p class=\"note\">For programs: " + link_to(page.name + ".json") +
           "; as text: " + link_to(page.name + ".md") + ".</p>\n";
}

}  // namespace

std::string html_verdict(ClaimVerdict verdict) {
    constexpr const char* kClasses[] = {"yes", "no", "open"};
    return fmt::format("<span class=\"verdict {}\">{}</span>", kClasses[static_cast<int>(verdict)],
                       verdict_text(verdict));
}

std::string page_html(const StudyPage& page, const PageFiles& files) {
    std::string html = fmt::format("<section class=\"study\" id=\"{}\">\n<h2>{}</h2>\n<p class=\"question\">{}</p>\n",
                                   html_text(page.name), html_prose(page.title), html_prose(page.question));
    html += html_section("How it was done", html_list(page.method));
    if (!page.clock.empty()) html += "<p>Times: " + html_prose(page.clock) + "</p>\n";
    html += html_section("What is seen", html_list(page.findings));
    html += html_section("What the papers say", claims_html(page));
    html += html_section(comparison_title(page), comparisons_html(page));
    html += joined(page.pictures, "", picture_html) + figures_html(page, files);
    for (const StudyTable& table : page.tables) html += table_html(table);
    html += html_section("What is new", html_list(page.news));
    html += html_section("How to repeat it", repeat_html(page));
    return html + "</section>\n";
}

}  // namespace raya
