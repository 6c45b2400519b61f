// Each of raya's writing calls fails in a run of its own (disk_faults.cpp). raya repeats interrupted and short calls.
// After other errors raya ends with exit code 2 and a message. Either the old file is unchanged or the new one is
// complete.
#include <algorithm>
#include <cerrno>
#include <filesystem>
#include <fstream>
#include <map>

#include "tests/cli/refusals.hpp"
#include "tests/document.hpp"
#include "tests/paths.h"
#include "tests/thorough.hpp"

namespace raya {
namespace {

namespace fs = std::filesystem;
using Contents = std::map<std::string, std::string>;  // [file name, contents]

constexpr const char* kOld = "old content";

struct WritingCommand {
    std::string name;
    Arguments arguments;     // file names include the folder
    bool replaces = true;    // replaces existing files
    bool is_slow = false;    // tested only if thorough()
    std::string input = "";  // name of the file that the command reads
    bool prints = false;     // prints the same text on stdout in each run
};

/// Returns the commands that write files, with arguments that write them into `folder`.
std::vector<WritingCommand> commands(const std::string& folder) {
    const auto file = [&](const std::string& name) { return folder + "/" + name; };
    const auto render = [&](const Arguments& extra_options) {
        Arguments arguments = {"render", scene_file("centre"), "--size", "16", "--lanes", "4", "--format", "fp32"};
        arguments.insert(arguments.end(), extra_options.begin(), extra_options.end());
        return arguments;
    };
    const Arguments bench = {"bench", scene_file("centre"), "--size", "16", "--samples", "1", "--lanes",
                             "4",     "--format",           "fp32"};
    const auto bench_with = [&](const std::string& option, const std::string& name) {
        Arguments arguments = bench;
        arguments.insert(arguments.end(), {option, file(name)});
        return arguments;
    };
    return {
        {"generate", {"generate", "balls", "--level", "1", "-o", file("x.nff")}},
        {"help", {"help", "render"}, true, false, "", true},
        {"page", {"page", file("saved.json"), "-o", file("x.html")}, true, false, "saved.json"},
        {"render", render({"-o", file("x.ppm"), "--report", file("x.json"), "--trace", file("t.json")})},
        {"render -o -", render({"-o", "-"}), true, false, "", true},
        {"checkpoint",
         render({"-o", file("x.ppm"), "--checkpoint", file("s.rst"), "--checkpoint-every", "0", "--pes", "4", "--group",
                 "1"}),
         false},
        {"cost", render({"-o", file("x.png"), "--cost", file("x.exr")}), true, true},
        {"render --page", render({"-o", file("x.pfm"), "--page", file("x.html")}), true, true},
        {"explore", {"explore", scene_file("centre"), "--size", "16", "-o", file("x.html")}, true, true},
        {"bench --report", bench_with("--report", "x.json"), true, true},
        {"bench --page", bench_with("--page", "x.html"), true, true},
        {"verify",
         {"verify", "--only", "machine bus", "--lanes", "4", "--report", file("x.json"), "--page", file("x.html")},
         true,
         true},
    };
}

Contents files_of(const fs::path& folder) {
    Contents files;
    for (const auto& entry : fs::directory_iterator(folder))
        files[entry.path().filename().string()] = file_contents(entry.path());
    return files;
}

/// Returns true if the file is complete. A file that contains times must be well-formed; others must equal `expected`.
bool is_complete(const std::string& name, const std::string& content, const Contents& expected) {
    if (name.ends_with(".rst")) return content.starts_with("raya");
    if (!expected.contains(name)) return false;
    if (name.ends_with(".json")) return Document::accept(content);
    if (name.ends_with(".html")) return content.ends_with("</html>\n");
    return content == expected.at(name);
}

struct FaultRun {
    RunOutcome run;
    Arguments calls;  // lines of RAYA_WRITE_CALLS, such as "write" and "open fails"
    Contents files;
    std::string printed;  // stdout, only for commands with `prints`
};

/// Runs command `index` in a new folder. `fault`: value of RAYA_WRITE_FAULT; `old`: files that exist before the run,
/// with kOld as content.
FaultRun run_with(std::size_t index, const std::string& fault, const Contents& old, const std::string& saved_report) {
    const ScratchFolder folder, logs;
    const WritingCommand command = commands(folder.path().string())[index];
    for (const auto& [name, content] : old) std::ofstream(folder / name) << kOld;
    if (!command.input.empty()) std::ofstream(folder / command.input) << saved_report;
    FaultRun result;
    result.run =
        run_raya(command.arguments, {.variables = {{"LD_PRELOAD", RAYA_DISK_FAULTS},
                                                   {"RAYA_WRITE_FAULT", fault},
                                                   {"RAYA_WRITE_CALLS", logs / "calls"},
                                                   {"ASAN_OPTIONS", "detect_leaks=0:verify_asan_link_order=0"}}});
    std::ifstream calls(logs / "calls");
    for (std::string line; std::getline(calls, line);) result.calls.push_back(line);
    result.files = files_of(folder.path());
    result.files.erase(command.input);
    if (command.prints) result.printed = result.run.out;
    return result;
}

void check_fault(const std::string& fault, const FaultRun& faulty, const FaultRun& faultless) {
    const bool call_failed =
        std::any_of(faulty.calls.begin(), faulty.calls.end(), [](auto& call) { return call.ends_with("fails"); });
    const bool stdout_fails = std::find(faulty.calls.begin(), faulty.calls.end(), "stdout fails") != faulty.calls.end();
    const bool repeated = fault.ends_with(" short") || fault.ends_with(" " + std::to_string(EINTR));
    INFO(faulty.run.describe());
    if (!call_failed || (repeated && !stdout_fails)) {
        CHECK(faulty.run.code == 0);
        if (!faultless.printed.empty()) CHECK((faulty.run.out == faultless.printed));
        REQUIRE(faulty.files.size() == faultless.files.size());
    } else {
        CHECK(faulty.run.code == 2);
        const int error = std::stoi(fault.substr(fault.find(' ')));
        const std::string reason = stdout_fails ? "stdout" : std::generic_category().message(error);
        CHECK_THAT(faulty.run.err, Catch::Contains("raya: cannot ") && Catch::Contains(reason));
    }
    for (const auto& [name, content] : faulty.files) {
        CAPTURE(name);
        CHECK((is_complete(name, content, faultless.files) || (faulty.run.code == 2 && content == kOld)));
    }
}

TEST_CASE("every command that writes: repeats interrupted and short calls; other errors leave whole files", "[cli]") {
    const ScratchFolder folder;
    const std::string report = folder / "x.json";
    REQUIRE(run_raya({"render", scene_file("centre"), "--size", "16", "--lanes", "4", "-o", folder / "x.ppm",
                      "--report", report})
                .code == 0);
    const std::string saved_report = file_contents(report);
    const std::vector<std::string> errors = {std::to_string(ENOSPC), std::to_string(EIO), std::to_string(EINTR),
                                             "short"};
    const std::vector<WritingCommand> tested_commands = commands("");
    for (std::size_t index = 0; index < tested_commands.size(); ++index) {
        if (tested_commands[index].is_slow && !thorough()) continue;
        CAPTURE(tested_commands[index].name);
        const FaultRun faultless = run_with(index, "0 0", {}, saved_report);
        INFO(faultless.run.describe());
        REQUIRE(faultless.run.code == 0);
        REQUIRE(!faultless.calls.empty());
        const Contents old = tested_commands[index].replaces ? faultless.files : Contents{};
        std::size_t calls = 0;
        for (std::size_t call = 1; call <= faultless.calls.size(); ++call) {
            // If equal calls follow one another, only the first two and the last of them fail, unless the test is
            // thorough and the command is not slow.
            const auto call_name = [&](std::size_t number) {
                return number <= faultless.calls.size() ? faultless.calls[number - 1] : "end";
            };
            const bool all_writes = thorough() && !tested_commands[index].is_slow;
            if (!all_writes && call > 2 && call_name(call) == call_name(call - 1) &&
                call_name(call) == call_name(call + 1))
                continue;
            ++calls;
            for (std::size_t error = 0; error < errors.size(); ++error) {
                if (!thorough() && error != calls % errors.size()) continue;
                const std::string fault = std::to_string(call) + " " + errors[error];
                CAPTURE(fault, faultless.calls[call - 1]);
                check_fault(fault, run_with(index, fault, old, saved_report), faultless);
            }
        }
    }
}

}  // namespace
}  // namespace raya
