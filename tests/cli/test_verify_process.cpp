// The worker processes of raya verify: driver crashes, Ctrl-C, and the progress line.
#include <fcntl.h>

#include <algorithm>
#include <csignal>

#include "tests/cli/device_with_fault.hpp"
#include "tests/cli/refusals.hpp"
#include "tests/document.hpp"
#include "tests/kernels/write_kernels.hpp"
#include "tests/thorough.hpp"

namespace raya {
namespace {
namespace fs = std::filesystem;

TEST_CASE("verify: a driver crash fails the running check, and raya runs the other checks", "[cli][verify]") {
    struct Row {
        const char *fault, *ending;
    };
    for (const Row& row : {Row{"clEnqueueCopyBufferRect 1 crash", "ended by signal 11 (SIGSEGV)"},
                           Row{"clEnqueueCopyBufferRect 1 exit", "ended by exit code 1"}}) {
        const ScratchFolder scratch;
        const std::string file = scratch / "report.json";
        const RunOutcome run =
            run_raya({"verify", "--only", "machine", "--report", file}, device_with_fault(row.fault));
        INFO(run.describe());
        CHECK(run.code == 4);
        for (const char* part : {"PASS  machine   torus routes", "FAIL  machine   copies of blocks",
                                 "PASS  machine   bus: broadcast and gather", "where", "try"})
            CHECK_THAT(run.out, Catch::Contains(part));
        CHECK_THAT(run.out, Catch::Contains(row.ending));
        CHECK(has_line(run.out, ".*: [0-9]+ checks passed, [0-9]+ failed, 0 skipped in [0-9.]+ s"));
        const auto device = Document::parse(file_contents(file))["devices"][0];
        CHECK(device["failed"].get<int>() >= 3);  // the checks of rectangular copies: blocks, ring, bus and links
        CHECK(device["passed"].get<int>() >= 11);
        for (const auto& check : device["checks"])
            if (check["status"] == "FAIL") CHECK((check["result"] == row.ending && check["where"] != ""));
    }
}

TEST_CASE("verify: a driver crash before any check causes exit code 3", "[cli][verify]") {
    const ScratchFolder scratch;
    const RunOptions crash = device_with_fault("clGetPlatformIDs 1 crash");
    check_refused(scratch, {"verify", "--report", scratch / "report.json"}, 3,
                  {"looking for devices", "signal 11 (SIGSEGV)", "remedy"}, crash);
}

TEST_CASE("--worker: raya refuses it from users", "[cli][verify]") {
    const ScratchFolder outputs;
    check_refused(outputs, {"--worker", "x"}, 2, {"--worker: not valid JSON"});
    check_refused(outputs, {"--worker", "{}"}, 2, {"--worker", "verbosity"});
    check_refused(outputs, {"--worker"}, 2, {"no option --worker"});
    check_refused(outputs, {"verify", "--lines", "1"}, 2, {"no option --lines"});
}

/// Returns true if the command line of any running process contains this text.
bool is_running_with(const std::string& argument) {
    for (const auto& entry : fs::directory_iterator("/proc")) {
        std::ifstream file(entry.path() / "cmdline", std::ios::binary);
        const std::string arguments{std::istreambuf_iterator<char>(file), {}};
        if (contains(arguments, argument)) return true;
    }
    return false;
}

TEST_CASE("verify: SIGINT and SIGTERM end it and its worker process at once", "[cli][verify]") {
    using namespace std::chrono;
    const ScratchFolder kernels, outputs;
    const std::string kernel_folder = write_kernels(kernels / "kernels");
    const Arguments command = {"verify", "--full", "--kernel-dir", kernel_folder, "--report", outputs / "report.json"};
    for (const auto& [signal, after_ms] : {std::pair(SIGINT, 0), std::pair(SIGINT, 1500), std::pair(SIGTERM, 1500)}) {
        CAPTURE(signal, after_ms);
        const RunOutcome run = run_raya(command, {.signal = signal, .signal_after_ms = after_ms});
        INFO(run.describe());
        CHECK(run.code == 128 + signal);
        CHECK_THAT(run.err, Catch::Contains("raya: interrupted\n"));
        CHECK(outputs.entries() == 0);
        const auto deadline = steady_clock::now() + seconds(5);
        while (is_running_with(kernels.path()) && steady_clock::now() < deadline)
            std::this_thread::sleep_for(milliseconds(20));
        CHECK_FALSE(is_running_with(kernels.path()));
    }
}

/// Runs raya with a terminal as stderr and returns the text on the terminal.
std::string text_on_terminal(const Arguments& arguments, RunOptions run_options) {
    const int terminal = ::posix_openpt(O_RDWR | O_NOCTTY);
    if (terminal < 0 || ::grantpt(terminal) != 0 || ::unlockpt(terminal) != 0) return "no terminal";
    const std::string name = ::ptsname(terminal);
    const int slave_end = ::open(name.c_str(), O_RDWR | O_NOCTTY);  // keeps the terminal open after raya has ended
    run_options.error_file = name;
    run_raya(arguments, run_options);
    ::fcntl(terminal, F_SETFL, O_NONBLOCK);
    std::string text;
    std::array<char, 4096> block{};
    for (ssize_t count; (count = ::read(terminal, block.data(), block.size())) > 0;)
        text.append(block.data(), static_cast<std::size_t>(count));
    ::close(slave_end);
    ::close(terminal);
    return text;
}

long count_occurrences(const std::string& text, const std::string& part) {
    long count = 0;
    for (std::size_t position = 0; (position = text.find(part, position)) != text.npos; position += part.size())
        ++count;
    return count;
}

TEST_CASE("progress: slow commands print progress on a terminal within two seconds, at most 10 times a second",
          "[cli][slow]") {
    const ScratchFolder folder;
    const RunOptions slow = device_with_fault("clCreateContext 1 slow");
    const Arguments render = {"render", scene_file("planes"), "-o", folder / "x.pfm", "--size", "12", "--lanes", "4"};
    const auto extended = [&](Arguments arguments, const Arguments& extra_options) {
        arguments.insert(arguments.end(), extra_options.begin(), extra_options.end());
        return arguments;
    };
    for (const auto& [arguments, progress] :
         quick(2, {std::pair<Arguments, std::string>{extended(render, {"--pes", "4"}), "preparing ... 1 s"},
                   {extended(render, {"--machine", "torus"}), "preparing ... 1 s"},
                   {{"bench", "--size", "8", "--pes", "8", "--lanes", "4", "--format", "fp32", "--samples", "1"},
                    "preparing ... 1 s"}})) {
        const auto start = std::chrono::steady_clock::now();
        const std::string text = text_on_terminal(arguments, slow);
        const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
        CAPTURE(arguments[0], text);
        CHECK_THAT(text, Catch::Contains(progress) && Catch::EndsWith("\r\033[K"));
        CHECK(static_cast<double>(count_occurrences(text, "\r\033[K")) <= 10 * seconds + 1);
    }
}

TEST_CASE("progress: commands with -q print none", "[cli][verbosity][slow]") {
    const ScratchFolder folder;
    const RunOptions slow = device_with_fault("clCreateContext 1 slow");
    for (const Arguments& arguments : {Arguments{"render", scene_file("planes"), "-o", folder / "x.pfm", "--size", "12",
                                                 "--pes", "4", "--lanes", "4", "-q"},
                                       Arguments{"verify", "--only", "machine bus", "--lanes", "4", "-q"}})
        CHECK(text_on_terminal(arguments, slow) == "");
}

TEST_CASE("progress: verify names a slow check on a terminal, but not if stderr is a file", "[cli][verify][slow]") {
    const Arguments one_check = {"verify", "--only", "machine bus"};
    const RunOptions slow = device_with_fault("clFinish 1 slow");
    CHECK_THAT(
        text_on_terminal(one_check, slow),
        Catch::Contains("\r\033[Krunning machine bus: broadcast and gather ... 1 s") && Catch::EndsWith("\r\033[K"));
    const RunOutcome run = run_raya(one_check, slow);
    INFO(run.describe());
    CHECK(run.code == 0);
    CHECK(run.err.empty());
}

}  // namespace
}  // namespace raya
