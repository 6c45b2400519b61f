// raya bench: the report, the comparison with an earlier report, and exit codes.
#include <fstream>

#include "host/version.hpp"
#include "tests/cli/refusals.hpp"
#include "tests/cli/render_files.hpp"
#include "tests/document.hpp"
#include "tests/paths.h"

namespace raya {
namespace {

/// Returns the arguments of a run of raya bench that measures one row in less than a second.
Arguments small_bench(const Arguments& extra_options) {
    Arguments arguments = {"bench", "--size",   "32",   "--pes",     "32", "--lanes",
                           "4",     "--format", "fp32", "--samples", "3"};
    arguments.insert(arguments.end(), extra_options.begin(), extra_options.end());
    return arguments;
}

/// Writes a copy of base.json in which the rate of the row is multiplied by `factor`, and the hash is replaced by
/// `hash` unless `hash` is empty. Returns the path of the copy.
std::string write_changed_baseline(const ScratchFolder& folder, const std::string& name, double factor,
                                   const std::string& hash = {}) {
    Document json = json_of(folder / "base.json");
    for (const char* part : {"best", "median"})
        json["rows"][0]["ms"][part] = json["rows"][0]["ms"][part].get<double>() / factor;
    if (!hash.empty()) json["rows"][0]["hash"] = hash;
    std::ofstream(folder / name) << json;
    return folder / name;
}

TEST_CASE("bench: refuses options that it would ignore", "[cli]") {
    const ScratchFolder outputs;
    check_refused(outputs, small_bench({"--tolerance", "5"}), 2, {"--tolerance requires --compare"});
    check_refused(outputs, {"bench", "--variants", "torus", "--mapping", "rows"}, 2,
                  {"--mapping with --variants torus"});
    check_refused(outputs, {"bench", "--variants", "torus,torus", "--pes", "4"}, 2, {"--pes with --variants torus"});
    check_refused(outputs, {"bench", "--variants", "none,grid", "--accel", "grid"}, 2,
                  {"--accel", "excludes", "--variants"});
    check_refused(outputs, {"bench", "--antialias", "filter"}, 2, {"bench: no option --antialias"});
    check_refused(outputs, {"bench", "--compare", "/dev/zero"}, 2, {"/dev/zero: cannot be read: not a regular file"});
}

TEST_CASE("bench --report, --compare: a later run is compared with the rows of the report", "[cli]") {
    const ScratchFolder folder;
    const std::string base = folder / "base.json";
    const RunOutcome baseline_run = run_raya(small_bench({"--report", base}));
    INFO(baseline_run.describe());
    REQUIRE(baseline_run.code == 0);
    const Document report = json_of(base);
    CHECK(report["kind"] == "raya bench");
    CHECK(report["raya"] == raya_version());
    for (const char* key : {"name", "platform", "version", "driver"}) CHECK(!report["device"][key].empty());
    REQUIRE(report["rows"].size() == 1);
    const Document& row = report["rows"][0];
    CHECK(row["kernel"] == "trace");
    CHECK(row["scene"] == "spheres.nff");
    CHECK(row["size"] == "32x32");
    CHECK(row["array"] == "32 PEs, cyclic:16, 8 bounces, accel none");
    CHECK(row["format"] == "fp32");
    CHECK(row["lanes"] == 4);
    CHECK(row["samples"] == 3);
    CHECK(row["ms"]["best"] <= row["ms"]["median"]);
    CHECK(row["mrays_per_s"]["best"].get<double>() ==
          Approx(row["rays"].get<double>() / row["ms"]["best"].get<double>() * 1e-3));
    CHECK_THAT(row["build_options"].get<std::string>(), Catch::Contains("-DRAYA_LANES=4"));
    // The baseline is a thousand times slower than this computer, so no run is reported as slower.
    const RunOutcome faster_run =
        run_raya(small_bench({"--compare", write_changed_baseline(folder, "slow.json", 1e-3)}));
    INFO(faster_run.describe());
    CHECK(faster_run.code == 0);
    CHECK(faster_run.messages().empty());
    CHECK_THAT(faster_run.out,
               Catch::Contains("faster") && Catch::Contains("1 row compared, none slower by more than 10 %"));
    // The baseline is a thousand times faster, so every run is reported as slower.
    const RunOutcome slower_run = run_raya(small_bench({"--compare", write_changed_baseline(folder, "fast.json", 1e3),
                                                        "--tolerance", "50", "--report", folder / "now.json"}));
    INFO(slower_run.describe());
    CHECK(slower_run.code == 4);
    // The rate falls by 99.9 %, or by 100.0 % (rounded) if other programs slowed the run down.
    CHECK_THAT(slower_run.out, Catch::Contains("SLOWER") && (Catch::Contains("-99.") || Catch::Contains("-100.0 %")));
    CHECK_THAT(slower_run.err,
               Catch::Contains("fast.json: 1 of 1 row slower by more than 50 %, 0 with a different image"));
    CHECK(json_of(folder / "now.json")["rows"][0]["hash"] == row["hash"]);  // a slower run also writes the report
    const RunOutcome other_image_run =
        run_raya(small_bench({"--compare", write_changed_baseline(folder, "other.json", 1e-3, "0123456789")}));
    INFO(other_image_run.describe());
    CHECK(other_image_run.code == 4);
    CHECK_THAT(other_image_run.out, Catch::Contains("OTHER IMAGE: ") && Catch::Contains(", was 01234567"));
    // Rows with other options have no baseline.
    const RunOutcome other_options_run = run_raya(small_bench({"--compare", base, "--bounces", "1"}));
    INFO(other_options_run.describe());
    CHECK(other_options_run.code == 2);
    CHECK_THAT(other_options_run.err, Catch::Contains("contains no row of this run") &&
                                          Catch::Contains("8 bounces, accel none") && Catch::Contains("1 bounces"));
}

TEST_CASE("bench: refuses invalid baselines, reports and tolerances", "[cli]") {
    const ScratchFolder folder, outputs;
    std::ofstream(folder / "no.json") << "no JSON";
    const std::string missing = folder / "missing.json";
    check_refused(outputs, small_bench({"--compare", missing, "--report", outputs / "r.json"}), 2,
                  {"No such file or directory; remedy: make a baseline with: raya bench --report " + missing});
    check_refused(outputs, small_bench({"--compare", folder / "no.json"}), 2,
                  {"no.json: not valid JSON: parse error at line 1, column 2"});
    check_refused(outputs, small_bench({"--compare", folder / "no.json", "--report", folder / "no.json"}), 2,
                  {"--report", "would overwrite the input --compare"});
    check_refused(outputs, small_bench({"--report", outputs / "none" / "r.json"}), 2, {"does not exist"});
    for (const char* tolerance : {"-1", "101", "nan"})
        check_refused(outputs, small_bench({"--compare", folder / "no.json", "--tolerance", tolerance}), 2,
                      {"--tolerance"});
}

TEST_CASE("bench --variants: times each variant, and all variants render the same image", "[cli][slow]") {
    const ScratchFolder folder;
    const std::string report = folder / "variants.json";
    const RunOutcome run = run_raya({"bench", RAYA_SOURCE_DIR "/scenes/mirrors.nff", "--variants", "grid,torus,none",
                                     "--machine", "grande", "--size", "40x30", "--format", "fp32", "--lanes", "4",
                                     "--samples", "1", "--report", report});
    INFO(run.describe());
    REQUIRE(run.code == 0);
    const Document rows = json_of(report)["rows"];
    REQUIRE(rows.size() == 3);
    const char* const kernels[] = {"render, grid", "torus", "render, none"};
    for (std::size_t i = 0; i < 3; ++i) {
        CAPTURE(i);
        CHECK(rows[i]["kernel"] == kernels[i]);
        CHECK(rows[i]["format"] == "fp32");
        CHECK(rows[i]["hash"] == rows[0]["hash"]);
        CHECK(rows[i]["rays"] == rows[0]["rays"]);
        CHECK(rows[i]["ms"]["best"] > 0);
    }
    CHECK_THAT(rows[1]["array"].get<std::string>(), Catch::StartsWith("4x4x4 nodes"));
    const ScratchFolder empty;
    check_refused(empty, {"bench", "--variants", "grid,octree"}, 2, {"--variants octree", "none, grid, bvh or torus"});
}

TEST_CASE("bench --build: lists compile times, and exits with 4 if one takes longer than --limit", "[cli]") {
    const ScratchFolder folder, outputs;
    const auto build = [&](const Arguments& extra_options) {
        Arguments arguments = {"bench",   RAYA_SOURCE_DIR "/scenes/planes.nff",
                               "--build", "--variants",
                               "none",    "--size",
                               "16",      "--pes",
                               "4",       "--lanes",
                               "4",       "--format",
                               "fp32"};
        arguments.insert(arguments.end(), extra_options.begin(), extra_options.end());
        return arguments;
    };
    const RunOutcome run = run_raya(build({"--report", folder / "b.json"}));
    INFO(run.describe());
    REQUIRE(run.code == 0);
    const Document report = json_of(folder / "b.json");
    CHECK(report["rows"].empty());
    const Document& builds = report["builds"];
    REQUIRE(builds.size() == 3);
    const char* const kernels[] = {"ring/trace.cl", "ring/filter.cl", "ring/contrast.cl"};
    for (std::size_t i = 0; i < 3; ++i) {
        CHECK(builds[i]["kernel"] == kernels[i]);
        CHECK(builds[i]["lanes"] == 4);
        for (const char* key : {"build_s", "first_launch_s"}) CHECK(builds[i][key] > 0);
        CHECK_FALSE(contains(builds[i]["build_options"].get<std::string>(), "RAYA_BUILT"));
        CHECK_THAT(run.out, Catch::Contains(kernels[i]));
    }
    const RunOutcome limited_run = run_raya(build({"--limit", "0.001"}));
    CHECK(limited_run.code == 4);
    CHECK_THAT(limited_run.err, Catch::StartsWith("raya: ring/trace.cl, none, fp32, 4 lanes: ") &&
                                    Catch::Contains("to compile, above --limit 0.001 s"));
    check_refused(outputs, build({"--limit", "0"}), 2, {"--limit 0: must be 0.001..1000000 seconds"});
    check_refused(outputs, {"bench", "--limit", "1"}, 2, {"--limit requires --build"});
    check_refused(outputs, build({"--compare", folder / "b.json"}), 2, {"--compare", "excludes", "--build"});
    check_refused(outputs, {"bench", "--compare", folder / "b.json"}, 2, {"the report has no measurements"});
}

}  // namespace
}  // namespace raya
