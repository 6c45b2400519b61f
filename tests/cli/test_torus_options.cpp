// Options of the torus machine: refused values, and help.
#include "host/scene/nff.hpp"
#include "kernels/shared/traffic.h"
#include "tests/cli/refusals.hpp"
#include "tests/thorough.hpp"

namespace raya {
namespace {

struct TorusRow {
    Arguments options;
    Arguments message;
};

/// Checks that raya refuses a render on `machine` with the options of each row, with the message of the row.
void check_refused_on(const std::string& machine, const std::vector<TorusRow>& rows) {
    const ScratchFolder outputs;
    for (const TorusRow& row : quick_of(3, rows)) {
        Arguments arguments = {"render", scene_file("planes"), "-o", outputs / "x.pfm", "--machine", machine};
        arguments.insert(arguments.end(), row.options.begin(), row.options.end());
        check_refused(outputs, arguments, 2, row.message);
    }
}

TEST_CASE("render --machine torus: the error for options of rings names reason and remedy", "[cli]") {
    const std::string suffix = " with --machine torus";
    check_refused_on(
        "torus", {{{"--mapping", "rows"}, {"--mapping rows" + suffix, "voxels of the scene, not pixels", "--voxels"}},
                  {{"--offset", "16"}, {"--offset 16" + suffix, "not pixels", "leave it out"}},
                  {{"--fold", "block"}, {"--fold block" + suffix, "not pixels", "leave it out"}},
                  {{"--pes", "64"}, {"--pes 64" + suffix, "nodes", "--nodes IxJxK"}},
                  {{"--antialias", "filter"}, {"--antialias filter" + suffix, "neighbours", "choose a ring"}},
                  {{"--exchange", "bus"}, {"--exchange bus" + suffix, "neighbours", "choose a ring"}},
                  {{"--threshold", "0.5"}, {"--threshold 0.5" + suffix, "neighbours", "choose a ring"}},
                  {{"--points", "axes"}, {"--points axes" + suffix, "neighbours", "choose a ring"}},
                  {{"--mask", "m.png"}, {"--mask m.png" + suffix, "neighbours", "choose a ring"}},
                  {{"--cost", "c.exr"}, {"--cost c.exr" + suffix, "nodes work for a pixel", "choose a ring"}}});
}

TEST_CASE("render --machine spa: the error for options of the torus names the remedy", "[cli]") {
    const std::string suffix = " with --machine spa", remedy = "choose --machine torus";
    check_refused_on("spa", {{{"--nodes", "4x4x4"}, {"--nodes 4x4x4" + suffix, "ring", "--pes"}},
                             {{"--voxels", "4x4x4"}, {"--voxels 4x4x4" + suffix, remedy}},
                             {{"--links", "torus2d"}, {"--links torus2d" + suffix, remedy}},
                             {{"--inject", "root"}, {"--inject root" + suffix, remedy}},
                             {{"--returns", "rays"}, {"--returns rays" + suffix, remedy}},
                             {{"--packet-words", "22"}, {"--packet-words 22" + suffix, remedy}},
                             {{"--queue", "64"}, {"--queue 64" + suffix, remedy}},
                             {{"--packets", "p.csv.gz"}, {"--packets p.csv.gz" + suffix, remedy}}});
    check_refused_on("grande", {{{"--inject", "all"}, {"--inject all with --machine grande", remedy}}});
}

TEST_CASE("render --machine torus: refuses invalid values before rendering", "[cli]") {
    check_refused_on("torus", {{{"--nodes", "4x4"}, {"--nodes 4x4: must be XxYxZ", "65,536"}},
                               {{"--nodes", "0x4x4"}, {"--nodes 0x4x4"}},
                               {{"--nodes", "64x64x17"}, {"--nodes 64x64x17", "65536"}},
                               {{"--nodes", "1000000x1000000x1000000"}, {"--nodes 1000000x1000000x1000000"}},
                               {{"--voxels", "8"}, {"--voxels 8: must be XxYxZ", "2^24"}},
                               {{"--voxels", "257x256x256"}, {"--voxels 257x256x256", "2^24"}},
                               {{"--voxels", "1000000x1000000x1000000"}, {"--voxels 1000000x", "2^24"}},
                               {{"--links", "mesh"}, {"--links mesh", "torus3d", "torus2d"}},
                               {{"--inject", "some"}, {"--inject some", "root or all"}},
                               {{"--returns", "some"}, {"--returns some", "terms or rays"}},
                               {{"--packet-words", "15"}, {"--packet-words 15", "16..4096"}},
                               {{"--packet-words", "4097"}, {"--packet-words 4097", "16..4096"}},
                               {{"--queue", "0"}, {"--queue 0", "1 packet"}},
                               {{"--queue", "-1"}, {"--queue -1: out of range"}},
                               {{"--queue", "x"}, {"--queue x: not a whole number"}},
                               {{"--pe-memory", "0"}, {"--pe-memory 0", "1 byte"}},
                               {{"--pe-memory", "4MB"}, {"--pe-memory 4MB: not a whole number"}},
                               {{"--size", "16385x1"}, {"--size 16385x1", "1..16384 pixels"}},
                               {{"--sampling", "random"}, {"--sampling random", "centres or corners"}},
                               {{"--format", "e4m15"}, {"--format e4m15", "fp32"}},
                               {{"--lanes", "0"}, {"--lanes 0", "1, 4, 8 or 16"}}});
    for (const char* option : {"--nodes", "--voxels", "--links", "--inject", "--queue", "--pe-memory", "--packets"})
        check_refused_on("torus", {{{option, ""}, {option, "must not be empty"}}});
}

TEST_CASE("render --packets: refuses a file that it cannot write, before rendering", "[cli]") {
    const ScratchFolder outputs;
    const std::string missing = outputs / "missing/p.csv.gz", image = outputs / "x.pfm";
    check_refused_on("torus", {{{"--packets", outputs / "p.csv"}, {"p.csv", "gzip", ".csv.gz"}},
                               {{"--packets", missing}, {"/missing' does not exist", "mkdir -p"}},
                               {{"--packets", outputs / "p.csv.gz", "--report", outputs / "p.csv.gz"},
                                {"p.csv.gz", "the same file as --packets"}}});
    check_refused(
        outputs,
        {"render", scene_file("planes"), "-o", outputs / "x.pfm", "--machine", "torus", "--packets", outputs.path()}, 2,
        {outputs.path(), "it is a folder"});
}

TEST_CASE("render --queue: a deadlock is repeated with longer queues, with a warning", "[cli]") {
    const std::string file = scene_file("mirrors");
    const auto lights = static_cast<std::uint32_t>(read_nff(file).lights.size());
    const std::string queue = std::to_string(raya_min_queue(lights, 4));
    const Arguments machine = {"--machine", "torus", "--links", "torus2d", "--size",  "24", "--format", "spa22",
                               "--bounces", "4",     "--lanes", "4",       "--group", "1",  "--queue",  queue};
    const ScratchFolder outputs;
    Arguments arguments = {"render", file, "-o", outputs / "x.pfm"};
    arguments.insert(arguments.end(), machine.begin(), machine.end());
    const RunOutcome run = run_raya(arguments);
    INFO(run.describe());
    CHECK(run.code == 0);
    for (const std::string& part :
         Arguments{": deadlock in superstep", "are full at " + queue, "repeated with queues of"})
        CHECK_THAT(run.err, Catch::Contains(part));
}

TEST_CASE("bench: refuses --machine torus and --nodes", "[cli]") {
    const ScratchFolder outputs;
    check_refused(outputs, {"bench", "--samples", "1", "--machine", "torus"}, 2,
                  {"--machine torus", "voxels of the scene, not pixels", "only raya render", "spa"});
    check_refused(outputs, {"bench", "--nodes", "4x4x4"}, 2, {"--nodes", "--help"});
}

TEST_CASE("render --help: has the options of the torus with units and defaults", "[cli]") {
    const RunOutcome run = run_raya({"render", "--help-all"});
    REQUIRE(run.code == 0);
    const std::string help = squeezed(run.out);
    for (const char* text :
         {"Torus machine", "torus: nodes of 4 MB",
          "--nodes IxJxK Number of nodes along x, y and z of the scene, at most 65,536 in total; default: 4x4x4",
          "--voxels AxBxC", "fewer voxels leave nodes empty", "one for each node", "torus3d|torus2d",
          "default: torus3d", "root|all", "default: all", "--queue N", "Maximum number of packets queued",
          "--pe-memory BYTES", "4194304", "--packets FILE.csv.gz", "docs/packets.md", "--async"})
        CHECK_THAT(help, Catch::Contains(text));
    CHECK_THAT(run_raya({"bench", "--help-all"}).out, !Catch::Contains("--nodes"));
}

}  // namespace
}  // namespace raya
