// raya page, and --page of the commands that write reports: both make equal pages. raya page refuses files that are not
// reports.
#include <catch2/catch.hpp>

#include "tests/base/scratch_folder.hpp"
#include "tests/cli/run_program.hpp"
#include "tests/document.hpp"
#include "tests/kernels/write_kernels.hpp"
#include "tests/verify/faults.hpp"

namespace raya {
namespace {

using Catch::Matchers::Contains;
using Catch::Matchers::StartsWith;

Arguments joined(Arguments arguments, const Arguments& extra_arguments) {
    arguments.insert(arguments.end(), extra_arguments.begin(), extra_arguments.end());
    return arguments;
}

Arguments render_24x16(const ScratchFolder& folder, const Arguments& extra_options = {}) {
    return joined(
        {"render", scene_file("planes"), "--size", "24x16", "--lanes", "4", "--quiet", "-o", folder / "c.pfm"},
        extra_options);
}

// Runs raya page without an OpenCL driver, so that it cannot repeat the command of the report.
RunOutcome page_of_file(const std::string& report, const std::string& page, const Arguments& extra_options = {}) {
    return run_raya(joined({"page", report, "-o", page}, extra_options),
                    {.variables = {{"OCL_ICD_VENDORS", "/nowhere"}, {"OCL_ICD_FILENAMES", ""}}});
}

// Runs the command with --report and --page, makes the page again from the report, checks that both pages are equal,
// and returns the page.
std::string check_page(const ScratchFolder& folder, const Arguments& command, int code = 0) {
    const std::string report = folder / "r.json", page = folder / "r.html", second_page = folder / "again.html";
    const RunOutcome run = run_raya(joined(command, {"--report", report, "--page", page}));
    INFO(run.describe());
    REQUIRE(run.code == code);
    const RunOutcome page_run = page_of_file(report, second_page);
    INFO(page_run.describe());
    REQUIRE(page_run.code == 0);
    CHECK_THAT(page_run.out, StartsWith("page    " + second_page));
    const std::string html = file_contents(page);
    CHECK(html == file_contents(second_page));
    CHECK(html.size() < 1'000'000);
    CHECK_THAT(html, StartsWith("<!doctype html>"));
    return html;
}

TEST_CASE("render --page: equals the page that raya page makes from the report", "[cli][page]") {
    const ScratchFolder folder;
    for (const Arguments& extra_options :
         {Arguments{"--pes", "20"}, Arguments{"--machine", "torus", "--nodes", "2x2x2"},
          Arguments{"--mapping", "dynamic:4", "--pes", "6"}}) {
        const std::string html = check_page(folder, render_24x16(folder, extra_options));
        const Document report = Document::parse(file_contents(folder / "r.json"));
        for (const std::string& part :
             {report["image"]["hash"].get<std::string>(), report["device"]["driver"].get<std::string>(),
              report["image"]["preview"]["png"].get<std::string>(), report["device"]["name"].get<std::string>()})
            CHECK_THAT(html, Contains(part));
        CHECK(report["measured"].contains("roofline"));
        CHECK(report["image"]["preview"]["width"] == 24);
    }
}

TEST_CASE("render --page: needs no --report, and raya page needs only the report", "[cli][page]") {
    const ScratchFolder folder;
    const RunOutcome run = run_raya(render_24x16(folder, {"--page", folder / "r.html"}));
    INFO(run.describe());
    CHECK(run.code == 0);
    CHECK(folder.entries() == 2);
    REQUIRE(run_raya(render_24x16(folder, {"--report", folder / "r.json"})).code == 0);
    const RunOutcome page_run = page_of_file(folder / "r.json", folder / "again.html", {"--quiet"});
    CHECK(page_run.code == 0);
    CHECK(page_run.out.empty());
    CHECK_THAT(file_contents(folder / "again.html"), !Contains("copy_bytes_per_s\":"));
}

TEST_CASE("verify --page: equals the page of its report, also after a failure", "[cli][page]") {
    const ScratchFolder folder;
    const std::string kernels = write_kernels(folder / "kernels", {kMappingFault});
    const std::string html = check_page(folder, {"verify", "--only", "mapping", "--kernel-dir", kernels}, 4);
    const Document device = Document::parse(file_contents(folder / "r.json"))["devices"][0];
    CHECK(device["failed"] >= 1);
    for (const Document& check : device["checks"]) CHECK_THAT(html, Contains("\"name\": " + check["name"].dump()));
}

TEST_CASE("bench --page: has rates, comparison and roofline", "[cli][page]") {
    const ScratchFolder folder;
    const Arguments bench = {"bench", scene_file("planes"), "--size", "24x16",    "--lanes",
                             "4",     "--samples",          "2",      "--format", "fp32"};
    REQUIRE(run_raya(joined(bench, {"--report", folder / "base.json"})).code == 0);
    CHECK(page_of_file(folder / "base.json", folder / "base.html").code == 0);
    const std::string html =
        check_page(folder, joined(bench, {"--compare", folder / "base.json", "--tolerance", "100"}));
    CHECK_THAT(html, Contains("\"baseline\": \"base.json\"") && Contains("copy_bytes_per_s\":"));
    CHECK(Document::parse(file_contents(folder / "r.json"))["compared"]["rows"].size() == 1);
}

TEST_CASE("page: the error for a file that is not a report names the reason, and raya writes no page", "[cli][page]") {
    const ScratchFolder folder, inputs;
    REQUIRE(run_raya(render_24x16(inputs, {"--report", inputs / "r.json"})).code == 0);
    const Document valid_report = Document::parse(file_contents(inputs / "r.json"));
    const auto write_changed_report = [&](const std::string& name, const auto& change) {
        Document report = valid_report;
        change(report);
        std::ofstream(inputs / name) << report.dump();
        return inputs / name;
    };
    struct Row {
        std::string report, page, reason;
    };
    const std::string page = folder / "p.html";
    std::ofstream(inputs / "broken.json") << "{\"kind\": \"raya render\",";
    std::ofstream(inputs / "list.json") << "[1, 2]";
    const std::vector<Row> rows = {
        {inputs / "none.json", page, "cannot be read: No such file"},
        {inputs / "c.pfm", page, "not valid JSON: "},
        {inputs / "broken.json", page, "not valid JSON: "},
        {inputs / "list.json", page, "not a report of raya render, bench, verify or gpu_day"},
        {scene_file("planes"), page, "not valid JSON"},
        {inputs / "r.json", folder / "p.png", "choose a name that ends in .html"},
        {inputs / "r.json", folder / "no/p.html", "does not exist; make it first"},
        {write_changed_report("old.json", [](Document& r) { r.erase("kind"), r.erase("raya"); }), page,
         "a report of an older raya"},
        {write_changed_report("other.json", [](Document& r) { r["kind"] = "raya ping"; }), page,
         "not a report of raya render"},
        {write_changed_report("warnings.json", [](Document& r) { r["warnings"] = {1}; }), page, "warnings"}};
    for (const Row& row : rows) {
        const RunOutcome run = page_of_file(row.report, row.page);
        INFO(run.describe());
        CHECK(run.code == 2);
        CHECK_THAT(run.err, Contains(row.reason));
        CHECK(folder.entries() == 0);
    }
    const RunOutcome unknown_member_run = page_of_file(write_changed_report("more.json",
                                                                            [](Document& r) {
                                                                                r["later"] = {{"a", 1}};
                                                                            }),
                                                       page);
    INFO(unknown_member_run.describe());
    CHECK(unknown_member_run.code == 0);
    const RunOutcome same_file_run = run_raya(render_24x16(folder, {"--report", page, "--page", page}));
    CHECK(same_file_run.code == 2);
    CHECK_THAT(same_file_run.err, Contains("the same file as --report"));
}

}  // namespace
}  // namespace raya
