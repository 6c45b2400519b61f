// raya verify --as: the checks of one render, with faults that only some renders meet.
#include <sstream>

#include "tests/cli/refusals.hpp"
#include "tests/cli/render_files.hpp"
#include "tests/document.hpp"
#include "tests/kernels/write_kernels.hpp"
#include "tests/verify/faults.hpp"

namespace raya {
namespace {

// A light is lost with four lanes and a BVH.
const SourcePatch kLostLight{"shading/shade.clh", "const uint light_count = ((job_words)scene)->lights;",
                             "const uint light_count = ((job_words)scene)->lights - (RAYA_ACCEL == RAYA_ACCEL_BVH && "
                             "RAYA_LANES == 4);"};

// For --as: the folder of the sources may have blanks in its name.
std::string quoted_scene(const std::string& name) { return "'" + scene_file(name) + "'"; }

RunOutcome verify_as(const std::string& render, const Arguments& more = {}, const RunOptions& options = {}) {
    Arguments arguments = {"verify", "--as", render};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_raya(arguments, options);
}

TEST_CASE("verify --as: finds a fault only if the render meets it", "[cli][verify]") {
    const ScratchFolder scratch;
    const std::string kernels = " --kernel-dir " + write_kernels(scratch / "kernels", {kLostLight});
    const std::string render = "render " + quoted_scene("polygons") + " --lanes 4 --format fp32 -o x.png";
    const RunOutcome right = verify_as("raya " + render + kernels);
    INFO(right.describe());
    CHECK(right.code == 0);
    for (const char* line : {"PASS  number    fp32, 4 lanes", "PASS  geometry  known hits of cones, fp32, 4 lanes",
                             "PASS  image     polygons fp32, as given", "PASS  image     glass fp32 filter, as given",
                             "PASS  image     polygons.nff 32x32, as given and as simple as possible"})
        CHECK_THAT(right.out, Catch::Contains(line));
    CHECK_THAT(right.out, !Catch::Contains("spa22") && !Catch::Contains("machine "));
    const RunOutcome wrong = verify_as(render + " --accel bvh --size 40x20" + kernels, {"--only", "image polygons"});
    INFO(wrong.describe());
    CHECK(wrong.code == 4);
    CHECK_THAT(wrong.out,
               Catch::Contains("FAIL  image     polygons fp32, as given") &&
                   Catch::Contains("FAIL  image     polygons.nff 32x16, as given and as simple as possible") &&
                   Catch::Contains("-DRAYA_ACCEL=2"));
}

TEST_CASE("verify --as: checks ray packets if the render uses them", "[cli][verify]") {
    const ScratchFolder scratch;
    const std::string kernels = write_kernels(
        scratch / "kernels", {{"bvh/packet.clh", "return entered & all;", "return entered & all & ~1u;"}});
    const std::string render = "render " + quoted_scene("polygons") +
                               " --machine grande --accel bvh --lanes 16 -o x.png --kernel-dir " + kernels;
    const RunOutcome wrong = verify_as(render, {"--only", "image polygons"});
    INFO(wrong.describe());
    CHECK(wrong.code == 4);
    CHECK_THAT(wrong.out,
               Catch::Contains("FAIL  image     polygons fp32, as given") && Catch::Contains("-DRAYA_RAY_PACKETS=1"));
    // A report needs all counts.
    const RunOutcome counted = verify_as(render + " --report r.json", {"--only", "image polygons"});
    INFO(counted.describe());
    CHECK(counted.code == 0);
}

TEST_CASE("verify --as: without reference images in the format, compares with the simplest render", "[cli][verify]") {
    const ScratchFolder scratch;
    const std::string kernels = " --kernel-dir " + write_kernels(scratch / "kernels", {kLostLight});
    const std::string report = scratch / "v.json";
    const RunOutcome run = verify_as(
        "render " + quoted_scene("polygons") + " --lanes 4 --format e7m11 --accel bvh" + kernels, {"--report", report});
    INFO(run.describe());
    CHECK(run.code == 4);
    CHECK_THAT(run.out, Catch::Contains("SKIP  number    e7m11, 4 lanes") &&
                            Catch::Contains("there are no stored results in e7m11") &&
                            Catch::Contains("SKIP  geometry  known hits, e7m11, 4 lanes") &&
                            Catch::Contains("there is no reference image in e7m11") &&
                            Catch::Contains("FAIL  image     polygons.nff 32x32, as given and as simple as possible"));
    CHECK(json_of(report)["as"].get<std::string>().starts_with("render "));
}

TEST_CASE("verify --as: the torus, and an offset that reference images do not allow", "[cli][verify]") {
    const RunOutcome torus =
        verify_as("render " + quoted_scene("polygons") + " --machine torus --nodes 2x2x1 --lanes 4",
                  {"--only", "image polygons"});
    INFO(torus.describe());
    CHECK(torus.code == 0);
    CHECK_THAT(torus.out, Catch::Contains("PASS  image     polygons fp32, as given") &&
                              Catch::Contains("PASS  image     polygons.nff 32x32") && !Catch::Contains("filter"));
    const RunOutcome offset = verify_as("render " + quoted_scene("mirrors") + " --size 40 --offset 35 --lanes 4",
                                        {"--only", "image mirrors"});
    INFO(offset.describe());
    CHECK(offset.code == 0);
    CHECK_THAT(offset.out, Catch::Contains("SKIP  image     mirrors spa22, as given") &&
                               Catch::Contains("--offset 35: must be 0..19") &&
                               Catch::Contains("PASS  image     mirrors.nff 40x40, as given and"));
}

TEST_CASE("verify --as: builds the same program as the render", "[cli][verify]") {
    const ScratchFolder scratch;
    const std::string options = " --lanes 8 --group 2 --bounces 3 --format fp32 --accel grid";
    const auto trace_builds = [&](const Arguments& arguments) {
        const std::string log = scratch / "log";
        const RunOutcome run = run_raya(arguments, {.variables = {{"RAYA_KERNEL_LOG", log}}});
        INFO(run.describe());
        CHECK(run.code == 0);
        std::set<std::string> builds;
        std::istringstream lines(file_contents(log));
        for (std::string line; std::getline(lines, line);)
            if (contains(line, "\tbuild\tring/trace.cl")) builds.insert(line.substr(line.find('\t')));
        std::filesystem::remove(log);
        return builds;
    };
    Arguments render = {"render", scene_file("mirrors"), "-o", scratch / "x.pfm", "--size", "64", "-q"};
    const Arguments more = tokens_of(options);
    render.insert(render.end(), more.begin(), more.end());
    const auto of_render = trace_builds(render);
    REQUIRE(of_render.size() == 1);
    const auto of_verify = trace_builds({"verify", "--as", "render " + quoted_scene("mirrors") + " --size 64" + options,
                                         "--only", "image mirrors.nff"});
    CHECK(of_verify.size() == 2);  // the render's program and the simplest one
    CHECK(of_verify.contains(*of_render.begin()));
}

TEST_CASE("verify --as: a fault of the arithmetic; --list and --soak", "[cli][verify]") {
    const ScratchFolder scratch;
    const std::string kernels = write_kernels(scratch / "kernels", {kRoundingFault});
    const std::string render = "render " + quoted_scene("mirrors") + " --lanes 4";
    const RunOutcome run = verify_as(render, {"--only", "number", "--kernel-dir", kernels});
    INFO(run.describe());
    CHECK(run.code == 4);
    CHECK_THAT(run.out, Catch::Contains("FAIL  number    e6m15, 4 lanes"));
    const RunOutcome list = verify_as(render, {"--list"});
    INFO(list.describe());
    CHECK(list.code == 0);
    CHECK_THAT(list.out, Catch::StartsWith("number e6m15, 4 lanes\n") && Catch::Contains("\nimage mirrors.nff 32x32"));
    const RunOutcome soak = verify_as(render, {"--only", "number", "--soak", "1s"});
    INFO(soak.describe());
    CHECK(soak.code == 0);
}

TEST_CASE("verify --as: refuses what raya render refuses", "[cli][verify]") {
    const ScratchFolder outputs;
    const std::string scene = quoted_scene("mirrors");
    check_refused(outputs, {"verify", "--as", "devices"}, 2, {"--as \"devices\": must be a render, such as"});
    check_refused(outputs, {"verify", "--as", "render --help"}, 2, {"--as: must be a render without --help"});
    check_refused(outputs, {"verify", "--as", "render " + scene + " --lens 2"}, 2, {"--as: render: no option --lens"});
    check_refused(outputs, {"verify", "--as", "render " + scene + " --nodes 2x2x2"}, 2, {"--as: --nodes"});
    check_refused(outputs, {"verify", "--as", "render -"}, 2, {"--as: the scene must be a file"});
    for (const char* render : {"render 'no such.nff'", "  render \"no such.nff\" ", "render 'no such.nff"})
        check_refused(outputs, {"verify", "--as", render}, 2, {"raya: no such.nff: cannot read the scene"});
    check_refused(outputs, {"verify", "--as", "render " + scene + " --group 5000"}, 2, {"--group 5000"});
    check_refused(outputs, {"verify", "--as", "render " + scene, "--full"}, 2, {"--as with --brief, --quick, --full"});
    check_refused(outputs, {"verify", "--as", "render " + scene + " --device no-such-device"}, 3, {"no-such-device"});
}

}  // namespace
}  // namespace raya
