// Kernels that were compiled before: beside the program, taken only where they are right and nobody else may change
// them.
#include <sys/stat.h>

#include <filesystem>
#include <fstream>

#include "tests/cli/refusals.hpp"
#include "tests/cli/render_files.hpp"
#include "tests/document.hpp"
#include "tests/paths.h"

namespace raya {
namespace {
namespace fs = std::filesystem;

/// A copy of the program, which has no modules.
struct Copy {
    ScratchFolder folder, outputs;

    Copy() { fs::copy_file(RAYA_PROGRAM, folder / "raya"); }

    RunOutcome render(const Words& more, const std::string& binaries = "") const {
        const ScratchFolder cache;
        Words words = {"render", scene_file("planes"), "-o",      outputs / "x.pfm", "--size",   "16",
                       "--pes",  "4",                  "--lanes", "4",               "--format", "fp32",
                       "-vv",    "--report",           outputs / "r.json"};
        words.insert(words.end(), more.begin(), more.end());
        const RunOutcome run =
            run_raya(words, {.variables = {{"POCL_CACHE_DIR", cache.path()}, {"RAYA_BINARIES", binaries}},
                             .program = folder / "raya"});
        INFO(run.told());
        REQUIRE(run.code == 0);
        return run;
    }

    std::string hash() const { return json_of(outputs / "r.json")["image"]["hash"]; }

    fs::path binary() const {
        REQUIRE(std::distance(fs::directory_iterator(folder / "kernels"), {}) == 1);
        return *fs::directory_iterator(folder / "kernels");
    }
};

bool took_binary(const RunOutcome& run) { return contains(run.err, "from the binary that came with raya"); }

TEST_CASE("kernels that were kept are taken by the next render, which makes the same image", "[cli]") {
    const Copy copy;
    CHECK_FALSE(took_binary(copy.render({})));
    CHECK_FALSE(fs::exists(copy.folder / "kernels"));
    const std::string right = copy.hash();
    CHECK_FALSE(took_binary(copy.render({"--keep-kernels"})));
    CHECK(took_binary(copy.render({})));
    CHECK(copy.hash() == right);
    CHECK_FALSE(took_binary(copy.render({}, "off")));
    CHECK(copy.hash() == right);
    CHECK_FALSE(took_binary(copy.render({"--bounces", "1"})));  // another program
}

TEST_CASE("kernels that are damaged or that others may write are not taken", "[cli]") {
    const Copy copy;
    copy.render({"--keep-kernels"});
    const std::string right = copy.hash();
    const fs::path binary = copy.binary();
    ::chmod(binary.c_str(), 0666);
    CHECK_FALSE(took_binary(copy.render({})));
    ::chmod(binary.c_str(), 0644);
    CHECK(took_binary(copy.render({})));
    std::ofstream(binary) << "no binary";
    CHECK_FALSE(took_binary(copy.render({})));
    CHECK(copy.hash() == right);
    copy.render({"--keep-kernels"});  // which writes it anew
    CHECK(took_binary(copy.render({})));
}

TEST_CASE("RAYA_BINARIES is off or not set", "[cli]") {
    const ScratchFolder outputs;
    check_refused(outputs, {"render", scene_file("planes"), "-o", outputs / "x.pfm", "--size", "16"}, 2,
                  {"RAYA_BINARIES=on: must be off, or not set"}, {.variables = {{"RAYA_BINARIES", "on"}}});
}

}  // namespace
}  // namespace raya
