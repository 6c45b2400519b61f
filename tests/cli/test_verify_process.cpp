// raya verify's processes: what a driver that ends one leaves behind, Ctrl-C, and the line that says what runs.
#include <fcntl.h>

#include <algorithm>
#include <csignal>

#include "tests/cli/failing_device.hpp"
#include "tests/cli/refusals.hpp"
#include "tests/document.hpp"
#include "tests/kernels/write_kernels.hpp"
#include "tests/thorough.hpp"

namespace raya {
namespace {
namespace fs = std::filesystem;

TEST_CASE("a driver that crashes fails the check that ran, and the others go on", "[cli][verify]") {
    struct Row {
        const char *fault, *ending;
    };
    for (const Row& row : {Row{"clEnqueueCopyBufferRect 1 crash", "ended by signal 11 (SIGSEGV)"},
                           Row{"clEnqueueCopyBufferRect 1 exit", "ended by exit code 1"}}) {
        const ScratchFolder scratch;
        const std::string file = scratch / "report.json";
        const RunOutcome run = run_raya({"verify", "--only", "machine", "--report", file}, failing_device(row.fault));
        INFO(run.told());
        CHECK(run.code == 4);
        for (const char* part : {"PASS  machine   ways through the torus", "FAIL  machine   copies of blocks",
                                 "PASS  machine   bus: broadcast and gather", "where", "try"})
            CHECK_THAT(run.out, Catch::Contains(part));
        CHECK_THAT(run.out, Catch::Contains(row.ending));
        CHECK(has_line(run.out, ".*: [0-9]+ checks passed, [0-9]+ failed, 0 skipped in [0-9.]+ s"));
        const auto device = Document::parse(file_contents(file))["devices"][0];
        CHECK(device["failed"].get<int>() >= 3);  // copies of blocks; ring, bus and links move rows
        CHECK(device["passed"].get<int>() >= 11);
        for (const auto& check : device["checks"])
            if (check["status"] == "FAIL") CHECK((check["told"] == row.ending && check["where"] != ""));
    }
}

TEST_CASE("a driver that crashes before any check is trouble with the device", "[cli][verify]") {
    const ScratchFolder scratch;
    const Surroundings crash = failing_device("clGetPlatformIDs 1 crash");
    check_refused(scratch, {"verify", "--report", scratch / "report.json"}, 3,
                  {"looking for devices", "signal 11 (SIGSEGV)", "remedy"}, crash);
}

TEST_CASE("what no process of raya's own was given is refused", "[cli][verify]") {
    const ScratchFolder outputs;
    check_refused(outputs, {"--worker", "x"}, 2, {"--worker:1: not valid JSON"});
    check_refused(outputs, {"--worker", "{}"}, 2, {"--worker", "verbosity"});
    check_refused(outputs, {"--worker"}, 2, {"no option --worker"});
    check_refused(outputs, {"verify", "--lines", "1"}, 2, {"no option --lines"});
}

/// Whether a process has this among its arguments.
bool is_running_with(const std::string& argument) {
    for (const auto& entry : fs::directory_iterator("/proc")) {
        std::ifstream file(entry.path() / "cmdline", std::ios::binary);
        const std::string arguments{std::istreambuf_iterator<char>(file), {}};
        if (contains(arguments, argument)) return true;
    }
    return false;
}

TEST_CASE("Ctrl-C ends verify and the process of its checks at once", "[cli][verify]") {
    using namespace std::chrono;
    const ScratchFolder kernels, outputs;
    const std::string copy = write_kernels(kernels / "kernels");
    const Words command = {"verify", "--full", "--kernel-dir", copy, "--report", outputs / "report.json"};
    for (const auto& [signal, after_ms] : {std::pair(SIGINT, 0), std::pair(SIGINT, 1500), std::pair(SIGTERM, 1500)}) {
        CAPTURE(signal, after_ms);
        const RunOutcome run = run_raya(command, {.signal = signal, .signal_after_ms = after_ms});
        INFO(run.told());
        CHECK(run.code == 128 + signal);
        CHECK_THAT(run.err, Catch::Contains("raya: interrupted\n"));
        CHECK(outputs.entries() == 0);
        const auto late = steady_clock::now() + seconds(5);
        while (is_running_with(kernels.path()) && steady_clock::now() < late)
            std::this_thread::sleep_for(milliseconds(20));
        CHECK_FALSE(is_running_with(kernels.path()));
    }
}

/// What raya prints on a terminal that is its stderr.
std::string told_on_terminal(const Words& arguments, Surroundings around) {
    const int terminal = ::posix_openpt(O_RDWR | O_NOCTTY);
    if (terminal < 0 || ::grantpt(terminal) != 0 || ::unlockpt(terminal) != 0) return "no terminal";
    const std::string name = ::ptsname(terminal);
    const int other_end = ::open(name.c_str(), O_RDWR | O_NOCTTY);  // so that the terminal lives on
    around.error_file = name;
    run_raya(arguments, around);
    ::fcntl(terminal, F_SETFL, O_NONBLOCK);
    std::string text;
    std::array<char, 4096> block{};
    for (ssize_t count; (count = ::read(terminal, block.data(), block.size())) > 0;)
        text.append(block.data(), static_cast<std::size_t>(count));
    ::close(other_end);
    ::close(terminal);
    return text;
}

long count_of(const std::string& text, const std::string& what) {
    long count = 0;
    for (std::size_t at = 0; (at = text.find(what, at)) != text.npos; at += what.size()) ++count;
    return count;
}

TEST_CASE("every command that takes long says so on a terminal within two seconds, and draws a few times a second",
          "[cli][slow]") {
    const ScratchFolder folder;
    const Surroundings slow = failing_device("clCreateContext 1 slow");
    const Words render = {"render", scene_file("planes"), "-o", folder / "x.pfm", "--size", "12", "--lanes", "4"};
    const auto with = [&](Words words, const Words& more) {
        words.insert(words.end(), more.begin(), more.end());
        return words;
    };
    for (const auto& [words, told] :
         quick(2, {std::pair<Words, std::string>{with(render, {"--pes", "4"}), "preparing ... 1 s"},
                   {with(render, {"--machine", "torus"}), "preparing ... 1 s"},
                   {{"bench", "--size", "8", "--pes", "8", "--lanes", "4", "--format", "fp32", "--samples", "1"},
                    "preparing ... 1 s"}})) {
        const auto start = std::chrono::steady_clock::now();
        const std::string text = told_on_terminal(words, slow);
        const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
        CAPTURE(words[0], text);
        CHECK_THAT(text, Catch::Contains(told) && Catch::EndsWith("\r\033[K"));
        CHECK(static_cast<double>(count_of(text, "\r\033[K")) <= 10 * seconds + 1);
    }
}

TEST_CASE("with -q nothing is drawn on a terminal", "[cli][verbosity][slow]") {
    const ScratchFolder folder;
    const Surroundings slow = failing_device("clCreateContext 1 slow");
    for (const Words& words : {Words{"render", scene_file("planes"), "-o", folder / "x.pfm", "--size", "12", "--pes",
                                     "4", "--lanes", "4", "-q"},
                               Words{"verify", "--only", "machine bus", "--lanes", "4", "-q"}})
        CHECK(told_on_terminal(words, slow) == "");
}

TEST_CASE("a check that takes long is named on a terminal, and nowhere else", "[cli][verify][slow]") {
    const Words one_check = {"verify", "--only", "machine bus"};
    const Surroundings slow = failing_device("clFinish 1 slow");
    CHECK_THAT(
        told_on_terminal(one_check, slow),
        Catch::Contains("\r\033[Krunning machine bus: broadcast and gather ... 1 s") && Catch::EndsWith("\r\033[K"));
    const RunOutcome run = run_raya(one_check, slow);
    INFO(run.told());
    CHECK(run.code == 0);
    CHECK(run.err.empty());
}

}  // namespace
}  // namespace raya
