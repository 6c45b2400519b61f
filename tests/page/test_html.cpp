// What HTML is made of: escaping, sentences, tables.
#include <catch2/catch.hpp>

#include "host/page/html.hpp"
#include "host/page/html_document.hpp"

namespace raya {
namespace {

using Catch::Matchers::Contains;
using Catch::Matchers::StartsWith;

TEST_CASE("text holds nothing that a browser takes for a tag, an attribute's end or a character's name", "[html]") {
    CHECK(html_text("a<b>&\"c\"'d'&amp;") == "a&lt;b&gt;&amp;&quot;c&quot;&#39;d&#39;&amp;amp;");
    CHECK(html_text("f\xfc<r") == "f\xfc&lt;r");  // no UTF-8
    CHECK(html_text("</script><script>x()</script>").find_first_of("<>") == std::string::npos);
    CHECK(html_text("") == "");
}

TEST_CASE("a sentence has its code and its signs", "[html]") {
    CHECK(html_prose("u is 1 +- 2, see `--accel <x>`, `b`.") ==
          "u is 1 ± 2, see <code>--accel &lt;x&gt;</code>, <code>b</code>.");
    CHECK(html_prose("one ` alone") == "one ` alone");
    CHECK(html_prose("a `b` c ` d") == "a <code>b</code> c ` d");
    CHECK(html_list({}) == "");
    CHECK(html_list({"a", "<b>"}) == "<ul>\n<li>a</li>\n<li>&lt;b&gt;</li>\n</ul>\n");
    CHECK(html_section("Empty", "") == "");
}

TEST_CASE("columns of numbers are told from columns of words", "[html]") {
    const std::string html = html_table({"so & so", html_cells({{"word", "count", "figure", "mixed"},
                                                                {"4x4", "1", "35 +- 5 ms", "1"},
                                                                {"-", "-", "inf", "two"}})});
    CHECK_THAT(html, Contains("aria-label=\"so &amp; so\""));
    CHECK_THAT(html, Contains("<th scope=\"col\">word</th><th scope=\"col\" class=\"n\">count</th>"
                              "<th scope=\"col\" class=\"n\">figure</th><th scope=\"col\">mixed</th>"));
    CHECK_THAT(html, Contains("<td>4x4</td><td class=\"n\">1</td><td class=\"n\">35 ± 5 ms</td><td>1</td>"));
    CHECK(html_table({"none", {}}) == "");
    CHECK_THAT(html_table({"why", {{"why"}, {std::string(61, 'x')}}}), Contains("<td class=\"w\">xxx"));
}

TextCells rows(std::size_t count) {
    TextCells cells = {{"n"}};
    for (std::size_t i = 0; i < count; ++i) cells.push_back({std::to_string(i)});
    return cells;
}

std::size_t count_of(const std::string& text, const std::string& what) {
    std::size_t count = 0;
    for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + 1)) ++count;
    return count;
}

TEST_CASE("long tables are folded, longer ones cut, and both say where the rest is", "[html]") {
    const std::string few = html_folded_table({"t", rows(24)}, "see there");
    CHECK_THAT(few, StartsWith("<div"));
    CHECK_THAT(few, Contains("<p class=\"note\">see there</p>"));
    const std::string many = html_folded_table({"t", rows(25)}, "see there");
    CHECK_THAT(many, StartsWith("<details><summary>25 rows</summary>"));
    CHECK(count_of(many, "<tr>") == 26);
    const std::string most = html_folded_table({"t", rows(401)}, "see there");
    CHECK_THAT(most, Contains(">401 rows<") && Contains("The first 400 of 401 rows. see there"));
    CHECK(count_of(most, "<tr>") == 401);
}

TEST_CASE("a picture is within the page, with words for those who do not see it", "[html]") {
    CHECK(html_picture({"A `b`", "c \"d\"", "iVBORw=="}) ==
          "<figure>\n<img class=\"picture\" alt=\"c &quot;d&quot;\" src=\"data:image/png;base64,iVBORw==\">\n"
          "<figcaption>A <code>b</code></figcaption>\n</figure>\n");
}

TEST_CASE("a page has its title, styles before its body, scripts after it, and may fetch nothing", "[html]") {
    const std::string html = html_document(
        {"<a> & b", "<main>c</main>\n", {"host/study/document/style.css"}, {"host/page/assets/tables.js"}});
    CHECK_THAT(html, StartsWith("<!doctype html>"));
    CHECK_THAT(html, Contains("default-src 'none'") && Contains("<title>&lt;a&gt; &amp; b</title>"));
    const std::size_t base = html.find("What all pages have"), own = html.find("What the studies' document has"),
                      body = html.find("<main>c</main>"), script = html.find("<script>");
    CHECK((base < own && own < body && body < script && script != std::string::npos));
    CHECK(count_of(html, "</script>") == 1);
    CHECK_THROWS_AS(html_document({"a", "", {"no such file"}}), std::out_of_range);
}

}  // namespace
}  // namespace raya
