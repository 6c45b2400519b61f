// The output of commands that succeed.
#include <fmt/core.h>

#include <algorithm>
#include <sstream>
#include <thread>
#include <utility>

#include "host/version.hpp"
#include "tests/cli/device_with_fault.hpp"
#include "tests/cli/refusals.hpp"
#include "tests/cli/render_files.hpp"
#include "tests/document.hpp"

namespace raya {
namespace {
/// Runs raya and checks that it succeeds without messages.
RunOutcome run_successfully(const Arguments& arguments) {
    RunOutcome run = run_raya(arguments);
    INFO(run.describe());
    REQUIRE(run.code == 0);
    CHECK(run.messages().empty());
    return run;
}

std::vector<Arguments> lines_that_start_with(const std::string& text, const std::string& token) {
    std::istringstream lines(text);
    std::vector<Arguments> found;
    for (std::string line; std::getline(lines, line);) {
        const Arguments arguments = tokens_of(line);
        if (!arguments.empty() && arguments[0] == token) found.push_back(arguments);
    }
    return found;
}

TEST_CASE("raya --version: prints name, version, commit and build", "[cli]") {
    const std::string out = run_successfully({"--version"}).out;
    CHECK_THAT(out, Catch::StartsWith(fmt::format("{} (", name_and_version())));
    CHECK_THAT(out,
               Catch::Matches("raya [0-9.]+ \\((commit [0-9a-f]{12}( with changes)?, )?[A-Za-z]+, [A-Za-z]+ [0-9.]+"
                              "(, sanitizers)?\\)\n"));
    CHECK(std::string(name_and_version()) == fmt::format("raya {}", raya_version()));
}

TEST_CASE("raya --help: names every command and the exit codes", "[cli]") {
    const std::string help = squeezed(run_successfully({"--help"}).out);
    for (const char* text :
         {"render", "devices", "generate", "bench", "Exit codes: 0 done, 2 bad option or input, 3 device"})
        CHECK_THAT(help, Catch::Contains(text));
}

TEST_CASE("COMMAND --help, --help-all: give unit, default and range of every option", "[cli]") {
    struct Row {
        Arguments command;
        Arguments texts;  // expected in the help of the command
    };
    const Arguments shared_texts = {"--machine NAME spa: 256 PEs",
                                    "256 PEs of 32 KB",
                                    "grande",
                                    "--size N|WxH",
                                    "in pixels, 1..16384 a side; default: the scene's",
                                    "1..W*H; default: the machine's, or A*B of a grid",
                                    "in pixels, 0..W-1; default: 16",
                                    "--mapping NAME",
                                    "cyclic:p, column",
                                    "grid:AxB",
                                    "tiles:WxH",
                                    "random:seed",
                                    "cyclic|block",
                                    "(c P div W); default: cyclic",
                                    "--format NAME",
                                    "0..31; default: 8",
                                    "centres|corners",
                                    "default: centres",
                                    "1, 4, 8 or 16; default",
                                    "1..1024; default: as raya tune stored it, else 1 on a CPU",
                                    "RAYA_DEVICE",
                                    "--kernel-dir DIR"};
    Arguments render = shared_texts;
    render.insert(render.end(), {"SCENE", ".exr or .pfm (linear)", "modelled cycles of each pixel",
                                 "--report FILE.json", "--profile", "--trace FILE.json[.gz]", "--trace-events N",
                                 "default: 1000000", "--trace-pes N", "default: 16", "--quiet"});
    Arguments bench = shared_texts;
    bench.insert(bench.end(), {"--samples N", "are printed; default: 7", "default: 30 spheres and a plane, 512 x 512"});
    const std::vector<Row> rows = {
        {{"render"}, render},
        {{"bench"}, bench},
        {{"devices"}, {"every OpenCL device of every platform"}},
        {{"generate"}, {"balls", "lattice", "gears", "uniform", "random", "centre"}},
        {{"generate", "balls"}, {"--level N", "default: 4", "0..6", "7,381 spheres", "SCENE.nff"}},
        {{"generate", "lattice"}, {"--size N", "default: 12", "1..64", "2,197 spheres", "SCENE.nff"}},
        {{"generate", "gears"}, {"--size N", "default: 4", "1..16", "9,345 polygons", "SCENE.nff"}},
        {{"generate", "uniform"}, {"1..20000000", "--voxels XxYxZ", "1..256 each"}},
        {{"generate", "terrain"}, {"--triangles N", "1..20000000", "default: 100000", ".ply"}},
        {{"generate", "random"}, {"1..20000000", "--seed N", "default: 1"}},
        {{"generate", "centre"}, {"-o, --output SCENE.nff"}}};
    for (const Row& row : rows) {
        Arguments arguments = row.command;
        const bool has_long_help = row.command == Arguments{"render"} || row.command == Arguments{"bench"};
        arguments.emplace_back(has_long_help ? "--help-all" : "--help");
        const std::string help = squeezed(run_successfully(arguments).out);
        for (const std::string& text : row.texts) CHECK_THAT(help, Catch::Contains(text));
    }
}

TEST_CASE("machines: lists every machine with the source of each number, and the cited ones", "[cli]") {
    const std::string out = run_successfully({"machines"}).out;
    for (const char* name :
         {"spa: ", "grande: ", "spa1: ", "cap: ", "pixel-machine: ", "links: ", "torus: ", "sight: cited"})
        CHECK_THAT(out, Catch::Contains(name));
    for (const char* mark : {"[P]", "[D]", "[T]", "[?]"}) CHECK_THAT(out, Catch::Contains(mark));
    const std::string spa = run_successfully({"machines", "spa"}).out;
    CHECK_THAT(spa, Catch::Contains("256 DSPs") && Catch::Contains("6.51") && !Catch::Contains("torus: "));
}

TEST_CASE("machines: refuses a cited machine with the reason", "[cli]") {
    const RunOutcome run = run_raya({"machines", "sight"});
    CHECK(run.code == 2);
    CHECK_THAT(run.err, Catch::Contains("--machine sight: raya does not model this machine: no public description"));
}

TEST_CASE("devices: lists each device with its default number of lanes", "[cli]") {
    const std::string out = run_successfully({"devices"}).out;
    INFO(out);
    for (const char* part : {"driver ", " KB of local", " lanes and groups of ", "usable, exact division", "profiling"})
        CHECK_THAT(out, Catch::Contains(part));
    CHECK_THAT(out, Catch::StartsWith("0  "));
    CHECK_THAT(out, Catch::Contains("   OpenCL ") &&
                        Catch::Contains("--device and RAYA_DEVICE take a number, a type, or part of a name"));
}

TEST_CASE("render: prints a summary of at most 8 lines", "[cli]") {
    const RenderFiles files("centre");
    const Document report = files.report();
    const std::string& out = files.run().out;
    INFO(out);
    CHECK(files.run().messages().empty());
    CHECK(std::count(out.begin(), out.end(), '\n') <= 8);
    for (const char* text : {"20 x 12 pixels on spa (20 PEs, cyclic mapping, offset 16), e6m15, 8 bounces",
                             "240 primary", "u = ", "efficiency", "in each PE of 32 KB", "rays/s on ", "(4 lanes)"})
        CHECK_THAT(out, Catch::Contains(text));
    CHECK_THAT(out, Catch::Contains(report["image"]["hash"].get<std::string>()));
    CHECK_THAT(out, Catch::Contains(std::to_string(report["rays"]["shadow"].get<int>()) + " shadow"));
}

TEST_CASE("render --mapping grid: the summary names the mapping, which sets the number of PEs", "[cli]") {
    const ScratchFolder folder;
    const std::string out = run_successfully({"render", scene_file("planes"), "-o", folder / "x.png", "--size", "12",
                                              "--lanes", "4", "--mapping", "grid:3x2"})
                                .out;
    CHECK_THAT(out, Catch::Contains("12 x 12 pixels on spa (6 PEs, grid:3x2 mapping), e6m15"));
}

TEST_CASE("render --quiet: prints nothing", "[cli]") {
    const RunOutcome run = RenderFiles("centre", {"--quiet"}).run();
    CHECK(run.out.empty());
    CHECK(run.err.empty());
}

TEST_CASE("render --profile: prints launches and times of every labelled command", "[cli]") {
    const RenderFiles files("centre", {"--profile", "--quiet"});
    const std::string& out = files.run().out;
    INFO(out);
    REQUIRE(lines_that_start_with(out, "label").size() == 1);
    const auto commands = files.report()["measured"]["commands"];
    for (const auto& command : commands) CHECK_THAT(out, Catch::Contains(command["label"].get<std::string>()));
    CHECK_THAT(out, Catch::Contains("kernel build "));
    CHECK(lines_that_start_with(out, "roof").size() == 1);  // one line per kernel; trace is the only kernel
}

TEST_CASE("generate: every kind of scene can be rendered", "[cli]") {
    const Arguments kind = GENERATE(Arguments{"balls", "--level", "1"}, Arguments{"lattice", "--size", "2"},
                                    Arguments{"gears", "--size", "1"}, Arguments{"uniform", "9", "--voxels", "2x2x2"},
                                    Arguments{"random", "9", "--seed", "3"}, Arguments{"terrain", "--triangles", "9"},
                                    Arguments{"centre"});
    const ScratchFolder folder;
    Arguments arguments = {"generate"};
    arguments.insert(arguments.end(), kind.begin(), kind.end());
    arguments.insert(arguments.end(), {"-o", folder / "scene.nff"});
    CHECK(run_successfully(arguments).out.empty());
    run_successfully(
        {"render", folder / "scene.nff", "-o", folder / "x.png", "--size", "8", "--pes", "4", "--lanes", "4"});
    CHECK(folder.entries() == 2);
}

TEST_CASE("generate --seed: the same seed makes the same bytes, another seed other bytes", "[cli]") {
    const ScratchFolder folder;
    for (const auto& [seed, name] : {std::pair{"3", "a"}, {"3", "b"}, {"4", "c"}})
        run_successfully({"generate", "random", "9", "--seed", seed, "-o", folder / name});
    CHECK(file_contents(folder / "a") == file_contents(folder / "b"));
    CHECK(file_contents(folder / "a") != file_contents(folder / "c"));
}

TEST_CASE("bench: prints a row per format and number of lanes, one image hash per format, and rates of operations",
          "[cli][slow]") {
    const std::string out = run_successfully({"bench", "--samples", "1", "--size", "64"}).out;
    INFO(out);
    CHECK_THAT(out, Catch::Contains("spheres.nff") && Catch::Contains("64 x 64 pixels, 256 PEs, 8 bounces"));
    const std::vector<Arguments> rows = lines_that_start_with(out, "trace");
    const Arguments lanes = {"1", "4", "8", "16"};
    REQUIRE(rows.size() == 2 * lanes.size());
    for (std::size_t i = 0; i < rows.size(); ++i) {
        REQUIRE(rows[i].size() == 12);
        CHECK(rows[i][1] == (i < lanes.size() ? "fp32" : "e6m15"));
        CHECK(rows[i][2] == lanes[i % lanes.size()]);
        CHECK(std::stod(rows[i][4]) > 0);                                 // Mrays/s of the best sample
        CHECK(rows[i][4] == rows[i][5]);                                  // with one sample, best and median are equal
        CHECK((rows[i].back() == rows[0].back()) == (i < lanes.size()));  // rows of one format have one image hash
    }
    CHECK(lines_that_start_with(out, "Gop/s").size() == 1);
    CHECK(lines_that_start_with(
              run_successfully({"bench", "--samples", "1", "--size", "32", "--lanes", "1", "--format", "e5m10t"}).out,
              "e5m10t")
              .size() == 1);
}

}  // namespace
}  // namespace raya
