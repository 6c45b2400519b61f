// raya tune: it drops candidates that render a wrong image, fail, crash or hang; later renders use the stored values.

#include "tests/cli/device_with_fault.hpp"
#include "tests/cli/refusals.hpp"
#include "tests/document.hpp"
#include "tests/kernels/write_kernels.hpp"

namespace raya {
namespace {
namespace fs = std::filesystem;

/// Returns the options of a run on a device with 4 native lanes, with `cache` as cache folder.
RunOptions options_with_cache(const ScratchFolder& cache) {
    RunOptions run_options = device_with_fault("clGetDeviceInfo 4154 4");  // 4154: CL_DEVICE_NATIVE_VECTOR_WIDTH_FLOAT
    run_options.variables.emplace_back("XDG_CACHE_HOME", cache.path());
    run_options.variables.emplace_back("RAYA_TUNED", "");
    run_options.variables.emplace_back("RAYA_BUILD_OPTIONS", "-cl-opt-disable");  // to compile faster
    return run_options;
}

// Injected faults, one for a non-default value of each tuning parameter: 8 lanes do not compile, groups of 2 render a
// wrong image, scene words in global memory crash, sphere batches of 8 hang.
const SourcePatch kFaults = {"shading/tree.clh", "    t->sum = vec_choose(m, vec_mad(value, weight, t->sum), t->sum);",
                             R"(#if RAYA_LANES == 8
#error "no eight lanes"
#elif RAYA_GROUP == 2
    value = vec_add(value, value);
#elif !RAYA_WORDS_LOCAL
    *(volatile __global int*)0 = 1;
#elif RAYA_SPHERE_BATCH == 8
    for (volatile int turns = 1; turns != 0;) continue;
#endif
    t->sum = vec_choose(m, vec_mad(value, weight, t->sum), t->sum);)"};

TEST_CASE("tune: drops candidates that fail, crash, hang or change the image; later renders use the stored values",
          "[cli][slow]") {
    const ScratchFolder kernels, cache, outputs;
    const std::string patched_kernels = write_kernels(kernels / "kernels", {kFaults});
    const RunOptions run_options = options_with_cache(cache);
    const RunOutcome run = run_raya({"tune", "--variants", "none", "--format", "fp32", "--size", "16", "--pes", "1",
                                     "--kernel-dir", patched_kernels},
                                    run_options);
    INFO(run.describe());
    REQUIRE(run.code == 0);
    CHECK_FALSE(contains(run.err, "raya: "));  // stderr has only the compilers' messages
    for (const char* line : {"dropped: ring none fp32: lanes 8, group 1, local words yes, batch default: compile: ",
                             "dropped: ring none fp32: lanes 4, group 2, local words yes, batch default: correctness: ",
                             "lanes 4, group 1, local words no, batch default: runtime: ended by signal 11 (SIGSEGV)",
                             "lanes 4, group 1, local words yes, batch 8: timeout: not done in 20 s", "stored in "})
        CHECK_THAT(run.out, Catch::Contains(line));
    CHECK_FALSE(contains(run.out, "dropped: ring none fp32: lanes 1, group 1, local words yes, batch default"));

    REQUIRE(std::distance(fs::directory_iterator(cache / "raya"), {}) == 1);
    const std::string file = fs::directory_iterator(cache / "raya")->path();
    const Document stored = Document::parse(file_contents(file))["tuned"];
    REQUIRE(stored.size() == 1);
    CHECK((stored[0]["machine"] == "ring" && stored[0]["accel"] == "none" && stored[0]["format"] == "fp32"));
    const auto lanes = stored[0]["values"]["lanes"].get<int>();
    CHECK(lanes != 8);
    CHECK((stored[0]["values"]["group"] != 2 && stored[0]["values"]["local_words"] == 1 &&
           stored[0]["values"]["batch"] != 8));

    const auto report_of_render = [&](const Arguments& extra_options) {
        Arguments arguments = {
            "render", scene_file("spheres"), "-o",     outputs / "x.pfm", "--size", "16",       "--pes",
            "4",      "--machine",           "grande", "--accel",         "none",   "--report", outputs / "r.json"};
        arguments.insert(arguments.end(), extra_options.begin(), extra_options.end());
        const RunOutcome render = run_raya(arguments, run_options);
        INFO(render.describe());
        REQUIRE(render.code == 0);
        CHECK(contains(render.out, "\ntuned   " + file) == extra_options.empty());
        return Document::parse(file_contents(outputs / "r.json"));
    };
    const Document tuned_report = report_of_render({}), default_report = report_of_render({"--no-tuned"}),
                   option_report = report_of_render({"--lanes", "4"});
    CHECK_THAT(tuned_report["device"]["tuned"].get<std::string>(), Catch::StartsWith(file + ", 20"));
    CHECK(tuned_report["device"]["lanes"] == lanes);
    CHECK(default_report["device"]["tuned"] == "defaults");
    CHECK(option_report["device"]["tuned"] == "options");
    CHECK(tuned_report["image"]["hash"] == default_report["image"]["hash"]);
    CHECK(tuned_report["warnings"].empty());

    std::ofstream(file) << "{";
    const Document damaged_report = report_of_render({"--no-tuned"});
    CHECK(damaged_report["warnings"].empty());
    const RunOutcome warned_run =
        run_raya({"render", scene_file("spheres"), "-o", outputs / "x.pfm", "--size", "16", "--pes", "4", "--machine",
                  "grande", "--accel", "none", "--report", outputs / "r.json"},
                 run_options);
    CHECK(warned_run.code == 0);
    CHECK_THAT(warned_run.err, Catch::Contains("raya: warning: " + file + ": not valid JSON: parse error at line 1"));
    CHECK(Document::parse(file_contents(outputs / "r.json"))["warnings"].size() == 1);
}

TEST_CASE("tune: refuses a device whose defaults fail", "[cli]") {
    const ScratchFolder kernels, cache, outputs;
    const std::string patched_kernels =
        write_kernels(kernels / "kernels", {{"shading/tree.clh", "#ifndef RAYA_TREE_CLH\n", "#error \"none\"\n"}});
    const RunOutcome run =
        run_raya({"tune", "--variants", "none", "--size", "8", "--pes", "4", "--kernel-dir", patched_kernels},
                 options_with_cache(cache));
    INFO(run.describe());
    CHECK(run.code == 3);
    CHECK_THAT(run.err, Catch::Contains("ring none fp32: the render with the default parameters failed") &&
                            Catch::Contains("raya verify"));
    CHECK(std::distance(fs::directory_iterator(cache / "raya"), {}) == 0);
}

}  // namespace
}  // namespace raya
