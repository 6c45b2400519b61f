// The libraries that the program loads, from the log of the dynamic loader.
#include <algorithm>
#include <catch2/catch.hpp>
#include <filesystem>
#include <fstream>
#include <regex>
#include <set>

#include "tests/base/scratch_folder.hpp"
#include "tests/cli/device_with_fault.hpp"
#include "tests/cli/run_program.hpp"

namespace raya {
namespace {

using Names = std::set<std::string>;

/// Returns the file names of all libraries that raya and its child processes load, with LD_DEBUG (man 8 ld.so).
Names libraries_of(const std::vector<std::string>& arguments, int code = 0) {
    const ScratchFolder logs;
    const RunOutcome run =
        run_raya(arguments, {.variables = {{"LD_DEBUG", "files"}, {"LD_DEBUG_OUTPUT", logs / "process"}}});
    INFO(run.describe());
    REQUIRE(run.code == code);
    Names names;
    const std::regex initialised("calling init: .*/([^/\n]+)");
    for (const auto& process : std::filesystem::directory_iterator(logs.path())) {
        const std::string text = file_contents(process.path());
        for (std::sregex_iterator at(text.begin(), text.end(), initialised), end; at != end; ++at)
            names.insert((*at)[1]);
    }
    return names;
}

/// Returns those of `names` that contain one of `parts`.
Names names_containing(const Names& names, const std::vector<std::string>& parts) {
    Names found;
    std::copy_if(names.begin(), names.end(), std::inserter(found, found.end()), [&](const std::string& name) {
        return std::any_of(parts.begin(), parts.end(), [&](const std::string& part) { return contains(name, part); });
    });
    return found;
}

std::vector<std::string> render_4x4(const std::string& image) {
    return {"render", scene_file("planes"), "-o", image, "--size", "4", "--pes", "4", "--lanes", "4"};
}

TEST_CASE("--version: loads the OpenCL loader, three small libraries and the C and C++ libraries only", "[cli]") {
    Names names = libraries_of({"--version"});
    for (const std::string& sanitizer : names_containing(names, {"libasan", "libubsan"})) names.erase(sanitizer);
    if (kSanitized)  // the sanitizer build inlines less and needs Imath
        for (const std::string& imath : names_containing(names, {"libImath"})) names.erase(imath);
    CHECK(names.size() <= 9);
    const std::vector<std::string> known = {"libOpenCL.", "libfmt.", "libxxhash.", "libz.",       "libstdc++.", "libm.",
                                            "libgcc_s.",  "libc.",   "libdl.",     "libpthread.", "ld-linux"};
    CHECK(names_containing(names, known) == names);
}

TEST_CASE(
    "devices, renders to PFM and PPM: load neither OpenImageIO nor TBB nor MPI; a render to PNG loads OpenImageIO",
    "[cli]") {
    const ScratchFolder outputs;
    const std::vector<std::string> large_libraries = {"raya_", "OpenImageIO", "libtbb", "libmpi",
                                                      "libopen-"};  // libopen-*: libraries of Open MPI
    CHECK(names_containing(libraries_of({"devices"}), large_libraries).empty());
    for (const char* image : {"x.pfm", "x.ppm"})
        CHECK(names_containing(libraries_of(render_4x4(outputs / image)), large_libraries).empty());
    CHECK(names_containing(libraries_of(render_4x4(outputs / "x.png")), {"raya_pictures", "OpenImageIO"}).size() >= 2);
}

TEST_CASE("commands: refuse wrong inputs before they load a driver or OpenImageIO", "[cli]") {
    const ScratchFolder outputs;
    const std::string scene = scene_file("planes"), image = outputs / "x.png", missing = outputs / "none";
    std::ofstream(outputs / "bad.nff") << "v\nfrom 0 0 x\n";
    const std::vector<std::vector<std::string>> refused = {{"render", missing, "-o", image},
                                                           {"render", outputs / "bad.nff", "-o", image},
                                                           {"render", scene, "-o", outputs / "none/x.png"},
                                                           {"render", scene, "-o", image, "--size", "0"},
                                                           {"render", scene, "-o", image, "--kernel-dir", missing},
                                                           {"bench", missing},
                                                           {"tune", missing},
                                                           {"tune", "--kernel-dir", missing},
                                                           {"bench", "--compare", missing},
                                                           {"explore", missing, "-o", outputs / "x.html"},
                                                           {"verify", "--kernel-dir", missing}};
    for (const std::vector<std::string>& arguments : refused) {
        CAPTURE(arguments);
        CHECK(names_containing(libraries_of(arguments, 2), {"raya_pictures", "OpenImageIO", "libtbb", "libpocl"})
                  .empty());
    }
}

}  // namespace
}  // namespace raya
