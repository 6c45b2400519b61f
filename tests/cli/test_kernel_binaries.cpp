// Kernel binaries next to the program: raya uses those for the same source and options that no other user can write.
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

/// A copy of the program without its modules.
struct ProgramCopy {
    ScratchFolder folder, outputs;

    ProgramCopy() { fs::copy_file(RAYA_PROGRAM, folder / "raya"); }

    RunOutcome render(const Arguments& extra_options, const std::string& binaries = "") const {
        const ScratchFolder cache;
        Arguments arguments = {"render",
                               scene_file("planes"),
                               "-o",
                               outputs / "x.pfm",
                               "--size",
                               "16",
                               "--pes",
                               "4",
                               "--lanes",
                               "4",
                               "--format",
                               "fp32",
                               "-vv",
                               "--report",
                               outputs / "r.json"};
        arguments.insert(arguments.end(), extra_options.begin(), extra_options.end());
        const RunOutcome run = run_raya(
            arguments,
            {.variables = {{"POCL_CACHE_DIR", cache.path()}, {"RAYA_BINARIES", binaries}}, .program = folder / "raya"});
        INFO(run.describe());
        REQUIRE(run.code == 0);
        return run;
    }

    std::string hash() const { return json_of(outputs / "r.json")["image"]["hash"]; }

    fs::path binary() const {
        REQUIRE(std::distance(fs::directory_iterator(folder / "kernels"), {}) == 1);
        return *fs::directory_iterator(folder / "kernels");
    }
};

bool used_binary(const RunOutcome& run) { return contains(run.err, "from the binary installed with raya"); }

TEST_CASE("render --cache-kernels: the next render uses the binary and makes the same image", "[cli]") {
    const ProgramCopy copy;
    CHECK_FALSE(used_binary(copy.render({})));
    CHECK_FALSE(fs::exists(copy.folder / "kernels"));
    const std::string expected_hash = copy.hash();
    CHECK_FALSE(used_binary(copy.render({"--cache-kernels"})));
    CHECK(used_binary(copy.render({})));
    CHECK(copy.hash() == expected_hash);
    CHECK_FALSE(used_binary(copy.render({}, "off")));
    CHECK(copy.hash() == expected_hash);
    CHECK_FALSE(used_binary(copy.render({"--bounces", "1"})));  // other options need another OpenCL program
}

TEST_CASE("kernel binaries: raya uses neither damaged binaries nor binaries that other users can write", "[cli]") {
    const ProgramCopy copy;
    copy.render({"--cache-kernels"});
    const std::string expected_hash = copy.hash();
    const fs::path binary = copy.binary();
    ::chmod(binary.c_str(), 0666);
    CHECK_FALSE(used_binary(copy.render({})));
    ::chmod(binary.c_str(), 0644);
    CHECK(used_binary(copy.render({})));
    std::ofstream(binary) << "no binary";
    CHECK_FALSE(used_binary(copy.render({})));
    CHECK(copy.hash() == expected_hash);
    copy.render({"--cache-kernels"});  // writes the binary again
    CHECK(used_binary(copy.render({})));
    fs::remove(binary);
    fs::create_directory(binary);  // cannot be read as a file
    CHECK_FALSE(used_binary(copy.render({})));
    CHECK(copy.hash() == expected_hash);
}

TEST_CASE("RAYA_BINARIES: refuses values other than off", "[cli]") {
    const ScratchFolder outputs;
    check_refused(outputs, {"render", scene_file("planes"), "-o", outputs / "x.pfm", "--size", "16"}, 2,
                  {"RAYA_BINARIES=on: must be off, or not set"}, {.variables = {{"RAYA_BINARIES", "on"}}});
}

}  // namespace
}  // namespace raya
