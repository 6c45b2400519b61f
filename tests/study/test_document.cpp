// The document of all pages: everything that pages say stands in it, and nothing of it comes from elsewhere.
#include <catch2/catch.hpp>
#include <filesystem>
#include <regex>

#include "host/base/whole_file.hpp"
#include "host/embedded.hpp"
#include "host/error.hpp"
#include "host/page/html.hpp"
#include "host/study/conclusion.hpp"
#include "host/study/document.hpp"
#include "host/study/page_text.hpp"
#include "host/study/paper.hpp"
#include "host/study/references.hpp"
#include "host/study/studies.hpp"
#include "tests/base/scratch_folder.hpp"
#include "tests/study/small_page.hpp"

namespace raya {
namespace {

using Catch::Matchers::Contains;

const std::string kSvg = "<?xml?>\n<svg id=\"plot-small-u\"><title>u over p</title></svg>\n";

StudyPage other_page() {
    StudyPage page;
    page.name = "other";
    page.title = "Another & more";
    page.question = "And then?";
    page.claims = {{"C 1999", "section 2", "Never.", ClaimVerdict::kNotReproduced, "It was, <once>."}};
    page.findings = {"Then it ends."};
    return page;
}

std::string small_document() {
    return document_html(std::vector{small_page(), other_page()}, {{{true, {}}, {kSvg}}, {}});
}

std::size_t count_of(const std::string& text, const std::string& what) {
    std::size_t count = 0;
    for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + what.size())) ++count;
    return count;
}

TEST_CASE("every word, claim, figure, table and setting of a page stands in the document", "[document]") {
    const std::string html = small_document();
    const StudyPage page = small_page();
    std::vector<std::string> words = {page.title, page.question, page.clock, page.beside, page.run.command};
    for (const auto* list : {&page.method, &page.findings, &page.news})
        words.insert(words.end(), list->begin(), list->end());
    for (const Claim& c : page.claims)
        words.insert(words.end(), {c.paper, c.place, c.words, c.why, verdict_text(c.verdict)});
    for (const Comparison& c : page.comparisons) words.insert(words.end(), {c.what, c.remark});
    for (const StudyTable& t : page.tables) words.insert(words.end(), {t.title, t.name + ".csv"});
    for (const StudyPlot& p : page.plots) words.push_back(p.title);
    for (const std::string& word : words) CHECK_THAT(html, Contains(html_prose(word)));
    for (const char* part : {"35 ± 5 ms", "140 ms (derived)", "raya 1.2.3", "a device", "driver 4.5", "small.json",
                             "<td>a|b &quot;c&quot;</td>", "`a` &lt;b&gt;.nff", "alt=\"one &lt;red&gt; pixel\"",
                             "src=\"data:image/png;base64,iVBORw0KGgo", "A dot.", "<td class=\"n\">0.33333</td>"})
        CHECK_THAT(html, Contains(part));
    CHECK(count_of(html, "<svg") == 1);
    CHECK(count_of(html, "<figure") == 2);
    CHECK(count_of(html, "<section class=\"study\"") == 2);
    for (const char* tag :
         {"section", "table", "ul", "li", "p", "div", "figure", "details", "dl", "tr", "td", "th", "a"})
        CHECK(count_of(html, std::string("<") + tag + ">") + count_of(html, std::string("<") + tag + " ") ==
              count_of(html, std::string("</") + tag + ">"));
}

TEST_CASE("the document begins with a conclusion from the verdicts, and every claim", "[document]") {
    const std::string html = small_document();
    const std::size_t conclusion = html.find("id=\"conclusion\""), claims = html.find("id=\"claims\""),
                      first = html.find("id=\"small\"");
    REQUIRE(first != std::string::npos);
    CHECK(conclusion < claims);
    CHECK(claims < first);
    const std::string front = html.substr(conclusion, first - conclusion);
    for (const char* part : {"Of 3 claims of 2 papers, 1 is reproduced, 1 is not, and 1 cannot be told.",
                             "Of 1 claim of C 1999, 0 are reproduced, 1 is not, and 0 cannot be told.",
                             "C 1999, section 2: &quot;Never.&quot; It was, &lt;once&gt;.", "It also multiplies.",
                             "<a href=\"#other\">Another &amp; more</a>: Then it ends."})
        CHECK_THAT(front, Contains(part));
    const std::string table = html.substr(claims, first - claims);
    for (const char* verdict :
         {"verdict yes\">reproduced", "verdict no\">not reproduced", "verdict open\">cannot be told"})
        CHECK(count_of(table, verdict) == 1);
}

TEST_CASE("where no claim is judged, the conclusion says so", "[document]") {
    CHECK(verdict_sentences({}) == std::vector<std::string>{"No claim of a paper is judged here."});
    const StudyPage page = small_page();
    CHECK(verdict_sentences({&page, 1}).size() == 1);
    CHECK(claims_with({&page, 1}, ClaimVerdict::kNotReproduced).empty());
}

TEST_CASE("the document asks for nothing from anywhere", "[document]") {
    const std::string html = small_document();
    CHECK_THAT(html, Contains("default-src 'none'"));
    for (const char* part : {"<link", "<iframe", "@import", "src=\"http", "src='", "fetch(", "XMLHttp", "import("})
        CHECK_THAT(html, !Contains(part));
    for (const char* file : {"host/page/assets/style.css", "host/page/assets/tables.js",
                             "host/study/document/style.css", "host/study/document/plots.js"}) {
        const std::string& text = embedded_files().at(file);
        CHECK_THAT(text, !Contains("url(") && !Contains("://") && !Contains("</"));
        CHECK(count_of(html, text) == 1);
    }
}

TEST_CASE("a script in a scene's name is text, wherever the name comes to stand", "[document]") {
    const std::string bad = "<script>alert(1)</script>\" onload='x'";
    StudyPage page = small_page();
    page.title = page.question = page.clock = page.beside = bad;
    page.method = page.findings = page.news = {bad};
    page.settings = {{bad.c_str(), bad}};
    page.run = {bad, bad, bad, bad, bad};
    page.comparisons = {{bad, bad, 1, 2, bad}};
    page.claims = {{bad, bad, bad, ClaimVerdict::kCannotTell, bad}};
    page.tables[0].title = page.tables[0].columns[0].label = bad;
    page.tables[0].rows[0][2] = bad;
    page.pictures = {{bad, bad, bad, bad}};
    page.plots[0].title = page.plots[0].x_label = page.plots[0].series[0].label = bad;
    const PageFiles missing{{false, bad}};
    for (const std::vector<StudyPage>& pages : {std::vector{page}, std::vector{page, page}}) {
        const std::string html = document_html(pages, {missing, missing});
        CHECK(count_of(html, "<script") == 2);
        CHECK(count_of(html, "\" onload") == 0);
        CHECK(count_of(html, "&lt;script&gt;alert(1)&lt;/script&gt;&quot; onload=&#39;x&#39;") > 20);
    }
}

TEST_CASE("a plot that could not be drawn says why, and its points are open to read", "[document]") {
    const std::vector<StudyPage> pages = {small_page()};
    const std::string html = document_html(pages, {{{false, "there is no <pen>"}}});
    CHECK_THAT(html,
               Contains("Not drawn: there is no &lt;pen&gt;.") && Contains("<details open><summary>Its points (9)"));
    CHECK_THAT(html, Contains("<td>ours</td><td class=\"n\">0</td><td class=\"n\">1.5</td><td class=\"n\">0.25</td>"));
    CHECK_THAT(html, !Contains("<svg"));
}

TEST_CASE("the document appears whole or not at all", "[document]") {
    const ScratchFolder folder;
    StudyPage page = small_page();
    CHECK_THROWS_AS(write_document(folder / "missing", {&page, 1}, {{}}), UserError);
    write_whole_file(folder / "small-u.svg", kSvg);
    write_document(folder.path(), {&page, 1}, {{true, {}}});
    CHECK(folder.entries() == 2);
    CHECK_THAT(contents_of(folder / "index.html"), Contains("<svg id=\"plot-small-u\"") && Contains("</html>\n"));
    std::filesystem::remove(folder / "small-u.svg");  // by somebody else, after it was drawn
    write_document(folder.path(), {&page, 1}, {{true, {}}});
    CHECK_THAT(contents_of(folder / "index.html"), Contains("Not drawn: "));
}

TEST_CASE("the literature that pages speak of is named in full, and no other", "[document]") {
    const std::string html = small_document();
    CHECK_THAT(html, Contains("Comparison of Hierarchical Grids") && Contains("IPSJ"));  // the opening speaks of these
    CHECK_THAT(html, !Contains("Heirich"));
    StudyPage page = other_page();
    page.question = "As Heirich and Arvo (1998) found?";
    CHECK_THAT(document_html({&page, 1}, {{}}), Contains("A Competitive Analysis of Load Balancing"));
    for (const char* paper : {paper::kSpa, paper::kTp, paper::kGrid})
        CHECK(std::ranges::any_of(references(),
                                  [&](const Reference& r) { return std::string(paper).starts_with(r.authors); }));
}

}  // namespace
}  // namespace raya
