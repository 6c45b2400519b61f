// raya explore: the page that it writes, and what it refuses.
#include <catch2/catch.hpp>

#include "tests/base/scratch_folder.hpp"
#include "tests/cli/run_program.hpp"

namespace raya {
namespace {

using Catch::Matchers::Contains;
using Catch::Matchers::StartsWith;

std::vector<std::string> small(std::vector<std::string> more) {
    std::vector<std::string> words = {"explore", scene_file("spheres"), "--size", "24x16", "--lanes", "4"};
    words.insert(words.end(), more.begin(), more.end());
    return words;
}

TEST_CASE("explore writes a page and says what it opens with", "[cli]") {
    const ScratchFolder folder;
    const std::string page = folder / "page.html";
    const RunOutcome run = run_raya(small({"-o", page, "--pes", "20", "--mapping", "cyclic:3", "--fold", "block"}));
    INFO(run.told());
    REQUIRE(run.code == 0);
    CHECK(run.err.empty());
    CHECK_THAT(run.out, Contains("24 x 16 pixels, opens with cyclic:3 on 20 PEs: u = ") && Contains("page    " + page));
    const std::string html = file_contents(page);
    CHECK_THAT(html, StartsWith("<!doctype html>"));
    for (const char* member :
         {"\"scene\": \"spheres.nff\"", "\"mapping\": \"cyclic\"", "\"offset\": 3", "\"fold\": \"block\"",
          "\"pes\": 20", "raya render spheres.nff -o image.png --size 24x16"})
        CHECK_THAT(html, Contains(member));
    CHECK(folder.entries() == 1);
    const RunOutcome again =
        run_raya(small({"-o", page, "--pes", "20", "--mapping", "cyclic:3", "--fold", "block", "--quiet"}));
    CHECK(again.code == 0);
    CHECK(again.out.empty());
    CHECK(file_contents(page) == html);  // the same picture, the same page
}

TEST_CASE("what explore refuses names the reason and leaves nothing behind", "[cli]") {
    struct Row {
        std::vector<std::string> options;
        std::string reason;
    };
    const ScratchFolder folder;
    const std::string page = folder / "page.html";
    for (const Row& row :
         {Row{{"-o", folder / "page.png"}, "let the name end in .html"},
          Row{{"-o", folder / "no/page.html"}, "does not exist; make it first"},
          Row{{"-o", page, "--mapping", "dynamic:4"}, "the explorer shows static mappings"},
          Row{{"-o", page, "--machine", "links"},
              "choose cyclic, column, rows, blocks, grid, tiles or "
              "random by --mapping"},
          Row{{"-o", page, "--machine", "torus"}, "its nodes hold voxels of the scene"},
          Row{{"-o", page, "--pes", "0"}, "--pes 0: must be 1..384"},
          Row{{"-o", page, "--mapping", "tiles:7x5"}, "tiles must divide the image"},
          Row{{"-o", page, "--antialias", "filter"}, "no option --antialias"}, Row{{}, "--output is required"}}) {
        const RunOutcome run = run_raya(small(row.options));
        INFO(run.told());
        CHECK(run.code == 2);
        CHECK_THAT(run.err, Contains(row.reason));
        CHECK(folder.entries() == 0);
    }
}

TEST_CASE("explore refuses more pixels than a page can hold before it renders them", "[cli]") {
    const ScratchFolder folder;
    const RunOutcome run = run_raya({"explore", scene_file("spheres"), "-o", folder / "page.html", "--size", "1500"});
    INFO(run.told());
    CHECK(run.code == 2);
    CHECK_THAT(run.err, Contains("--size 1500x1500: too many pixels for a page") && Contains("remedy"));
    CHECK(folder.entries() == 0);
}

TEST_CASE("explore refuses a page that is too large to be sent", "[cli][.][long]") {
    const ScratchFolder folder;
    const RunOutcome run =
        run_raya({"explore", scene_file("centre"), "-o", folder / "page.html", "--size", "1400", "--pes", "4",
                  "--lanes", "4", "--bounces", "3", "--machine", "grande", "--format", "fp32"});
    INFO(run.told());
    CHECK(run.code == 2);
    CHECK_THAT(run.err, Contains("1000000 at most so that it can be sent; remedy: --size 1"));
    CHECK(folder.entries() == 0);
}

TEST_CASE("explore on a device that there is not leaves an older page as it was", "[cli]") {
    const ScratchFolder folder;
    const std::string page = folder / "page.html";
    std::ofstream(page) << "older";
    const RunOutcome run = run_raya(small({"-o", page, "--device", "no such device"}));
    INFO(run.told());
    CHECK(run.code != 0);
    CHECK(file_contents(page) == "older");
    CHECK(folder.entries() == 1);
}

}  // namespace
}  // namespace raya
