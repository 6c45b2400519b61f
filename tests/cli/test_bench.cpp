// raya bench: the report, the comparison with an earlier report, and exit codes. Compile times and variants:
// tools.reports.
#include <fstream>

#include "tests/cli/device_with_fault.hpp"
#include "tests/cli/refusals.hpp"
#include "tests/cli/render_files.hpp"
#include "tests/document.hpp"

namespace raya {
namespace {

/// Runs raya bench with one row that takes less than a second.
RunOutcome bench(const Arguments& more, int code = 0) {
    Arguments arguments = {"bench", scene_file("mirrors"), "--size", "32", "--lanes", "4", "--format",
                           "fp32",  "--bounces",           "4"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    RunOutcome run = run_raya(arguments);
    INFO(run.describe());
    CHECK(run.code == code);
    return run;
}

TEST_CASE("bench --compare: a later run is compared with the rows of a report", "[cli]") {
    const ScratchFolder folder;
    const std::string base = folder / "base.json";
    const Arguments small = {"--pes", "32", "--samples", "3"};
    const auto bench_with = [&](Arguments more, int code) {
        more.insert(more.end(), small.begin(), small.end());
        return bench(more, code);
    };
    bench_with({"--report", base, "--json-benchmark", folder / "list.json"}, 0);
    const Document report = json_of(base), list = json_of(folder / "list.json");
    REQUIRE(report["rows"].size() == 1);
    const Document& row = report["rows"][0];
    CHECK((row["kernel"] == "trace" && row["array"] == "32 PEs, cyclic:16, 4 bounces, accel none" &&
           row["samples"] == 3));
    CHECK(row["ms"]["best"] <= row["ms"]["median"]);
    CHECK((list.size() == 1 && list[0]["name"] == "trace fp32, 4 lanes, group 1" && list[0]["unit"] == "ms" &&
           list[0]["value"] == row["ms"]["median"]));
    CHECK(row["mrays_per_s"]["best"].get<double>() ==
          Approx(row["rays"].get<double>() / row["ms"]["best"].get<double>() * 1e-3));
    // Returns a copy of base.json in which the rate of the row is multiplied by `factor`.
    const auto changed = [&](double factor, const std::string& hash) {
        Document json = report;
        for (const char* part : {"best", "median"})
            json["rows"][0]["ms"][part] = json["rows"][0]["ms"][part].get<double>() / factor;
        json["rows"][0]["hash"] = hash;
        std::ofstream(folder / "changed.json") << json;
        return folder / "changed.json";
    };
    const std::string hash = row["hash"];
    CHECK_THAT(bench_with({"--compare", changed(1e-3, hash)}, 0).out,
               Catch::Contains("faster") && Catch::Contains("1 row compared, none slower by more than 10 %"));
    const RunOutcome slower =
        bench_with({"--compare", changed(1e3, hash), "--tolerance", "50", "--report", folder / "now.json"}, 4);
    CHECK_THAT(slower.out, Catch::Contains("SLOWER"));
    CHECK_THAT(slower.err,
               Catch::Contains("changed.json: 1 of 1 row slower by more than 50 %, 0 with a different image"));
    CHECK(json_of(folder / "now.json")["rows"][0]["hash"] == hash);  // a slower run also writes the report
    CHECK_THAT(bench_with({"--compare", changed(1e-3, "0123456789")}, 4).out,
               Catch::Contains("OTHER IMAGE: ") && Catch::Contains(", was 01234567"));
    CHECK_THAT(bench_with({"--compare", base, "--offset", "3"}, 2).err,
               Catch::Contains("contains no row of this run") && Catch::Contains("cyclic:3"));
}

TEST_CASE("bench --build: does not ask for the size of binaries, for which PoCL compiles again or aborts", "[cli]") {
    if (kSanitized) return;
    const RunOutcome run = run_raya({"bench", scene_file("mirrors"), "--build", "--variants", "none", "--size", "16",
                                     "--lanes", "4", "--format", "fp32", "--bounces", "4", "--samples", "1"},
                                    device_with_fault("clGetProgramInfo 4453 crash"));
    INFO(run.describe());
    CHECK(run.code == 0);
}

}  // namespace
}  // namespace raya
