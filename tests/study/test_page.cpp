// What a study page becomes as CSV, JSON, Markdown and index, on made-up figures.
#include <fmt/format.h>

#include <bit>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstdlib>
#include <random>
#include <vector>

#include "host/error.hpp"
#include "host/study/page_writer.hpp"
#include "tests/base/scratch_folder.hpp"
#include "tests/document.hpp"
#include "tests/study/small_page.hpp"

namespace raya {
namespace {

using Catch::Matchers::Contains;
using Catch::Matchers::EndsWith;
using Row = std::vector<std::string>;

const std::string kComparisons =
    "|  | A & B 1993 | ours | ours / theirs | remark |\n"
    "|---|---|---|---|---|\n"
    "| u(0) | 1.5 | 1.575 | 1.05 | calibrated |\n"
    "| image transfer | 140 ms (derived) | 35 +- 5 ms | 0.25 |  |\n"
    "| u(8) | - | 0.3 | - | not printed |\n"
    "| lost | 0 rays | 2 rays | - |  |\n";

const std::string kPage =
    "# A small study\n\nDoes it add up?\n"
    "\n## How it was done\n\n- One image.\n- Two mappings.\n"
    "\nTimes: modelled.\n"
    "\n## Beside A & B 1993\n\n" +
    kComparisons +
    "\n## What the papers say\n\n"
    "| paper | says | verdict | why |\n"
    "|---|---|---|---|\n"
    "| A & B 1993, Fig. 1 | It adds up. | reproduced | 2 = 1 + 1. |\n"
    "| A & B 1993, Fig. 2 | Always. | cannot be told | Tried once. |\n"
    "\n## What is seen\n\n- It does.\n- Nearly.\n"
    "\n## What is new\n\n- It also multiplies.\n"
    "\n## Pictures\n\n![one <red> pixel](small-dot.png)\n\nA dot.\n"
    "\n## All offsets\n\n"
    "| p | u | which, if any |\n"
    "|---|---|---|\n"
    "| 0 | 0.33333 | a\\|b \"c\" |\n"
    "| -7 | inf | d, e |\n"
    "\nWith all digits: [small.csv](small.csv).\n"
    "\n## All loads\n\n2 rows, in [small-long.csv](small-long.csv).\n"
    "\n## Plots\n\n{}\n"
    "\n## How to repeat it\n\n- command: `raya study small -o DIR`\n- version: `raya 1.2.3`\n"
    "- device: `a device (a platform, driver 4.5)`\n- pes: `256`\n- scene: ``` `a` <b>.nff ```\n"
    "\nEverything on this page, for programs: [small.json](small.json).\n";

/// RFC 4180, read back by a reader that shares nothing with the writer.
std::vector<Row> read_csv(const std::string& text) {
    std::vector<Row> rows = {{""}};
    bool quoted = false;
    for (std::size_t i = 0; i < text.size(); ++i) {
        const char c = text[i];
        if (c == '"' && quoted && i + 1 < text.size() && text[i + 1] == '"')
            rows.back().back() += text[++i];
        else if (c == '"')
            quoted = !quoted;
        else if (c == ',' && !quoted)
            rows.back().emplace_back();
        else if (c == '\n' && !quoted)
            rows.push_back({""});
        else
            rows.back().back() += c;
    }
    rows.pop_back();  // after the last line end
    return rows;
}

TEST_CASE("the page says question, method, the paper's figures, findings, tables and plots in that order", "[page]") {
    CHECK(page_markdown(small_page(), {true, {}}) == fmt::format(fmt::runtime(kPage), "![u over p](small-u.svg)"));
}

TEST_CASE("the page says why plots are missing", "[page]") {
    CHECK(page_markdown(small_page(), {false, "there is no pen"}) ==
          fmt::format(fmt::runtime(kPage), "Not drawn: there is no pen. Then `tools/plot.py small.json` draws them."));
}

TEST_CASE("a page leaves out what it does not have", "[page]") {
    StudyPage page;
    page.name = "bare";
    page.title = "Bare";
    page.question = "Why?";
    CHECK(page_markdown(page, {true, {}}) ==
          "# Bare\n\nWhy?\n\nEverything on this page, for programs: [bare.json](bare.json).\n");
}

TEST_CASE("a page beside nobody's figures has no columns for them", "[page]") {
    StudyPage page = small_page();
    for (Comparison& c : page.comparisons) c.paper.reset();
    CHECK_THAT(page_markdown(page, {}), Contains("\n## Chief figures\n\n|  | ours | remark |\n|---|---|---|\n"
                                                 "| u(0) | 1.575 | calibrated |\n"));
}

TEST_CASE("CSV has all digits and quotes what it must", "[page]") {
    const StudyPage page = small_page();
    CHECK(table_csv(page.tables[0]) ==
          "p,u,\"which, if any\"\n0,0.3333333333333333,\"a|b \"\"c\"\"\"\n-7,inf,\"d,\ne\"\n");
    CHECK(table_csv(page.tables[1]) == "load (cycles)\n123456.75\n-0\n");
}

TEST_CASE("any cell comes back from CSV to the bit", "[page]") {
    std::mt19937_64 random(20250101);
    for (int round = 0; round < 500; ++round) {
        CAPTURE(round);
        StudyTable table{"t", "t", {{"text"}, {"count"}, {"value"}}};
        for (std::uint64_t i = random() % 5; i > 0; --i) {
            std::string text;
            for (std::uint64_t n = random() % 6; n > 0; --n) text += "a,\"\n\r|"[random() % 6];
            double value = std::bit_cast<double>(random());
            if (std::isnan(value)) value = -kInfinite;
            table.rows.push_back({text, static_cast<std::int64_t>(random()), value});
        }
        const std::vector<Row> back = read_csv(table_csv(table));
        REQUIRE(back.size() == table.rows.size() + 1);
        CHECK(back[0] == Row{"text", "count", "value"});
        for (std::size_t i = 0; i < table.rows.size(); ++i) {
            REQUIRE(back[i + 1].size() == 3);
            CHECK(back[i + 1][0] == std::get<std::string>(table.rows[i][0]));
            CHECK(std::strtoll(back[i + 1][1].c_str(), nullptr, 10) == std::get<std::int64_t>(table.rows[i][1]));
            CHECK(std::strtod(back[i + 1][2].c_str(), nullptr) == std::get<double>(table.rows[i][2]));
        }
    }
}

TEST_CASE("JSON has everything, with strings for what is infinite and null for what is not there", "[page]") {
    const auto json = Document::parse(page_json(small_page()).dump());
    CHECK(json["study"] == "small");
    CHECK(json["question"] == "Does it add up?");
    CHECK(json["method"].size() == 2);
    CHECK(json["settings"]["pes"] == 256);
    CHECK(json["findings"][1] == "Nearly.");
    const auto& compared = json["comparisons"];
    CHECK(compared[0] == Document{{"what", "u(0)"},
                                  {"unit", ""},
                                  {"paper", 1.5},
                                  {"ours", 1.575},
                                  {"ratio", 1.575 / 1.5},
                                  {"remark", "calibrated"},
                                  {"source", "printed"},
                                  {"half_width", nullptr}});
    CHECK(compared[1]["source"] == "derived");
    CHECK(compared[1]["half_width"] == 5);
    CHECK(json["clock"] == "modelled.");
    CHECK(json["beside"] == "A & B 1993");
    CHECK(json["run"] == Document{{"version", "1.2.3"},
                                  {"command", "raya study small -o DIR"},
                                  {"device", "a device"},
                                  {"platform", "a platform"},
                                  {"driver", "4.5"}});
    CHECK(json["claims"][1] == Document{{"paper", "A & B 1993"},
                                        {"place", "Fig. 2"},
                                        {"words", "Always."},
                                        {"verdict", "cannot be told"},
                                        {"why", "Tried once."}});
    CHECK(json["news"] == Document::parse("[\"It also multiplies.\"]"));
    CHECK(compared[2]["paper"].is_null());
    CHECK(compared[2]["ratio"].is_null());
    CHECK(compared[3]["paper"] == 0);
    CHECK(compared[3]["ratio"].is_null());
    CHECK(json["tables"][0]["rows"][0] == Document::parse("[0, 0.3333333333333333, \"a|b \\\"c\\\"\"]"));
    CHECK(json["tables"][0]["rows"][1][1] == "inf");
    CHECK(json["tables"][1]["rows"].size() == 2);
    CHECK(json["pictures"] ==
          Document::parse("[{\"name\":\"small-dot\",\"title\":\"A dot.\",\"words\":\"one <red> pixel\"}]"));
    const auto& plot = json["plots"][0];
    CHECK(plot["name"] == "small-u");
    CHECK(
        plot["description"] ==
        "Across: offset p (pixels), from 0 to 2. Up: imbalance u, logarithmic, from 0.25 to 4. Series: ours: 3 points, "
        "from 0.5 to 1.5, with 95 % intervals; steps: 3 points, from 1 to 3; scenes: 2 points, from 0.25 to 4; "
        "paper: 1 point, at 1.58.");
    CHECK(plot["log_x"] == false);
    CHECK(plot["log_y"] == true);
    CHECK(plot["x_label"] == "offset p (pixels)");
    CHECK(plot["series"][0]["y"] == Document::parse("[1.5, 0.5, \"inf\"]"));
    CHECK(plot["series"][0]["half_widths"] == Document::parse("[0.25, 0, 1]"));
    CHECK(plot["series"][1]["half_widths"].size() == 0);
    const std::vector<std::string> styles = {"line", "steps", "points", "paper"};
    for (std::size_t i = 0; i < styles.size(); ++i) CHECK(plot["series"][i]["style"] == styles[i]);
}

TEST_CASE("numbers on a page have five digits and no needless exponent", "[page]") {
    StudyPage page;
    page.tables = {{"t", "T", {{"n"}}}};
    const std::vector<std::pair<double, std::string>> shown = {{-0.0, "0"},
                                                               {1, "1"},
                                                               {1.58049, "1.5805"},
                                                               {9999.96, "10000"},
                                                               {12345.6, "12346"},
                                                               {-140000, "-140000"},
                                                               {0.00001234, "1.234e-05"},
                                                               {2e15, "2e+15"}};
    for (const auto& [value, text] : shown) {
        page.tables[0].rows = {{value}};
        CHECK_THAT(page_markdown(page, {}), Contains("|---|\n| " + text + " |\n"));
    }
}

TEST_CASE("write_page writes page, JSON and tables, and plots, and nothing else", "[page]") {
    const ScratchFolder folder;
    StudyPage page = small_page();
    page.plots.clear();
    CHECK(write_page(folder.path(), page).drawn);
    CHECK(folder.entries() == 5);
    CHECK(contents_of(folder / "small-dot.png") == kRedPixel);
    CHECK(contents_of(folder / "small.md") == page_markdown(page, {true, {}}));
    CHECK(contents_of(folder / "small.csv") == table_csv(page.tables[0]));
    CHECK(contents_of(folder / "small-long.csv") == table_csv(page.tables[1]));
    CHECK(Document::parse(contents_of(folder / "small.json")) == read_back(page_json(page)));
}

TEST_CASE("a label in an encoding that JSON does not know does not stop the study", "[page]") {
    const ScratchFolder folder;
    StudyPage page = small_page();
    page.plots.clear();
    page.title = "f\xfcr";
    write_page(folder.path(), page);
    CHECK(Document::parse(contents_of(folder / "small.json"))["title"] == "f\xef\xbf\xbdr");
}

TEST_CASE("a page that contradicts itself is refused before anything is written", "[page]") {
    const ScratchFolder folder;
    StudyPage page = small_page();
    SECTION("a row too short") { page.tables[1].rows.push_back({}); }
    SECTION("two tables of one name") { page.tables[1].name = "small"; }
    SECTION("a picture called as a plot") { page.pictures[0].name = "small-u"; }
    SECTION("two plots of one name") { page.plots.push_back(page.plots[0]); }
    CHECK_THROWS_AS(write_page(folder.path(), page), std::invalid_argument);
    CHECK(folder.entries() == 0);
}

TEST_CASE("a folder that cannot be written to is refused", "[page]") {
    const ScratchFolder folder;
    CHECK_THROWS_AS(write_page(folder / "missing", small_page()), UserError);
    CHECK_THROWS_AS(write_index(folder / "missing", {}), UserError);
    CHECK(folder.entries() == 0);
}

TEST_CASE("the index tells the pages in their order", "[page]") {
    const ScratchFolder folder;
    StudyPage other;
    other.name = "other";
    other.title = "Another";
    other.question = "And then?";
    const std::vector<StudyPage> pages = {small_page(), other};
    write_index(folder.path(), pages);
    const std::string index = contents_of(folder / "index.md");
    for (const char* part :
         {"# The load laboratory\n", "Kohata & Ito 1993", "Yoshitani & Yamazaki", "Havran & Sixta 1999",
          "\n## Conclusion\n\n- Of 2 claims of A & B 1993, 1 is reproduced, 0 are not, and 1 "
          "cannot be told.\n"})
        CHECK_THAT(index, Contains(part));
    CHECK_THAT(index, EndsWith("\n## [A small study](small.md)\n\nDoes it add up?\n\n" + kComparisons +
                               "\nIt does.\n\n## [Another](other.md)\n\nAnd then?\n"));
    CHECK(folder.entries() == 1);
}

}  // namespace
}  // namespace raya
