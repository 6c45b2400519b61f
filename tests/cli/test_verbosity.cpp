// The options -q and -v change the messages, not the results.
#include <algorithm>
#include <sstream>

#include "tests/cli/refusals.hpp"
#include "tests/kernels/write_kernels.hpp"
#include "tests/verify/faults.hpp"

namespace raya {
namespace {

Arguments render_16x16(const ScratchFolder& folder, const Arguments& options) {
    Arguments arguments = {
        "render", scene_file("planes"), "-o", folder / "x.ppm", "--size", "16", "--pes", "4", "--lanes", "4"};
    arguments.insert(arguments.end(), options.begin(), options.end());
    return arguments;
}

RunOutcome run_without_error(const Arguments& arguments) {
    RunOutcome run = run_raya(arguments);
    INFO(run.describe());
    REQUIRE(run.code == 0);
    return run;
}

/// Returns the lines of the summary without the times, which differ between runs.
std::vector<std::string> without_times(const std::string& out) {
    std::vector<std::string> lines = lines_of(out);
    std::erase_if(lines, [](const std::string& line) { return line.starts_with("time "); });
    return lines;
}

/// Writes a scene with a polygon without area, which causes a warning. Returns its path.
std::string scene_with_warning(const ScratchFolder& folder) {
    std::string scene = file_contents(scene_file("planes"));
    std::ofstream(folder / "flat.nff") << scene << "p 3\n0 0 0\n1 1 1\n2 2 2\n";
    return folder / "flat.nff";
}

TEST_CASE("render -v: prints the steps of the host on stderr, and does not change stdout", "[cli][verbosity]") {
    const ScratchFolder folder;
    const RunOutcome default_run = run_without_error(render_16x16(folder, {}));
    CHECK(default_run.messages().empty());
    const std::string image = file_contents(folder / "x.ppm");
    const RunOutcome run = run_without_error(render_16x16(folder, {"-v"}));
    INFO(run.err);
    CHECK(without_times(run.out) == without_times(default_run.out));
    CHECK(file_contents(folder / "x.ppm") == image);
    for (const std::string& line : lines_of(run.err)) CHECK_THAT(line, Catch::StartsWith("raya: "));
    for (const char* text : {"planes.nff: ", " objects, ", " lights, ", "raya: device ", ", driver "})
        CHECK_THAT(run.err, Catch::Contains(text));
    for (const char* step : {"read scene", "choose device", "open device", "pack scene", "build ring/trace.cl",
                             "set up device", "trace", "gather", "render", "write images", "write report"})
        CHECK(has_line(run.err, "raya: " + std::string(step) + ": [0-9]+\\.[0-9]{3} s"));
    CHECK_THAT(run.err, !Catch::Contains("options -cl-std"));
}

TEST_CASE("render: announces the first compilation and its duration, also without a terminal", "[cli][verbosity]") {
    const ScratchFolder cache, folder;
    const std::vector<std::pair<std::string, std::string>> variables = {{"POCL_CACHE_DIR", cache.path()}};
    const Arguments arguments = {
        "render", scene_file("planes"), "-o", folder / "x.ppm", "--size", "16", "--lanes", "16", "--accel",
        "bvh"};  // takes seconds to compile
    const RunOutcome compiling_run = run_raya(arguments, {.variables = variables}),
                     cached_run = run_raya(arguments, {.variables = variables});
    INFO(compiling_run.describe() + cached_run.describe());
    CHECK(compiling_run.code == 0);
    CHECK(
        std::regex_match(compiling_run.err, std::regex("raya: compiling kernels for .* \\(first run only\\) \\.\\.\\.\n"
                                                       "raya: compiling kernels took [0-9]+\\.[0-9] s\n")));
    CHECK(cached_run.err.empty());
    for (const auto& entry : std::filesystem::directory_iterator(cache.path())) std::filesystem::remove_all(entry);
    Arguments quiet = arguments;
    quiet.emplace_back("-q");
    CHECK(run_raya(quiet, {.variables = variables}).err.empty());
}

TEST_CASE("render -vv: also prints builds and device times", "[cli][verbosity]") {
    const ScratchFolder folder;
    for (const Arguments& twice : {Arguments{"-vv"}, Arguments{"--verbose", "-v"}}) {
        const RunOutcome run = run_without_error(render_16x16(folder, twice));
        INFO(run.err);
        for (const std::string& line : lines_of(run.err)) CHECK_THAT(line, Catch::StartsWith("raya: "));
        CHECK_THAT(run.err, Catch::Contains("raya: build ring/trace.cl: options -cl-std=CL1.2 "));
        CHECK(has_line(run.err, "raya: on the device: trace \\(kernel\\) x 1: [0-9]+\\.[0-9]{3} ms"));
    }
}

TEST_CASE("render -q: prints warnings and errors; -qq: only errors", "[cli][verbosity]") {
    const ScratchFolder folder;
    const std::string scene = scene_with_warning(folder);
    Arguments arguments = render_16x16(folder, {});
    arguments[1] = scene;
    CHECK_THAT(run_without_error(arguments).err, Catch::Contains("raya: warning: "));
    arguments.emplace_back("-q");
    const RunOutcome quiet = run_without_error(arguments);
    CHECK(quiet.out.empty());
    CHECK_THAT(quiet.err, Catch::Contains("raya: warning: "));
    arguments.emplace_back("-q");
    const RunOutcome quieter = run_without_error(arguments);
    CHECK(quieter.out.empty());
    CHECK(quieter.err.empty());
    arguments.emplace_back("--strict");
    const RunOutcome refused = run_raya(arguments);
    CHECK(refused.code == 2);
    CHECK_THAT(refused.err, Catch::Contains("flat.nff"));
}

TEST_CASE("messages: escape control characters in file names", "[cli][verbosity]") {
    const ScratchFolder folder;
    const std::string unusual = "a\x1b[31m\a\xc2\x9b-\xc3\xa9",
                      escaped = "a\\x1b[31m\\x07\\x9b-\xc3\xa9";  // e acute is not escaped
    const std::string scene = folder / (unusual + ".nff"), report = folder / (unusual + ".json");
    std::filesystem::copy_file(scene_with_warning(folder), scene);
    const Arguments size = {"--size", "16", "--pes", "4", "--lanes", "4"};
    const auto with_size = [&](Arguments arguments) {
        arguments.insert(arguments.end(), size.begin(), size.end());
        return arguments;
    };
    std::vector<Arguments> runs = {
        {"info", scene, "-v"},
        with_size({"render", scene, "-v", "-o", folder / (unusual + ".ppm"), "--report", report}),
        {"page", report, "-o", folder / (unusual + ".html")},
        {"explore", scene, "--size", "16", "-o", folder / (unusual + ".html")},
        {"info", folder / (unusual + "missing.nff")},
        {"info", scene, "--machine", unusual},
        {"info", scene, unusual},
        {"render", scene, "-o", folder / ("missing" + unusual) / "x.ppm"},
        {unusual}};
    for (const Arguments& arguments : runs) {
        const RunOutcome run = run_raya(arguments);
        INFO(run.describe());
        CHECK((run.code == 0 || run.code == 2));
        CHECK_THAT(run.out + run.err, Catch::Contains(escaped));
        for (const char* control : {"\x1b", "\a", "\xc2\x9b"}) CHECK_FALSE(contains(run.out + run.err, control));
    }
}

TEST_CASE("messages: use the singular after the number 1", "[cli][verbosity]") {
    const ScratchFolder folder;
    const std::string scene = scene_file("planes");
    const Arguments small = {"--size", "4", "--bounces", "1", "--format", "fp32", "--lanes", "1"};
    const auto with_options = [&](Arguments arguments) {
        arguments.insert(arguments.end(), small.begin(), small.end());
        return arguments;
    };
    const std::vector<Arguments> runs = {
        with_options({"render", scene, "-o", folder / "x.ppm", "--pes", "1", "--antialias", "filter", "-v"}),
        with_options({"render", scene, "-o", folder / "x.ppm", "--pes", "1", "--accel", "bvh"}),
        with_options({"render", scene, "-o", folder / "x.ppm", "--pes", "1", "--accel", "grid:1x1x1"}),
        with_options({"bench", scene, "--pes", "1", "--samples", "1"}),
        {"verify", "--only", "machine bus", "--lanes", "1"}};
    for (const Arguments& arguments : runs) {
        const RunOutcome run = run_raya(arguments);
        INFO(run.describe());
        CHECK((run.code == 0 || run.code == 2));
        for (const std::string& line : lines_of(run.out + run.err))
            CHECK_FALSE(has_line(line, "(.*[^0-9.,x])?1 [A-Za-z]*[^s ]s\\b.*"));
    }
}

TEST_CASE("-q with -v: refused in either order", "[cli][verbosity]") {
    const ScratchFolder outputs;
    for (const Arguments& both : {Arguments{"-q", "-v"}, Arguments{"--verbose", "--quiet"}, Arguments{"-vq"}})
        check_refused(outputs, render_16x16(outputs, both), 2, {"--quiet and --verbose: give one of them"});
    check_refused(outputs, {"-v", "devices", "-q"}, 2, {"--quiet and --verbose"});
}

TEST_CASE("-q, -v: have the same effect before and after the command", "[cli][verbosity]") {
    for (const Arguments& arguments : {Arguments{"devices", "-v"}, Arguments{"-v", "devices"}}) {
        const RunOutcome run = run_without_error(arguments);
        CHECK_THAT(run.out, Catch::Contains(", driver "));
    }
    const ScratchFolder folder;
    Arguments arguments = render_16x16(folder, {});
    arguments.insert(arguments.begin(), "-q");
    const RunOutcome run = run_without_error(arguments);
    CHECK(run.out.empty());
    CHECK(run.err.empty());
}

TEST_CASE("verify -q: prints failures and the last line", "[cli][verify][verbosity]") {
    const Arguments machine = {"verify", "--only", "machine bus", "--lanes", "4", "-q"};
    const RunOutcome passing_run = run_without_error(machine);
    REQUIRE(lines_of(passing_run.out).size() == 1);
    CHECK_THAT(passing_run.out, Catch::Matches(".*: [0-9]+ checks passed, 0 failed, [0-9]+ skipped in [0-9.]+ s\n"));
    const ScratchFolder folder;
    const RunOutcome failing_run = run_raya(
        {"verify", "--only", "machine", "-q", "--kernel-dir", write_kernels(folder / "kernels", {kMappingFault})});
    INFO(failing_run.describe());
    CHECK(failing_run.code == 4);
    CHECK_THAT(failing_run.out, Catch::StartsWith("FAIL  machine ") && !Catch::Contains("PASS"));
    CHECK_THAT(lines_of(failing_run.out).back(), Catch::Contains(" 2 failed, "));
}

TEST_CASE("explore, study: print nothing with -q", "[cli][verbosity]") {
    const ScratchFolder folder;
    std::vector<Arguments> commands = {
        {"explore", scene_file("planes"), "--size", "16", "-o", folder / "x.html", "--quiet"}};
    if (RAYA_STUDIES) commands.push_back({"study", "fig7", "--size", "32", "-o", folder / "fig7", "-q"});
    for (const Arguments& arguments : commands) {
        const RunOutcome run = run_without_error(arguments);
        INFO(run.describe());
        CHECK(run.out.empty());
        CHECK(run.err.empty());
    }
}

}  // namespace
}  // namespace raya
