// raya page, and --page of the commands that write reports: both make equal pages; raya explore.
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
    for (const Arguments& extra_options : {Arguments{"--machine", "torus", "--nodes", "2x2x2", "--bounces", "4"},
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

TEST_CASE("explore: two runs write equal pages, without folders", "[cli][page]") {
    const ScratchFolder folder;
    for (const char* page : {"a.html", "b.html"}) {
        const RunOutcome run =
            run_raya({"explore", scene_file("spheres"), "--size", "24x16", "--lanes", "4", "-o", folder / page, "--pes",
                      "20", "--mapping", "cyclic:3", "--fold", "block", "--from", "3,-6,4"});
        INFO(run.describe());
        REQUIRE(run.code == 0);
        CHECK_THAT(run.out, Contains("24 x 16 pixels; the page opens with cyclic:3 on 20 PEs: u = "));
    }
    const std::string html = file_contents(folder / "a.html");
    CHECK(html == file_contents(folder / "b.html"));
    CHECK_THAT(html, StartsWith("<!doctype html>") && !Contains(RAYA_SOURCE_DIR));
    for (const char* member :
         {"\"scene\": \"spheres.nff\"", "\"mapping\": \"cyclic\"", "\"offset\": 3", "\"fold\": \"block\"",
          "\"pes\": 20", "raya render spheres.nff -o image.png --size 24x16 --from 3,-6,4"})
        CHECK_THAT(html, Contains(member));
}

}  // namespace
}  // namespace raya
