// raya verify: output, reports, exit codes and refused options.
#include <catch2/catch.hpp>
#include <filesystem>

#include "tests/cli/device_with_fault.hpp"
#include "tests/cli/refusals.hpp"
#include "tests/document.hpp"
#include "tests/kernels/write_kernels.hpp"
#include "tests/verify/faults.hpp"

namespace raya {

TEST_CASE("verify: prints a line per check and ends with the counts", "[cli][verify]") {
    const RunOutcome run = run_raya({"verify", "--only", "machine"});
    INFO(run.describe());
    CHECK(run.code == 0);
    CHECK_THAT(run.out, Catch::Contains("PASS  machine   ring: rotations of 7 PEs"));
    CHECK(has_line(run.out, ".*: [0-9]+ checks passed, 0 failed, [0-9]+ skipped in [0-9.]+ s"));
}

TEST_CASE("verify: exits with 4 if a check fails, and shows the difference and remedies", "[cli][verify]") {
    const ScratchFolder scratch;
    const std::string file = scratch / "report.json", kernels = write_kernels(scratch / "kernels", {kMappingFault});
    const RunOutcome run = run_raya({"verify", "--only", "machine", "--kernel-dir", kernels, "--report", file});
    INFO(run.describe());
    CHECK(run.code == 4);
    CHECK_THAT(run.out, Catch::Contains("FAIL  machine   mapping: blocks") && Catch::Contains("expected") &&
                            Catch::Contains("try"));
    CHECK_THAT(run.out, Catch::Contains("2 failed"));
    const auto report = Document::parse(file_contents(file));
    CHECK(report["depth"] == "quick");
    const auto& device = report["devices"][0];
    CHECK(device["right"] == false);
    CHECK(device["failed"] == 2);
    CHECK(device["passed"].get<int>() + 2 + device["skipped"].get<int>() == int(device["checks"].size()));
    int failures = 0;
    for (const auto& check : device["checks"]) {
        for (const char* key : {"layer", "name", "status", "seconds", "result"}) CHECK(check.contains(key));
        if (check["status"] != "FAIL") continue;
        ++failures;
        for (const char* key : {"where", "expected", "got"}) CHECK(check[key] != "");
    }
    CHECK(failures == 2);
}

TEST_CASE("verify --kernel-dir: refuses a folder without all kernels, before any check", "[cli][verify]") {
    const ScratchFolder scratch, empty, outputs;
    const std::string partial = write_kernels(scratch / "kernels");
    REQUIRE(std::filesystem::remove(std::filesystem::path(partial) / "shading/light.clh"));
    for (const std::string& folder : {empty.path().string(), (empty / "missing").string(), partial})
        check_refused(outputs, {"verify", "--only", "bus", "--kernel-dir", folder, "--report", outputs / "report.json"},
                      2, {folder, "cannot read kernel file", "--kernel-dir must be a folder like"});
}

TEST_CASE("verify --kernel-dir: a wrong count causes exit code 4, and the remedy names the kernels only",
          "[cli][verify]") {
    const ScratchFolder scratch;
    const std::string file = scratch / "report.json";
    const std::string kernels = write_kernels(scratch / "kernels", {kCountFaults.front().patch});
    const RunOutcome run = run_raya({"verify", "--only", kOnGlass, "--kernel-dir", kernels, "--report", file});
    INFO(run.describe());
    CHECK(run.code == 4);
    CHECK_THAT(run.out, Catch::Contains("wrong counts: reflected, refracted, cycles, pixel_cycles") &&
                            Catch::Contains("expected      reflected 497, refracted 422, cycles ") &&
                            Catch::Contains("got           reflected 919, refracted 0, cycles "));
    const Document check = Document::parse(file_contents(file))["devices"][0]["checks"][0];
    REQUIRE(check["remedies"].size() == 1);
    CHECK_THAT(check["remedies"][0].get<std::string>(),
               Catch::StartsWith("run raya verify without --kernel-dir") && !Catch::Contains("driver"));
}

TEST_CASE("verify --brief: traces few rays, in reduced formats only without the grid", "[cli][verify]") {
    const ScratchFolder scratch;
    const std::string file = scratch / "report.json";
    const RunOutcome run = run_raya({"verify", "--brief", "--only", "geometry", "--report", file});
    INFO(run.describe());
    CHECK(run.code == 0);
    CHECK_THAT(run.out, Catch::Contains("grid, fp32") && Catch::Contains("  384 rays, ") &&
                            Catch::Contains("  18 rays, with and without grid") && !Catch::Contains("grid, e6m15") &&
                            Catch::Contains("  18 rays, without grid"));
    CHECK(Document::parse(file_contents(file))["depth"] == "brief");
}

TEST_CASE("verify --only: refuses a name that no check has, and lists the checks", "[cli][verify]") {
    const ScratchFolder scratch;
    check_refused(scratch, {"verify", "--only", "no such check", "--report", scratch / "report.json"}, 2,
                  {"--only \"no such check\": no check of",
                   "the layers are number, geometry, machine and image; checks are, for example:"
                   "\n  number fp32, ",
                   "\n  image glass fp32: ", "--full has more"});
}

TEST_CASE("verify: skips checks that the device does not support; if all are skipped, the exit code is 4",
          "[cli][verify]") {
    const RunOptions small_groups = device_with_fault("clGetDeviceInfo 4100 8");
    const RunOutcome partial_run = run_raya({"verify", "--only", "machine local memory"}, small_groups);
    INFO(partial_run.describe());
    CHECK(partial_run.code == 0);
    CHECK_THAT(partial_run.out, Catch::Contains("SKIP  machine   local memory and barriers, 32 work-items") &&
                                    Catch::Contains("needs groups of 32 work-items, the device allows 8") &&
                                    Catch::Contains(": 1 check passed, 0 failed, 1 skipped"));
    const RunOutcome skipped_run = run_raya({"verify", "--only", "32 work-items"}, small_groups);
    INFO(skipped_run.describe());
    CHECK(skipped_run.code == 4);
    CHECK_THAT(skipped_run.out, Catch::Contains(": 0 checks passed, 0 failed, 1 skipped"));
}

TEST_CASE("verify --device all: checks every usable device", "[cli][verify]") {
    const RunOutcome run = run_raya({"verify", "--device", "all", "--only", "rotations"});
    INFO(run.describe());
    CHECK(run.code == 0);
    CHECK_THAT(run.out, Catch::Contains("3 checks passed"));
}

TEST_CASE("verify --lanes: the names of checks contain the number of lanes", "[cli][verify]") {
    const RunOutcome run = run_raya({"verify", "--lanes", "4", "--only", "number fp32"});
    INFO(run.describe());
    CHECK(run.code == 0);
    CHECK_THAT(run.out, Catch::Contains("PASS  number    fp32, 4 lanes") && Catch::Contains("1 check passed"));
}

TEST_CASE("verify: refuses wrong options", "[cli][verify]") {
    CHECK(run_raya({"verify", "--quick", "--full"}).code == 2);
    CHECK(run_raya({"verify", "--brief", "--quick"}).code == 2);
    CHECK(run_raya({"verify", "--report", "/no/such/folder/report.json"}).code == 2);
    CHECK(run_raya({"verify", "--lanes", "3"}).code == 2);
    CHECK(run_raya({"verify", "--device", "no such device"}).code == 3);
}

}  // namespace raya
