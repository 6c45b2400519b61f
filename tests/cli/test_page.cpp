// raya page, and --page of the commands that write reports: one page of one report, and what is refused.
#include <fmt/core.h>

#include <catch2/catch.hpp>
#include <random>

#include "host/cli/page.hpp"
#include "host/error.hpp"
#include "tests/base/scratch_folder.hpp"
#include "tests/cli/run_program.hpp"
#include "tests/document.hpp"
#include "tests/kernels/write_kernels.hpp"
#include "tests/thorough.hpp"
#include "tests/verify/faults.hpp"

namespace raya {
namespace {

using Catch::Matchers::Contains;
using Catch::Matchers::StartsWith;

using Words = std::vector<std::string>;

Words joined(Words words, const Words& more) {
    words.insert(words.end(), more.begin(), more.end());
    return words;
}

Words small_render(const ScratchFolder& folder, const Words& more = {}) {
    return joined(
        {"render", scene_file("planes"), "--size", "24x16", "--lanes", "4", "--quiet", "-o", folder / "c.pfm"}, more);
}

// No device is there, so that nothing can run again.
RunOutcome page_of_file(const std::string& report, const std::string& page, const Words& more = {}) {
    return run_raya(joined({"page", report, "-o", page}, more),
                    {.variables = {{"OCL_ICD_VENDORS", "/nowhere"}, {"OCL_ICD_FILENAMES", ""}}});
}

// Runs the command with both files, and makes the page once more of the report alone.
std::string check_page(const ScratchFolder& folder, const Words& command, int code = 0) {
    const std::string report = folder / "r.json", page = folder / "r.html", again = folder / "again.html";
    const RunOutcome run = run_raya(joined(command, {"--report", report, "--page", page}));
    INFO(run.told());
    REQUIRE(run.code == code);
    const RunOutcome made = page_of_file(report, again);
    INFO(made.told());
    REQUIRE(made.code == 0);
    CHECK_THAT(made.out, StartsWith("page    " + again));
    const std::string html = file_contents(page);
    CHECK(html == file_contents(again));
    CHECK(html.size() < 1'000'000);
    CHECK_THAT(html, StartsWith("<!doctype html>"));
    return html;
}

TEST_CASE("the page of a render is what raya page makes of its report", "[cli][page]") {
    const ScratchFolder folder;
    for (const Words& more : {Words{"--pes", "20"}, Words{"--machine", "torus", "--nodes", "2x2x2"},
                              Words{"--mapping", "dynamic:4", "--pes", "6"}}) {
        const std::string html = check_page(folder, small_render(folder, more));
        const Document report = Document::parse(file_contents(folder / "r.json"));
        for (const std::string& part :
             {report["image"]["hash"].get<std::string>(), report["device"]["driver"].get<std::string>(),
              report["image"]["preview"]["png"].get<std::string>(), report["device"]["name"].get<std::string>(),
              fmt::format("{:.3f}", report["load"]["imbalance"].get<double>()), std::string("<section id=\"roof\">")})
            CHECK_THAT(html, Contains(part));
        CHECK(report["measured"].contains("roofline"));
        CHECK(report["image"]["preview"]["width"] == 24);
    }
}

TEST_CASE("a page is written without a report, and a report has what a page needs", "[cli][page]") {
    const ScratchFolder folder;
    const RunOutcome run = run_raya(small_render(folder, {"--page", folder / "r.html"}));
    INFO(run.told());
    CHECK(run.code == 0);
    CHECK(folder.entries() == 2);
    REQUIRE(run_raya(small_render(folder, {"--report", folder / "r.json"})).code == 0);
    const RunOutcome made = page_of_file(folder / "r.json", folder / "again.html", {"--quiet"});
    CHECK(made.code == 0);
    CHECK(made.out.empty());
    CHECK_THAT(file_contents(folder / "again.html"), Contains("peak was not measured"));
}

TEST_CASE("the page of a verify has every check, and the first failure in full", "[cli][page]") {
    const ScratchFolder folder;
    const std::string kernels = write_kernels(folder / "kernels", {kMappingFault});
    const std::string html = check_page(folder, {"verify", "--only", "mapping", "--kernel-dir", kernels}, 4);
    const Document device = Document::parse(file_contents(folder / "r.json"))["devices"][0];
    std::size_t failures = 0;
    for (const Document& check : device["checks"]) {
        CHECK_THAT(html, Contains("<td>" + check["name"].get<std::string>() + "</td>"));
        failures += check["status"] == "FAIL";
    }
    CHECK(failures >= 1);
    CHECK_THAT(html, Contains("is not right") && Contains("<h4>Expected</h4>") && Contains("<h4>What to try</h4>"));
}

TEST_CASE("the page of a bench has rates, comparison and roofline", "[cli][page]") {
    const ScratchFolder folder;
    const Words bench = {"bench", scene_file("planes"), "--size", "24x16",    "--lanes",
                         "4",     "--samples",          "2",      "--format", "fp32"};
    REQUIRE(run_raya(joined(bench, {"--report", folder / "base.json"})).code == 0);
    CHECK(page_of_file(folder / "base.json", folder / "base.html").code == 0);
    CHECK_THAT(file_contents(folder / "base.html"),
               Contains("held against no baseline") && Contains("peak was not measured"));
    const std::string html =
        check_page(folder, joined(bench, {"--compare", folder / "base.json", "--tolerance", "100"}));
    CHECK_THAT(html, Contains("Held against base.json") && Contains("op/byte") && Contains("Mrays/s"));
    CHECK(Document::parse(file_contents(folder / "r.json"))["compared"]["rows"].size() == 1);
}

TEST_CASE("what raya page refuses names the reason and leaves nothing behind", "[cli][page]") {
    const ScratchFolder folder, written;
    REQUIRE(run_raya(small_render(written, {"--report", written / "r.json"})).code == 0);
    const Document good = Document::parse(file_contents(written / "r.json"));
    const auto changed = [&](const std::string& name, const auto& change) {
        Document report = good;
        change(report);
        std::ofstream(written / name) << report.dump();
        return written / name;
    };
    struct Row {
        std::string report, page, reason;
    };
    const std::string page = folder / "p.html";
    std::ofstream(written / "broken.json") << "{\"kind\": \"raya render\",";
    std::ofstream(written / "list.json") << "[1, 2]";
    const std::vector<Row> rows = {
        {written / "none.json", page, "cannot be read: No such file"},
        {written / "c.pfm", page, "not valid JSON (byte"},
        {written / "broken.json", page, "not valid JSON (byte"},
        {written / "list.json", page, "not a report of raya render, bench or verify"},
        {scene_file("planes"), page, "not valid JSON"},
        {written / "r.json", folder / "p.png", "let the name end in .html"},
        {written / "r.json", folder / "no/p.html", "does not exist; make it first"},
        {changed("old.json", [](Document& r) { r.erase("kind"), r.erase("raya"); }), page,
         "the report of an older raya"},
        {changed("other.json", [](Document& r) { r["kind"] = "raya ping"; }), page, "not a report of raya render"},
        {changed("small.json", [](Document& r) { r["image"].erase("preview"); }), page, "no small picture"},
        {changed("png.json", [](Document& r) { r["image"]["preview"]["png"] = "\"><script>"; }), page, "no PNG file"},
        {changed("pes.json", [](Document& r) { r["machine"]["pes"] = 7; }), page, "another length than machine.pes"},
        {changed("map.json", [](Document& r) { r["machine"]["mapping"] = "spiral"; }), page, "spiral"},
        {changed("load.json", [](Document& r) { r.erase("load"); }), page, "load"}};
    for (const Row& row : rows) {
        const RunOutcome run = page_of_file(row.report, row.page);
        INFO(run.told());
        CHECK(run.code == 2);
        CHECK_THAT(run.err, Contains(row.reason));
        CHECK(folder.entries() == 0);
    }
    const RunOutcome known = page_of_file(changed("more.json", [](Document& r) { r["later"] = {{"a", 1}}; }), page);
    INFO(known.told());
    CHECK(known.code == 0);
    const RunOutcome twice = run_raya(small_render(folder, {"--report", page, "--page", page}));
    CHECK(twice.code == 2);
    CHECK_THAT(twice.err, Contains("the same file as --report"));
}

TEST_CASE("reports with something missing or of another kind are refused, never worse", "[cli][page]") {
    const ScratchFolder folder;
    REQUIRE(run_raya(small_render(folder, {"--report", folder / "r.json", "--page", folder / "r.html"})).code == 0);
    const Document good = Document::parse(file_contents(folder / "r.json"));
    const auto paths = [&] {
        std::vector<std::string> all;
        const Document flat = good.flatten();
        for (const auto& [path, value] : flat.items()) all.push_back(path);
        return all;
    }();
    const std::uint32_t seed = 20;
    CAPTURE(seed);
    std::mt19937 random(seed);
    const std::vector<Document> odd = {nullptr, true, -1, 1e300, "<b>'\"&", Document::array(), Document::object()};
    int refused = 0, made = 0;
    const auto cases = static_cast<int>(quick_cases(300, 5000));
    for (int i = 0; i < cases; ++i) {
        Document::json_pointer place(paths[random() % paths.size()]);
        for (auto up = random() % 3; up > 0 && !place.parent_pointer().empty(); --up) place = place.parent_pointer();
        Document report = good;
        report[place] = odd[random() % odd.size()];
        CAPTURE(i, place.to_string(), report[place].dump());
        try {
            const std::string page = page_of_report(report.dump(), "r.json");
            CHECK(page.find("<b>'") == std::string::npos);
            ++made;
        } catch (const UserError& error) {
            CHECK_THAT(error.what(), StartsWith("r.json:") && Contains("remedy"));
            ++refused;
        }
    }
    CHECK(refused > cases / 20);
    CHECK(made > cases / 20);
}

}  // namespace
}  // namespace raya
