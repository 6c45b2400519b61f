#include "host/study/document.hpp"

#include <fmt/core.h>

#include "host/base/read_file.hpp"
#include "host/base/whole_file.hpp"
#include "host/page/html.hpp"
#include "host/page/html_document.hpp"
#include "host/study/conclusion.hpp"
#include "host/study/prose.hpp"
#include "host/study/references.hpp"
#include "host/study/rows.hpp"

namespace raya {
namespace {

using Pages = std::span<const StudyPage>;

std::string link_to(const StudyPage& page) {
    return fmt::format("<a href=\"#{}\">{}</a>", html_text(page.name), html_prose(page.title));
}

std::string part(const std::string& id, const std::string& title, const std::string& html) {
    if (html.empty()) return {};
    return fmt::format("<section id=\"{}\">\n<h2>{}</h2>\n{}</section>\n", id, title, html);
}

// Of each page that has some: its title as a link and its sentences.
template <class Sentences>
std::string by_page(Pages pages, Sentences sentences) {
    std::string html;
    for (const StudyPage& page : pages)
        for (const std::string& sentence : sentences(page))
            html += fmt::format("<li>{}: {}</li>\n", link_to(page), html_prose(sentence));
    return html.empty() ? html : "<ul>\n" + html + "</ul>\n";
}

std::string conclusion_html(Pages pages) {
    std::string html = html_list(verdict_sentences(pages));
    html += html_section("Not reproduced", html_list(claims_with(pages, ClaimVerdict::kNotReproduced)));
    if (pages.size() == 1) return html;  // the rest stands right below
    const auto chief = [](const StudyPage& page) {
        return std::vector(page.findings.begin(), page.findings.begin() + !page.findings.empty());
    };
    return html + html_section("Chief findings", by_page(pages, chief)) +
           html_section("What is new", by_page(pages, [](const StudyPage& page) { return page.news; }));
}

std::string claims_html(Pages pages) {
    if (pages.size() == 1) return {};
    TextCells html = {{"paper", "place", "says", "verdict", "why", "study"}};
    for (const StudyPage& page : pages)
        for (const Claim& c : page.claims)
            html.push_back({html_prose(c.paper), html_prose(c.place), html_prose(c.words), html_verdict(c.verdict),
                            html_prose(c.why), link_to(page)});
    return html.size() > 1 ? html_table({"Every claim and its verdict", html}) : "";
}

std::string contents_html(Pages pages) {
    if (pages.size() < 2) return {};
    const auto item = [](const StudyPage& page) { return "<li>" + link_to(page) + "</li>\n"; };
    return "<nav aria-label=\"Contents\">\n<h2>Contents</h2>\n<ol>\n" + joined(pages, "", item) + "</ol>\n</nav>\n";
}

// What all pages have in common; each tells the rest itself.
std::string run_html(Pages pages) {
    const RunRecord& run = pages.front().run;
    if (run.version.empty()) return {};
    const std::string command = pages.size() > 1 ? "raya study all -o DIR" : run.command;
    return fmt::format("<p>Made by <code>{}</code>, raya {}, on {} ({}, driver {}).</p>\n", html_text(command),
                       html_text(run.version), html_text(run.device), html_text(run.platform), html_text(run.driver));
}

std::string references_html(const std::string& text) {
    std::vector<std::string> cited;
    for (const Reference& reference : references())
        if (text.find(html_text(reference.authors)) != std::string::npos) cited.push_back(reference.full);
    return html_list(cited);
}

PageFiles files_of(const std::filesystem::path& folder, const StudyPage& page, const PlotOutcome& plots) {
    PageFiles files{plots};
    try {
        if (plots.drawn)
            for (const StudyPlot& plot : page.plots) files.svgs.push_back(read_file(folder / (plot.name + ".svg")));
    } catch (const UnreadableFile& problem) {
        files = {{false, problem.what()}};
    }
    return files;
}

}  // namespace

std::string document_html(Pages pages, const std::vector<PageFiles>& files) {
    const StudyPage about = page_about("laboratory", {});
    const std::string title = (pages.size() > 1 ? "" : pages.front().title + " - ") + about.title;
    std::string body = part("asked", "What was asked",
                            "<p>" + html_prose(about.question) + "</p>\n" + html_list(about.method) + run_html(pages));
    body += part("conclusion", "Conclusion", conclusion_html(pages));
    body += part("claims", "Every claim", claims_html(pages));
    for (std::size_t i = 0; i < pages.size(); ++i) body += page_html(pages[i], files.at(i));
    body += part("references", "References", references_html(body));
    return html_document({title,
                          fmt::format("<header><h1>{}</h1></header>\n", html_text(about.title)) + contents_html(pages) +
                              "<main>\n" + body + "</main>\n",
                          {"host/study/document/style.css"},
                          {"host/page/assets/tables.js", "host/study/document/plots.js"}});
}

void write_document(const std::filesystem::path& folder, Pages pages, const std::vector<PlotOutcome>& plots) {
    std::vector<PageFiles> files;
    for (std::size_t i = 0; i < pages.size(); ++i) files.push_back(files_of(folder, pages[i], plots.at(i)));
    write_whole_file(folder / "index.html", document_html(pages, files));
}

}  // namespace raya
