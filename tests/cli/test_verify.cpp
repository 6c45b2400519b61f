// raya verify: output, reports and exit codes, with faults of kernels and drivers.
#include <fcntl.h>

#include <algorithm>
#include <csignal>
#include <filesystem>
#include <map>
#include <regex>
#include <utility>

#include "host/base/whole_file.hpp"
#include "tests/cli/device_with_fault.hpp"
#include "tests/cli/refusals.hpp"
#include "tests/document.hpp"
#include "tests/kernels/write_kernels.hpp"
#include "tests/thorough.hpp"
#include "tests/verify/faults.hpp"

namespace raya {
namespace {
namespace fs = std::filesystem;

/// Runs raya verify, with four lanes unless --lanes or --as is given, because their kernels compile fastest.
RunOutcome verify(Arguments more, const RunOptions& options = {}) {
    const auto sets_lanes = [](const std::string& option) { return option == "--lanes" || option == "--as"; };
    if (std::ranges::none_of(more, sets_lanes)) more.insert(more.end(), {"--lanes", "4"});
    more.insert(more.begin(), "verify");
    return run_raya(more, options);
}

TEST_CASE("verify: faults of a driver fail checks, with exit code 4", "[cli][verify]") {
    struct Row {
        const char* fault;  // cl_faults.cpp
        Arguments arguments, parts;
        int code = 4;
    };
    // 4100: CL_DEVICE_MAX_WORK_GROUP_SIZE; 4453: CL_PROGRAM_BINARY_SIZES; 4123: CL_DEVICE_SINGLE_FP_CONFIG, 6: no
    // denormal numbers.
    for (const Row& row :
         {Row{"clEnqueueCopyBuffer 2 lost",
              {"--only", "machine ring"},
              {": 0 checks passed, 3 failed", "words at wrong places"}},
          Row{"clEnqueueCopyBufferRect 1 lost",
              {"--only", "machine"},
              {"FAIL  machine.bus_transfers", "FAIL  machine.copies_of_blocks", "5 failed"}},
          Row{"clEnqueueCopyBuffer 20 lost", {"--only", "glass fp32 filter: cyclic:5"}, {"FAIL  image.glass_fp32"}},
          Row{"clEnqueueCopyBufferRect 1 crash",
              {"--only", "machine"},
              {"PASS  machine.torus_routes", "FAIL  machine.copies_of_blocks", "ended by signal 11 (SIGSEGV)",
               "PASS  machine.bus_broadcast_and_gather", "try"}},
          Row{"clEnqueueCopyBufferRect 1 exit", {"--only", "machine copies"}, {"ended by exit code 1"}},
          Row{"clFinish 1 slow",
              {"--brief", "--only", "machine mapping: rows", "--timeout", "1"},
              {"no result after", "--timeout SECONDS"}},
          Row{"clGetDeviceInfo 4100 8",
              {"--only", "machine local memory"},
              {"SKIP  machine.local_memory_and_barriers_32_work_items",
               "needs groups of 32 work-items, the device allows 8", ": 1 check passed, 0 failed, 1 skipped"},
              0},
          Row{"clGetDeviceInfo 4100 8", {"--only", "32 work-items"}, {": 0 checks passed, 0 failed, 1 skipped"}},
          Row{"clGetProgramInfo 4453 0",
              {"--full", "--only", "binaries of glass"},
              {"FAIL  image.binaries_of_glass_fp32", "has no binary"}},
          Row{"clGetDeviceInfo 4123 6", {"--only", "number fp32"}, {" times kept, 0 times flushed"}, 0}}) {
        if (kSanitized && contains(row.fault, "crash")) continue;
        const RunOutcome run = verify(row.arguments, device_with_fault(row.fault));
        INFO(row.fault << "\n" << run.describe());
        CHECK(run.code == row.code);
        for (const std::string& part : row.parts) CHECK_THAT(run.out, Catch::Contains(part));
    }
    const ScratchFolder scratch;
    check_refused(scratch, {"verify", "--report", scratch / "report.json"}, 3,
                  {"looking for devices", "signal 11 (SIGSEGV)", "remedy"},
                  device_with_fault("clGetPlatformIDs 1 crash"));
}

TEST_CASE("verify: faults of kernels fail checks; the output and the report show the difference and remedies",
          "[cli][verify]") {
    const ScratchFolder scratch;
    const std::string file = scratch / "report.json", kernels = write_kernels(scratch / "kernels", {kMappingFault});
    const RunOutcome run = verify({"--only", "machine", "--kernel-dir", kernels, "--report", file});
    INFO(run.describe());
    CHECK(run.code == 4);
    for (const char* part : {"FAIL  machine.mapping_blocks", "expected", "got", "try", "2 failed", "--reproduce DIR"})
        CHECK_THAT(run.out, Catch::Contains(part));
    const Document device = json_of(file)["devices"][0];
    CHECK((device["right"] == false && device["failed"] == 2));
    for (const Document& check : device["checks"])
        if (check["status"] == "FAIL")
            for (const char* key : {"where", "expected", "got"}) CHECK(check[key] != "");
    const std::string counts = write_kernels(scratch / "counts", {kCountFaults.front().patch});
    const RunOutcome wrong = verify({"--only", kOnGlass, "--kernel-dir", counts, "--report", file});
    INFO(wrong.describe());
    CHECK(wrong.code == 4);
    CHECK_THAT(wrong.out, Catch::Contains("wrong counts: reflected, refracted, cycles, pixel_cycles") &&
                              Catch::Contains("expected      reflected 497, refracted 422, cycles ") &&
                              Catch::Contains("got           reflected 919, refracted 0, cycles "));
    const Document remedies = json_of(file)["devices"][0]["checks"][0]["remedies"];
    REQUIRE(remedies.size() == 1);
    CHECK_THAT(remedies[0].get<std::string>(), Catch::StartsWith("run raya verify without --kernel-dir"));
    REQUIRE(fs::remove(fs::path(counts) / "shading/light.clh"));
    const ScratchFolder outputs;
    check_refused(outputs, {"verify", "--only", "bus", "--kernel-dir", counts, "--report", outputs / "report.json"}, 2,
                  {counts, "cannot read kernel file", "--kernel-dir must be a folder like"});
}

TEST_CASE("verify: a device without denormal numbers may keep or flush them, but not return others", "[cli][verify]") {
    const ScratchFolder scratch;
    const RunOptions no_denormals = device_with_fault("clGetDeviceInfo 4123 6");
    // Kernels that multiply denormal sums by `factor`.
    const auto code_with = [&](const std::string& factor, const RunOptions& options) {
        const SourcePatch patch{
            "number/fp32.clh", "num_add(a, b) ((a) + (b))",
            "num_add(a, b) choose(fabs((a) + (b)) < 0x1p-126f, ((a) + (b)) * num_const(" + factor + "), (a) + (b))"};
        return verify({"--only", "number fp32", "--kernel-dir", write_kernels(scratch / factor, {patch})}, options)
            .code;
    };
    CHECK(code_with("0.0f", no_denormals) == 0);
    CHECK(code_with("2.0f", no_denormals) == 4);
    CHECK(code_with("0.0f", {}) == 4);  // the device promises denormal numbers
}

TEST_CASE("verify --expect: listed failures do not count, and listed checks that pass do", "[cli][verify]") {
    const ScratchFolder scratch;
    const std::string kernels = write_kernels(scratch / "kernels", {kMappingFault}), list = scratch / "expect.txt",
                      junit = scratch / "v.xml", report = scratch / "v.json";
    const auto run_with = [&](const std::string& text, int code) {
        write_whole_file(list, text);
        RunOutcome run = verify({"--only", "machine mapping", "--kernel-dir", kernels, "--expect", list, "--junit",
                                 junit, "--report", report});
        INFO(run.describe());
        CHECK(run.code == code);
        return run;
    };
    CHECK_THAT(run_with("# mappings\nmapping: | wrong mapping | https://example.org/1\n", 4).out,
               Catch::Contains("XPASS machine.") && Catch::Contains("XFAIL machine.mapping_blocks") &&
                   Catch::Contains("0 failed, 0 skipped, 2 failed as expected"));
    CHECK_THAT(file_contents(junit),
               Catch::Contains("<failure message=\"passed, but --expect lists it as failing (wrong "
                               "mapping, https://example.org/1)"));
    run_with("mapping: blocks | wrong mapping\nmapping: cyclic*block | also wrong\n", 0);
    CHECK(json_of(report)["devices"][0]["failed_as_expected"] == 2);
    CHECK_THAT(file_contents(junit), Catch::Contains("failures=\"0\"") && Catch::Contains("skipped=\"2\""));
    // A pattern of a check that is not selected, and one without any check.
    const std::string more = "mapping: blocks | a\nmapping: cyclic*block | b\nimage glass | c\nno such | d\n";
    CHECK_THAT(run_with(more, 0).err,
               Catch::Contains(list + ":4: \"no such\" matches no check") && !Catch::Contains("image glass"));
}

TEST_CASE("verify --list: the IDs are those of tests/verify/check_ids.txt, whatever the device", "[cli][verify]") {
    // Lists of expected failures and CI dashboards contain the IDs. If you change one, write the file again and say so
    // in CHANGELOG.md: (build/raya verify --list; echo; build/raya verify --full --list) > tests/verify/check_ids.txt
    const std::string ids = file_contents(RAYA_SOURCE_DIR "/tests/verify/check_ids.txt");
    // 4154: CL_DEVICE_NATIVE_VECTOR_WIDTH_FLOAT; 4123: CL_DEVICE_SINGLE_FP_CONFIG.
    for (const char* fault : {"clGetDeviceInfo 4154 8", "clGetDeviceInfo 4123 6"}) {
        const auto list = [&](const Arguments& depth) { return run_raya(depth, device_with_fault(fault)).out; };
        CHECK(list({"verify", "--list"}) + "\n" + list({"verify", "--full", "--list"}) == ids);
    }
    CHECK(std::ranges::all_of(ids, [](char c) {
        return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_' || c == '.' || c == '\n';
    }));
}

/// Results that deqp-runner reads from the output of a GoogleTest program. A replay of the rules of its parser
/// (gtest_command.rs), because the program itself is not packaged: a line "[ RUN      ] ID" starts a test; the next
/// line with "[ STATUS ] WORD" ends it, and another status than OK, FAILED or SKIPPED is an error.
std::map<std::string, std::string> results_for_deqp_runner(const std::string& output) {
    const std::regex start(R"(\[\sRUN\s*\]\s(.*))"), status(R"(\[\s*(\S*)\s*\]\s(\S*))");
    std::map<std::string, std::string> results;
    std::string id;
    std::smatch match;
    for (const std::string& line : lines_of(output))
        if (id.empty() && std::regex_search(line, match, start))
            id = match[1];
        else if (!id.empty() && std::regex_search(line, match, status))
            results[std::exchange(id, "")] = match[1];
    CHECK(id.empty());
    return results;
}

TEST_CASE("verify as a GoogleTest program, and as an OpenCL conformance test", "[cli][verify]") {
    const ScratchFolder scratch;
    std::vector<std::string> listed;
    std::string group;
    for (const std::string& line : lines_of(verify({"--gtest_list_tests"}).out))
        if (line.starts_with("  "))
            listed.push_back(group + line.substr(2));
        else
            group = line;
    CHECK(listed == lines_of(verify({"--list"}).out));
    const std::string results = scratch / "r.json", kernels = write_kernels(scratch / "kernels", {kMappingFault});
    RunOptions small_groups = device_with_fault("clGetDeviceInfo 4100 8");
    small_groups.variables.emplace_back("CL_CONFORMANCE_RESULTS_FILENAME", results);
    const RunOutcome run =
        verify({"--gtest_filter=machine.mapping_?o*:*_blocks:*32_work_items:*.torus_*-*packets*:*copies*",
                "--kernel-dir", kernels},
               small_groups);
    INFO(run.describe());
    CHECK(run.code == 4);
    const std::map<std::string, std::string> expected = {
        {"machine.mapping_rows", "OK"},
        {"machine.mapping_blocks", "FAILED"},
        {"machine.torus_routes", "OK"},
        {"machine.local_memory_and_barriers_32_work_items", "SKIPPED"}};
    CHECK(results_for_deqp_runner(run.out) == expected);
    const Document json = json_of(results);
    CHECK((json["cmd"] == "raya" && json["args"][0] == "verify" && json["results"].size() == expected.size()));
    for (const auto& [id, status] : expected)
        CHECK(json["results"][id] == (status == "OK" ? "pass" : status == "FAILED" ? "fail" : "skip"));
    check_refused(ScratchFolder(), {"verify", "--gtest_filter=number.[ef]*"}, 2, {"--gtest_filter", "select no check"});
}

TEST_CASE("verify: no check builds more than six programs, for which the default of --timeout allows",
          "[cli][verify]") {
    const ScratchFolder scratch;
    const std::string log = scratch / "log";
    const RunOutcome run = verify({"--only", "torus3d 2x2x2, launches of 1 unit", "--lanes", "4"},
                                  {.variables = {{"RAYA_KERNEL_LOG", log}}});
    INFO(run.describe());
    CHECK(run.code == 0);
    const std::vector<std::string> lines = lines_of(file_contents(log));
    CHECK(std::ranges::count_if(lines, [](const std::string& line) { return contains(line, "\tbuild\t"); }) == 6);
}

TEST_CASE("verify --repeat: finds a copy that is lost once in many", "[cli][verify]") {
    const Arguments repeat = {"--only", "machine ring: rotations of 7", "--repeat", "9"};
    CHECK(verify(repeat).code == 0);
    const RunOutcome run = verify(repeat, device_with_fault("clEnqueueCopyBuffer 40 lost"));
    INFO(run.describe());
    CHECK(run.code == 4);
    CHECK(has_line(run.out, "FAIL  machine\\..* \\(in run [2-9] of 9\\)"));
}

/// Returns true if the command line of any running process contains this text.
bool is_running_with(const std::string& argument) {
    for (const auto& entry : fs::directory_iterator("/proc")) {
        std::ifstream file(entry.path() / "cmdline", std::ios::binary);
        if (contains(std::string{std::istreambuf_iterator<char>(file), {}}, argument)) return true;
    }
    return false;
}

TEST_CASE("verify: a signal ends it and its worker process at once", "[cli][verify]") {
    using namespace std::chrono;
    const ScratchFolder kernels, outputs;
    const Arguments arguments = {
        "verify", "--full", "--kernel-dir", write_kernels(kernels / "kernels"), "--report", outputs / "report.json"};
    for (const int after_ms : {0, 1500}) {
        const RunOutcome run = run_raya(arguments, {.signal = SIGINT, .signal_after_ms = after_ms});
        INFO(run.describe());
        CHECK(run.code == 128 + SIGINT);
        CHECK_THAT(run.err, Catch::Contains("raya: interrupted\n"));
        CHECK(outputs.entries() == 0);
        const auto deadline = steady_clock::now() + seconds(5);
        while (is_running_with(kernels.path()) && steady_clock::now() < deadline)
            std::this_thread::sleep_for(milliseconds(20));
        CHECK_FALSE(is_running_with(kernels.path()));
    }
}

/// Runs raya with a terminal as stderr, on a device that takes 2.5 s to open, and returns the text on the terminal.
std::string text_on_terminal(const Arguments& arguments, const std::string& fault) {
    const int terminal = ::posix_openpt(O_RDWR | O_NOCTTY);
    if (terminal < 0 || ::grantpt(terminal) != 0 || ::unlockpt(terminal) != 0) return "no terminal";
    RunOptions options = device_with_fault(fault);
    options.error_file = ::ptsname(terminal);
    const int slave_end = ::open(options.error_file.c_str(), O_RDWR | O_NOCTTY);  // open after raya has ended
    run_raya(arguments, options);
    ::fcntl(terminal, F_SETFL, O_NONBLOCK);
    std::string text;
    std::array<char, 4096> block{};
    for (ssize_t count; (count = ::read(terminal, block.data(), block.size())) > 0;)
        text.append(block.data(), static_cast<std::size_t>(count));
    ::close(slave_end);
    ::close(terminal);
    return text;
}

TEST_CASE("progress: slow commands name their step on a terminal within two seconds; with -q they print none",
          "[cli][slow]") {
    const ScratchFolder folder;
    Arguments render = {"render", scene_file("planes"), "-o", folder / "x.pfm", "--size", "12", "--lanes", "4", "--pes",
                        "4"};
    const Arguments one_check = {"verify", "--only", "machine bus", "--lanes", "4"};
    CHECK_THAT(text_on_terminal(render, "clCreateContext 1 slow"),
               Catch::Contains("preparing ... 1 s") && Catch::EndsWith("\r\033[K"));
    CHECK_THAT(
        text_on_terminal(one_check, "clFinish 1 slow"),
        Catch::Contains("\r\033[Krunning machine.bus_broadcast_and_gather ... 1 s") && Catch::EndsWith("\r\033[K"));
    render.emplace_back("-q");
    CHECK(text_on_terminal(render, "clCreateContext 1 slow") == "");
    const RunOutcome run = run_raya(one_check, device_with_fault("clFinish 1 slow"));
    CHECK((run.code == 0 && run.err.empty()));
}

}  // namespace
}  // namespace raya
