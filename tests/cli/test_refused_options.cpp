// Options that the program refuses: exit code 2, and a message with the option, its value and the valid values.
#include <OpenImageIO/oiioversion.h>
#include <fmt/core.h>
#include <sys/stat.h>

#include <filesystem>

#include "tests/cli/refusals.hpp"
#include "tests/paths.h"
#include "tests/thorough.hpp"

namespace raya {
namespace {

struct OptionsRow {
    Arguments options;
    Arguments message;
};

void check_render_options(const std::vector<OptionsRow>& rows) {
    const ScratchFolder outputs;
    for (const OptionsRow& row : quick_of(3, rows))
        check_refused(outputs, render_into(outputs, scene_file("planes"), row.options), 2, row.message);
}

TEST_CASE("render: the error for an unknown name lists the known names", "[cli]") {
    check_render_options({{{"--machine", "sparc"}, {"--machine sparc", "spa, grande"}},
                          {{"--mapping", "spiral"}, {"--mapping spiral", "cyclic, cyclic:p, column", "random:seed"}},
                          {{"--fold", "diagonal"}, {"--fold diagonal", "cyclic or block"}},
                          {{"--format", "e4m15"}, {"--format e4m15", "fp32", "X = 5..8"}},
                          {{"--format", "e6m22"}, {"--format e6m22", "Y = 4..21"}},
                          {{"--format", "e6m15x"}, {"--format e6m15x", "spa22"}},
                          {{"--sampling", "random"}, {"--sampling random", "centres or corners"}}});
}

TEST_CASE("render: the error for a number outside its range names the range", "[cli]") {
    check_render_options({{{"--lanes", "3"}, {"--lanes 3", "1, 4, 8 or 16"}},
                          {{"--lanes", "0"}, {"--lanes 0", "1, 4, 8 or 16"}},
                          {{"--group", "1025"}, {"--group 1025", "1..1024"}},
                          {{"--group", "0"}, {"--group 0", "1..1024"}},
                          {{"--bounces", "32"}, {"--bounces 32", "0..31"}},
                          {{"--size", "8", "--pes", "0"}, {"--pes 0", "1..64", "at most one for each pixel"}},
                          {{"--size", "8x4", "--pes", "33"}, {"--pes 33", "1..32"}},
                          {{"--size", "8x16", "--pes", "8", "--offset", "8"}, {"--offset 8", "0..7", "width"}},
                          {{"--size", "100000"}, {"--size 100000x100000", "1..16384 pixels"}},
                          {{"--size", "16385x1"}, {"--size 16385x1", "1..16384 pixels"}}});
}

TEST_CASE("render --mapping: refuses wrong syntax, and conflicts with image, PEs, offset and fold", "[cli]") {
    check_render_options(
        {{{"--mapping", "grid:4"}, {"--mapping grid:4:", "grid:AxB with A rows of B PEs"}},
         {{"--mapping", "grid:4x4", "--pes", "8"}, {"--pes 8 with --mapping grid:4x4", "16 PEs; omit --pes"}},
         {{"--mapping", "grid:4x4", "--size", "3"}, {"--mapping grid:4x4: 16 PEs", "1..9"}},
         {{"--mapping", "tiles:5x4", "--size", "12", "--pes", "8"}, {"--mapping tiles:5x4", "12 x 12", "tiles:4x4"}},
         {{"--mapping", "cyclic:12", "--size", "12", "--pes", "8"}, {"--mapping cyclic:12", "0..11", "width"}},
         {{"--mapping", "cyclic:3", "--offset", "4"}, {"--offset 4 with --mapping cyclic:3", "offset is 3"}},
         {{"--mapping", "column", "--offset", "4"}, {"--offset 4 with --mapping column", "offset is 0"}},
         {{"--mapping", "rows", "--offset", "0"}, {"--offset 0 with --mapping rows", "no offset", "choose cyclic"}},
         {{"--mapping", "tiles:4x4", "--fold", "cyclic"},
          {"--fold with --mapping tiles:4x4", "no slots to fold", "cyclic or column"}},
         {{"--mapping", "random", "--antialias", "filter"},
          {"--antialias filter with --mapping random:1", "the neighbours of a pixel are on random PEs",
           "use cyclic, column, rows, blocks, grid or tiles"}}});
}

TEST_CASE("render: the error for a very large number names the range", "[cli]") {
    check_render_options({{{"--lanes", "4000000000"}, {"--lanes 4000000000", "1, 4, 8 or 16"}},
                          {{"--group", "4000000000"}, {"--group 4000000000", "1..1024"}},
                          {{"--bounces", "4000000000"}, {"--bounces 4000000000", "0..31"}}});
}

TEST_CASE("render --size: refuses wrong syntax", "[cli]") {
    for (const std::string size : {"0", "12y", "8x", "x8", "8x8x8", "-4", "1e2"})
        check_render_options({{{"--size", size}, {"--size " + size + ": must be"}}});
}

TEST_CASE("render: refuses a text that is not a whole number", "[cli]") {
    for (const std::string option : {"--pes", "--offset", "--bounces", "--group"})
        check_render_options({{{option, "x"}, {option + " x: not a whole number; " + option + ": "}}});
    for (const std::string value : {"-1", "4294967296"})
        check_render_options({{{"--pes", value}, {"--pes " + value + ": out of range", "1..W*H"}}});
    check_render_options({{{"--pes", "1.5"}, {"--pes 1.5: not a whole number", "1..W*H"}}});
}

TEST_CASE("raya: refuses unknown, missing and repeated arguments, and points to the help", "[cli]") {
    check_render_options({{{"--nonsense"}, {"raya: render: no option --nonsense; see raya render --help"}},
                          {{"--siz", "32"}, {"no option --siz (did you mean --size?)"}},
                          {{"second.nff"}, {"unexpected argument 'second.nff'; see raya render --help"}},
                          {{"--size"}, {"--size: value N|WxH missing", "--help"}},
                          {{"--pes", "4", "--pes", "5"}, {"--pes: takes one value, not 2", "--help"}}});
    const ScratchFolder outputs;
    const std::string scene = scene_file("planes");
    check_refused(outputs, {}, 2, {"raya: command missing; commands: render, explore, devices", "see raya --help"});
    check_refused(outputs, {"frobnicate"}, 2, {"raya: no command frobnicate; commands: render, explore, devices"});
    check_refused(outputs, {"rendr"}, 2, {"raya: no command rendr (did you mean render?); commands:"});
    check_refused(outputs, {"verify", "--ful"}, 2, {"no option --ful (did you mean --full?); see raya verify --help"});
    check_refused(outputs, {"render"}, 2, {"SCENE is required", "--help"});
    check_refused(outputs, {"render", scene}, 2, {"--output is required", "--help"});
    check_refused(outputs, {"devices", "extra"}, 2, {"extra", "--help"});
    check_refused(outputs, {"generate"}, 2, {"raya: generate: command missing; commands: balls, lattice", "--help"});
}

TEST_CASE("bench, generate: refuse numbers outside their ranges", "[cli]") {
    const ScratchFolder outputs;
    const std::string scene = outputs / "x.nff";
    check_refused(outputs, {"bench", "--samples", "0"}, 2, {"--samples 0", "1..1000"});
    check_refused(outputs, {"bench", "--samples", "1", "--lanes", "3"}, 2, {"--lanes 3", "1, 4, 8 or 16"});
    check_refused(outputs, {"generate", "balls", "--level", "7", "-o", scene}, 2, {"level 7", "0..6"});
    check_refused(outputs, {"generate", "balls", "--level", "-1", "-o", scene}, 2, {"level -1", "0..6"});
    check_refused(outputs, {"generate", "gears", "--size", "17", "-o", scene}, 2, {"size 17", "1..16"});
    check_refused(outputs, {"generate", "balls"}, 2, {"--output is required"});
    check_refused(outputs, {"generate", "uniform", "9", "--voxels", "2x2", "-o", scene}, 2, {"--voxels 2x2", "XxYxZ"});
    check_refused(outputs, {"generate", "uniform", "9", "--voxels", "257x1x1", "-o", scene}, 2,
                  {"257 voxels", "1..256"});
    check_refused(outputs, {"generate", "uniform", "9", "-o", scene}, 2, {"--voxels is required"});
    check_refused(outputs, {"generate", "random", "0", "-o", scene}, 2, {"0 spheres", "1..20000000"});
    check_refused(outputs, {"generate", "random", "20000001", "-o", scene}, 2, {"20000001 spheres", "1..20000000"});
    check_refused(outputs, {"generate", "terrain", "--triangles", "0", "-o", scene}, 2, {"0 triangles", "1..20000000"});
    check_refused(outputs, {"generate", "random", "9", "--seed", "x", "-o", scene}, 2, {"--seed", "x"});
}

TEST_CASE("render, generate: refuse a file that they cannot write, before any work", "[cli]") {
    const ScratchFolder outputs;
    const std::string scene = scene_file("planes"), image = outputs / "x.png", missing = outputs / "missing/x";
    check_refused(outputs, {"render", scene, "-o", outputs / "x.gif"}, 2, {"x.gif", ".png, .exr, .pfm"});
    check_refused(outputs, {"render", scene, "-o", outputs / "x"}, 2, {"extension", ".png, .exr, .pfm"});
    check_refused(outputs, {"render", scene, "-o", ""}, 2, {"--output", "must not be empty"});
    check_refused(outputs, {"render", scene, "-o", outputs.path()}, 2, {outputs.path(), "cannot write"});
    check_refused(outputs, {"render", scene, "-o", missing + ".png"}, 2, {"/missing' does not exist", "mkdir -p"});
    check_refused(outputs, {"render", scene, "-o", image, "--cost", outputs / "c.png"}, 2,
                  {"c.png", "one of .exr, .pfm"});
    check_refused(outputs, {"render", scene, "-o", image, "--cost", missing + ".exr"}, 2, {"/missing' does not exist"});
    check_refused(outputs, {"render", scene, "-o", image, "--report", missing + ".json"}, 2,
                  {"/missing' does not exist"});
    check_refused(outputs, {"render", scene, "-o", image, "--report", outputs.path()}, 2, {"it is a folder"});
    check_refused(outputs, {"generate", "centre", "-o", missing + ".nff"}, 2, {"/missing' does not exist"});
}

TEST_CASE("render: without OpenImageIO it refuses PNG and EXR before rendering, and writes PPM and PFM", "[cli]") {
    const ScratchFolder libraries, outputs;
    const std::string broken =
        libraries / fmt::format("libOpenImageIO.so.{}.{}", OIIO_VERSION_MAJOR, OIIO_VERSION_MINOR);
    std::ofstream(broken) << "no library";
    const RunOptions run_options{.variables = {{"LD_LIBRARY_PATH", libraries.path()}}};
    const std::string scene = scene_file("planes");
    for (const auto& [image, remedy] : {std::pair{"x.png", "name a .ppm file"},
                                        {"x.tif", "name a .ppm file"},
                                        {"x.jpg", "name a .ppm file"},
                                        {"x.exr", "name a .pfm file"}})
        check_refused(outputs, {"render", scene, "-o", outputs / image}, 2,
                      {outputs / image, "libOpenImageIO", "remedy: install OpenImageIO ", remedy}, run_options);
    for (const char* image : {"x.pfm", "x.ppm"}) {
        const RunOutcome run = run_raya(
            {"render", scene, "-o", outputs / image, "--size", "4", "--pes", "4", "--lanes", "4"}, run_options);
        INFO(run.describe());
        CHECK(run.code == 0);
    }
}

TEST_CASE("render: refuses a folder without write permission", "[cli]") {
    const ScratchFolder outputs;
    ::chmod(outputs.path().c_str(), 0555);
    const std::string refused = "'" + outputs.path().string() + "' is not writable";
    check_refused(outputs, render_into(outputs, scene_file("planes")), 2, {refused, "permissions"},
                  {.as_nobody = true});
    ::chmod(outputs.path().c_str(), 0755);
}

TEST_CASE("render --kernel-dir: refuses a folder without kernels", "[cli]") {
    const ScratchFolder empty;
    check_render_options(
        {{{"--kernel-dir", empty / "missing"}, {"--kernel-dir", "cannot read kernel file", "missing/"}},
         {{"--kernel-dir", empty.path()}, {"--kernel-dir", "cannot read kernel file", "kernels/"}}});
}

}  // namespace
TEST_CASE("render, generate: refuse empty values, negative counts and one file for two outputs", "[cli]") {
    const ScratchFolder outputs;
    const std::string scene = std::string(RAYA_SOURCE_DIR) + "/scenes/planes.nff", image = (outputs / "x.pfm").string();
    for (const char* option : {"--lanes", "--size", "--device", "--format", "--report"})
        check_refused(outputs, {"render", scene, "-o", image, option, ""}, 2, {option, "must not be empty"});
    check_refused(outputs, {"generate", "random", "5", "--seed", "-1", "-o", image}, 2,
                  {"--seed -1: out of range", "0..2^64-1"});
    check_refused(outputs, {"render", scene, "-o", image, "--cost", image}, 2, {"--cost", "the same file as --output"});
    check_refused(outputs, {"render", scene, "-o", image, "--report", scene}, 2,
                  {"--report", "would overwrite the input SCENE", "planes.nff"});
}

}  // namespace raya
