// raya verify: output, reports, exit codes and refused options.
#include <catch2/catch.hpp>
#include <filesystem>

#include "host/cli/verify.hpp"
#include "tests/cli/device_with_fault.hpp"
#include "tests/cli/refusals.hpp"
#include "tests/document.hpp"
#include "tests/kernels/write_kernels.hpp"
#include "tests/paths.h"
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

TEST_CASE("verify --expect: listed failures do not count, and listed checks that pass do", "[cli][verify]") {
    const ScratchFolder scratch;
    const std::string kernels = write_kernels(scratch / "kernels", {kMappingFault}), list = scratch / "expect.txt",
                      junit = scratch / "v.xml", report = scratch / "v.json";
    const Arguments verify = {"verify",  "--only", "machine mapping", "--kernel-dir", kernels, "--expect", list,
                              "--junit", junit,    "--report",        report};
    write_whole_file(list, "# mappings\nmapping: | wrong mapping | https://example.org/1\n");
    const RunOutcome unexpected = run_raya(verify);
    INFO(unexpected.describe());
    CHECK(unexpected.code == 4);
    CHECK_THAT(unexpected.err, !Catch::Contains("matches no check"));
    CHECK_THAT(unexpected.out, Catch::Contains("XPASS machine") && Catch::Contains("XFAIL machine   mapping: blocks") &&
                                   Catch::Contains("0 failed, 0 skipped, 2 failed as expected"));
    CHECK_THAT(file_contents(junit),
               Catch::Contains("<failure message=\"passed, but --expect lists it as failing (wrong "
                               "mapping, https://example.org/1)"));
    write_whole_file(list, "mapping: blocks | wrong mapping\nmapping: cyclic*block | also wrong\n");
    const RunOutcome expected = run_raya(verify);
    INFO(expected.describe());
    CHECK(expected.code == 0);
    const Document device = Document::parse(file_contents(report))["devices"][0];
    CHECK(device["failed_as_expected"] == 2);
    CHECK(device["right"] == true);
    CHECK_THAT(file_contents(junit), Catch::Contains("failures=\"0\"") && Catch::Contains("skipped=\"2\"") &&
                                         Catch::Contains("(expected: wrong mapping)"));
    // A pattern of a check that is not selected, and two without any check.
    write_whole_file(list,
                     "mapping: blocks | a\nmapping: cyclic*block | b\nimage glass | c\nno such | d\n\nimge | e\n");
    const RunOutcome unmatched = run_raya(verify);
    INFO(unmatched.describe());
    CHECK(unmatched.code == 0);
    CHECK_THAT(unmatched.err, Catch::Contains(list + ":4: \"no such\" matches no check") &&
                                  Catch::Contains(list + ":6: \"imge\" matches no check") &&
                                  !Catch::Contains("image glass"));
    write_whole_file(list, "mapping: blocks\n");
    const ScratchFolder outputs;
    check_refused(outputs, verify, 2, {list + ":1: expected PATTERN | REASON or PATTERN | REASON | LINK"});
}

TEST_CASE("verify --shard, --skip, --list: every check is in exactly one shard", "[cli][verify]") {
    const auto listed = [](const Arguments& more) {
        Arguments arguments = {"verify", "--brief", "--list"};
        arguments.insert(arguments.end(), more.begin(), more.end());
        const RunOutcome run = run_raya(arguments);
        INFO(run.describe());
        REQUIRE(run.code == 0);
        std::istringstream lines(run.out);
        std::multiset<std::string> names;
        for (std::string line; std::getline(lines, line);) names.insert(line);
        return names;
    };
    const auto all = listed({});
    std::multiset<std::string> shards;
    for (const char* shard : {"1/3", "2/3", "3/3"}) shards.merge(listed({"--shard", shard}));
    CHECK(shards == all);
    const auto numbers = listed({"--only", "number"}), others = listed({"--skip", "number"});
    CHECK(numbers.size() + others.size() == all.size());
    CHECK(listed({"--only", "n*fp32"}).size() < all.size());
    const ScratchFolder scratch;
    for (const char* shard : {"0/2", "3/2", "1", "1/2x", "/2"})
        check_refused(scratch, {"verify", "--shard", shard}, 2, {"--shard", "must be I/N with I 1..N"});
    check_refused(scratch, {"verify", "--only", "number fp32", "--shard", "5/9"}, 2, {"select no check of"});
}

TEST_CASE("verify --list: names are those of tests/verify/check_names.txt", "[cli][verify]") {
    // Lists of expected failures and CI dashboards contain the names. If you change one, write the file again and say
    // so in CHANGELOG.md: build/raya verify --quick --lanes 4 --list > tests/verify/check_names.txt
    const RunOutcome run = run_raya({"verify", "--quick", "--lanes", "4", "--list"});
    INFO(run.describe());
    CHECK(run.out == file_contents(RAYA_SOURCE_DIR "/tests/verify/check_names.txt"));
    const ScratchFolder scratch;
    const std::string report = scratch / "v.json";
    REQUIRE(run_raya({"verify", "--quick", "--lanes", "4", "--only", "machine", "--report", report}).code == 0);
    const Document checks = Document::parse(file_contents(report))["devices"][0]["checks"];
    REQUIRE(checks.size() == 21);
    for (const Document& check : checks)
        CHECK_THAT(run.out, Catch::Contains("machine " + check["name"].get<std::string>() + "\n"));
}

TEST_CASE("verify --timeout: ends a check that hangs, and continues with the next", "[cli][verify]") {
    const RunOutcome run = run_raya({"verify", "--brief", "--only", "machine mapping: rows", "--timeout", "1"},
                                    device_with_fault("clFinish 1 slow"));
    INFO(run.describe());
    CHECK(run.code == 4);
    CHECK_THAT(run.out, Catch::Contains("no result after") && Catch::Contains("--timeout SECONDS"));
}

TEST_CASE("verify: no check builds more than six programs, for which the default of --timeout allows",
          "[cli][verify]") {
    const ScratchFolder scratch;
    const std::string log = scratch / "log";
    const RunOutcome run = run_raya({"verify", "--only", "torus3d 2x2x2, launches of 1 unit", "--lanes", "4"},
                                    {.variables = {{"RAYA_KERNEL_LOG", log}}});
    INFO(run.describe());
    CHECK(run.code == 0);
    std::size_t builds = 0;
    std::istringstream lines(file_contents(log));
    for (std::string line; std::getline(lines, line);) builds += contains(line, "\tbuild\t");
    CHECK(builds == 6);  // the most of all checks: inject, trace_voxel, route, accept, exchange, compose
    CHECK_THAT(run_raya({"verify", "--help"}).out, Catch::Contains("--timeout S") && Catch::Contains("600"));
}

TEST_CASE("verify --soak: finds a bit that flips once in many copies, with its rate, and repeats by the seed",
          "[cli][verify]") {
    const ScratchFolder scratch;
    const auto soak = [&](const RunOptions& options) {
        const std::string report = scratch / "v.json";
        const RunOutcome run = run_raya({"verify", "--brief", "--only", "machine ring: rotations", "--lanes", "4",
                                         "--soak", "3s", "--seed", "7", "--report", report},
                                        options);
        INFO(run.describe());
        CHECK_THAT(run.out, Catch::Contains("random checks with --seed 7"));
        std::vector<std::string> names;
        const Document document = Document::parse(file_contents(report));
        for (const Document& check : document["devices"][0]["checks"]) names.push_back(check["name"]);
        REQUIRE(!names.empty());
        return std::pair(run, names);
    };
    const auto [right, names] = soak({});
    CHECK(right.code == 0);
    const auto [wrong, names_when_wrong] = soak(device_with_fault("clEnqueueCopyBuffer 40 flip"));
    CHECK(wrong.code == 4);
    // The numbers of checks differ, because both tests take 3 s.
    const auto [name, other_name] = std::ranges::mismatch(names, names_when_wrong);
    CHECK((name == names.end() || other_name == names_when_wrong.end()));
    CHECK(has_line(wrong.out, "after [0-9.]+ s: FAIL  machine .*"));
    // The fault hits the 8th rotation of each check, so all failures of a check have the same first wrong word.
    CHECK(has_line(
        wrong.out,
        "machine ring: rotations of [0-9]+ PEs: failed ([0-9]+) of [0-9]+ times?, first after [0-9.]+ s; \\1 of "
        "\\1 failures? with the same first wrong word: rotation 8 of .* PEs, PE 0, word 0: expected 0x.*, got "
        "0x.*"));
}

TEST_CASE("verify --soak --device all: checks all devices at once", "[cli][verify]") {
    const ScratchFolder scratch;
    const std::string report = scratch / "v.json";
    const RunOutcome run = run_raya({"verify", "--brief", "--only", "machine ring", "--lanes", "4", "--soak", "3s",
                                     "--device", "all", "--report", report},
                                    {.variables = {{"POCL_DEVICES", "pthread basic"}}});
    INFO(run.describe());
    CHECK(run.code == 0);
    const Document devices = Document::parse(file_contents(report))["devices"];
    REQUIRE(devices.size() == 2);
    for (const Document& device : devices) CHECK(device["passed"].get<int>() >= 1);
    CHECK(devices[0]["checks"][0]["name"] == devices[1]["checks"][0]["name"]);  // the same seed
    // Both tests start before one of them ends.
    const std::string platform = "(Portable Computing Language";
    CHECK(run.out.find(platform, run.out.find(platform) + 1) < run.out.find("random checks with --seed"));
}

TEST_CASE("verify: a soak test repeats the first wrong word only if it is the same", "[verify]") {
    SoakCounts counts;
    Check check{"machine", "bus", 1, passed("")};
    CHECK(counts.add(check, 1).empty());
    check.verdict = failed("wrong", {.where = "word 3", .expected = "1", .got = "2", .remedies = {"a remedy"}});
    CHECK_THAT(counts.add(check, 2), Catch::StartsWith("after 2.0 s: FAIL  machine") && Catch::Contains("a remedy"));
    CHECK_THAT(counts.add(check, 3), Catch::StartsWith("after 3.0 s: FAIL") && !Catch::Contains("a remedy"));
    check.verdict.fault.got = "3";
    counts.add(check, 4);
    check.verdict.outcome = Outcome::kSkip;
    CHECK(counts.add(check, 5).empty());
    CHECK(
        counts.summary() ==
        "machine bus: failed 3 of 5 times, first after 2.0 s; 2 of 3 failures with the same first wrong word: word 3: "
        "expected 1, got 2\n");
}

TEST_CASE("verify --kernel-dir: refuses a folder without all kernels, before any check", "[cli][verify]") {
    const ScratchFolder scratch, empty, outputs;
    const std::string partial = write_kernels(scratch / "kernels");
    REQUIRE(std::filesystem::remove(std::filesystem::path(partial) / "shading/light.clh"));
    for (const std::string& folder : {empty.path().string(), (empty / "missing").string(), partial})
        check_refused(outputs, {"verify", "--only", "bus", "--kernel-dir", folder, "--report", outputs / "report.json"},
                      2, {folder, "cannot read kernel file", "--kernel-dir must be a folder like"});
}

// 4123 = 0x101B is CL_DEVICE_SINGLE_FP_CONFIG; 6: infinities, NaNs and rounding to nearest, but no denormal numbers.
TEST_CASE("verify: a device without denormal numbers may keep or flush them, but not return others", "[cli][verify]") {
    const ScratchFolder scratch;
    const Arguments verify = {"verify", "--only", "number fp32"};
    const RunOptions no_denormals = device_with_fault("clGetDeviceInfo 4123 6");
    // Kernels that multiply denormal sums by `factor`.
    const auto verify_with = [&](const std::string& factor) {
        const SourcePatch patch{
            "number/fp32.clh", "num_add(a, b) ((a) + (b))",
            "num_add(a, b) choose(fabs((a) + (b)) < 0x1p-126f, ((a) + (b)) * num_const(" + factor + "), (a) + (b))"};
        return Arguments{"verify", "--only", "number fp32", "--kernel-dir", write_kernels(scratch / factor, {patch})};
    };
    const RunOutcome keeps = run_raya(verify, no_denormals), flushes = run_raya(verify_with("0.0f"), no_denormals);
    INFO(keeps.describe() << flushes.describe());
    CHECK(keeps.code == 0);
    CHECK(has_line(keeps.out, "PASS .* answers, denormal numbers [0-9]+ times kept, 0 times flushed"));
    CHECK(flushes.code == 0);
    CHECK(has_line(flushes.out, "PASS .* answers, denormal numbers [0-9]+ times kept, [1-9][0-9]* times flushed"));
    CHECK(run_raya(verify_with("2.0f"), no_denormals).code == 4);
    CHECK(run_raya(verify_with("0.0f")).code == 4);  // the device promises denormal numbers
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

TEST_CASE("verify --only: refuses a name that no check has", "[cli][verify]") {
    const ScratchFolder scratch;
    check_refused(scratch, {"verify", "--only", "no such check", "--report", scratch / "report.json"}, 2,
                  {"--only \"no such check\": no check of", "the layers are number, geometry, machine and image",
                   "--list", "--full has more"});
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

TEST_CASE("verify --full: fails if the driver has no binary of a program", "[cli][verify]") {
    const std::vector<std::string> command = {"verify", "--full", "--only", "binaries of glass"};
    const RunOutcome right = run_raya(command),
                     faulty = run_raya(command, device_with_fault("clGetProgramInfo 4453 0"));
    INFO(right.describe() + faulty.describe());
    CHECK(right.code == 0);
    CHECK(faulty.code == 4);
    CHECK_THAT(faulty.out,
               Catch::Contains("FAIL  image     binaries of glass fp32") && Catch::Contains("has no binary"));
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
