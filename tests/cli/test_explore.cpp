// raya explore: the page, and refused options.
#include <catch2/catch.hpp>

#include "tests/base/scratch_folder.hpp"
#include "tests/cli/run_program.hpp"

namespace raya {
namespace {

using Catch::Matchers::Contains;
using Catch::Matchers::StartsWith;

std::vector<std::string> explore_arguments(std::vector<std::string> extra_options) {
    std::vector<std::string> arguments = {"explore", scene_file("spheres"), "--size", "24x16", "--lanes", "4"};
    arguments.insert(arguments.end(), extra_options.begin(), extra_options.end());
    return arguments;
}

TEST_CASE("explore: writes a page and prints the mapping that it opens with", "[cli]") {
    const ScratchFolder folder;
    const std::string page = folder / "page.html";
    const RunOutcome run =
        run_raya(explore_arguments({"-o", page, "--pes", "20", "--mapping", "cyclic:3", "--fold", "block"}));
    INFO(run.describe());
    REQUIRE(run.code == 0);
    CHECK(run.err.empty());
    CHECK_THAT(run.out,
               Contains("24 x 16 pixels; the page opens with cyclic:3 on 20 PEs: u = ") && Contains("page    " + page));
    const std::string html = file_contents(page);
    CHECK_THAT(html, StartsWith("<!doctype html>"));
    for (const char* member :
         {"\"scene\": \"spheres.nff\"", "\"mapping\": \"cyclic\"", "\"offset\": 3", "\"fold\": \"block\"",
          "\"pes\": 20", "raya render spheres.nff -o image.png --size 24x16"})
        CHECK_THAT(html, Contains(member));
    CHECK(folder.entries() == 1);
    const RunOutcome second_run =
        run_raya(explore_arguments({"-o", page, "--pes", "20", "--mapping", "cyclic:3", "--fold", "block", "--quiet"}));
    CHECK(second_run.code == 0);
    CHECK(second_run.out.empty());
    CHECK(file_contents(page) == html);  // a second run writes the same page
}

TEST_CASE("explore: the error for wrong options names the reason, and raya writes no file", "[cli]") {
    struct Row {
        std::vector<std::string> options;
        std::string reason;
    };
    const ScratchFolder folder;
    const std::string page = folder / "page.html";
    for (const Row& row :
         {Row{{"-o", folder / "page.png"}, "choose a name that ends in .html"},
          Row{{"-o", folder / "no/page.html"}, "does not exist; make it first"},
          Row{{"-o", page, "--mapping", "dynamic:4"}, "the explorer shows static mappings"},
          Row{{"-o", page, "--machine", "links"},
              "choose cyclic, column, rows, blocks, grid, tiles or "
              "random with --mapping"},
          Row{{"-o", page, "--machine", "torus"}, "its nodes hold voxels of the scene"},
          Row{{"-o", page, "--pes", "0"}, "--pes 0: must be 1..384"},
          Row{{"-o", page, "--mapping", "tiles:7x5"}, "tiles must divide the image"},
          Row{{"-o", page, "--antialias", "filter"}, "no option --antialias"}, Row{{}, "--output is required"}}) {
        const RunOutcome run = run_raya(explore_arguments(row.options));
        INFO(run.describe());
        CHECK(run.code == 2);
        CHECK_THAT(run.err, Contains(row.reason));
        CHECK(folder.entries() == 0);
    }
}

TEST_CASE("explore: refuses more pixels than a page holds, before rendering", "[cli]") {
    const ScratchFolder folder;
    const RunOutcome run = run_raya({"explore", scene_file("spheres"), "-o", folder / "page.html", "--size", "1500"});
    INFO(run.describe());
    CHECK(run.code == 2);
    CHECK_THAT(run.err, Contains("--size 1500x1500: too many pixels for a page") && Contains("remedy"));
    CHECK(folder.entries() == 0);
}

TEST_CASE("explore: refuses a page of more than 1,000,000 bytes", "[cli][.][long]") {
    const ScratchFolder folder;
    const RunOutcome run =
        run_raya({"explore", scene_file("centre"), "-o", folder / "page.html", "--size", "1400", "--pes", "4",
                  "--lanes", "4", "--bounces", "3", "--machine", "grande", "--format", "fp32"});
    INFO(run.describe());
    CHECK(run.code == 2);
    CHECK_THAT(run.err, Contains("maximum 1000000; remedy: --size 1"));
    CHECK(folder.entries() == 0);
}

TEST_CASE("explore: with an unknown device it leaves an older page unchanged", "[cli]") {
    const ScratchFolder folder;
    const std::string page = folder / "page.html";
    std::ofstream(page) << "older";
    const RunOutcome run = run_raya(explore_arguments({"-o", page, "--device", "no such device"}));
    INFO(run.describe());
    CHECK(run.code != 0);
    CHECK(file_contents(page) == "older");
    CHECK(folder.entries() == 1);
}

}  // namespace
}  // namespace raya
