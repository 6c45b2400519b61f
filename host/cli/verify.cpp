// raya verify: checks a device, its driver and its compiler.
#include "host/verify/verify.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cstdio>
#include <map>
#include <memory>

#include "host/base/encoding.hpp"
#include "host/base/json.hpp"
#include "host/base/log.hpp"
#include "host/base/whole_file.hpp"
#include "host/cli/commands.hpp"
#include "host/cli/help.hpp"
#include "host/cli/options.hpp"
#include "host/cli/page.hpp"
#include "host/cli/parse.hpp"
#include "host/error.hpp"
#include "host/verify/supervisor.hpp"

namespace raya {
namespace {

// A check that takes longer counts as hung: ten build budgets. A check builds at most six programs (test_verify.cpp),
// each within the budget; the rest is for its launches.
constexpr std::chrono::duration<double> kDefaultTimeout = 10 * kBuildBudget;

struct VerifyCommand {
    VerifySettings checks{.timeout_s = kDefaultTimeout.count()};
    std::string device, report, page, junit, conformance, expect, reproduce, kernel_dir, shard;
    bool brief = false, quick = false, full = false, list = false, gtest_list = false;
    bool is_gtest() const { return !checks.filter.empty(); }  // output in the form of GoogleTest
};

VerifySettings settings_of(const VerifyCommand& command) {
    VerifySettings settings = command.checks;
    settings.depth = command.full ? Depth::kFull : command.brief ? Depth::kBrief : Depth::kQuick;
    settings.sources.folder = command.kernel_dir;
    settings.expected_failures = read_expected_failures(command.expect);
    if (command.shard.empty()) return settings;
    const std::vector<std::uint32_t> shard = parse_sizes(command.shard, '/');
    if (shard.size() != 2 || shard[0] > shard[1])
        throw UserError(fmt::format("--shard {}: must be I/N with I 1..N, such as 2/4", command.shard));
    settings.shard = shard[0], settings.shards = shard[1];
    return settings;
}

// Prints the IDs, which are the same on every device; in the form of GoogleTest, each layer with a dot, and below it
// the names of its checks.
void list_checks(const VerifyCommand& command, const VerifySettings& settings) {
    std::string layer;
    for (const std::string& id : check_ids(choose_device(command.device == "all" ? "" : command.device), settings)) {
        const std::size_t dot = id.find('.') + 1;
        if (command.gtest_list && id.substr(0, dot) != layer) fmt::print("{}\n", layer = id.substr(0, dot));
        fmt::print("{}\n", command.gtest_list ? "  " + id.substr(dot) : id);
    }
}

// Returns the line with which GoogleTest ends a test; if it failed, with the lines on the failure.
std::string gtest_lines(const Check& check) {
    const Outcome outcome = check.verdict.outcome;
    const char* const status = is_unwanted(outcome)        ? "[  FAILED  ]"
                               : outcome == Outcome::kPass ? "[       OK ]"
                                                           : "[  SKIPPED ]";
    return fmt::format("{} {} ({:.0f} ms)\n{}", status, check.id(), 1e3 * check.seconds,
                       outcome == Outcome::kPass ? "" : check_lines(check));
}

// Returns the text "57 checks passed, 0 failed, 2 skipped in 12.3 s".
std::string closing_text(const std::vector<Check>& checks, double seconds) {
    const std::size_t expected = count_of(checks, Outcome::kExpectedFail),
                      unexpected = count_of(checks, Outcome::kUnexpectedPass);
    return fmt::format("{} passed, {} failed, {} skipped{}{} in {:.1f} s",
                       counted(count_of(checks, Outcome::kPass), "check"), count_of(checks, Outcome::kFail),
                       count_of(checks, Outcome::kSkip),
                       expected ? fmt::format(", {} failed as expected", expected) : "",
                       unexpected ? fmt::format(", {} passed unexpectedly", unexpected) : "", seconds);
}

void print(const std::string& lines) {
    clear_status();
    fmt::print("{}", lines);
    std::fflush(stdout);
}

// Verifies device number `index` of those that --device selects, and prints each check. Sets `devices` to the number of
// selected devices.
DeviceChecks verify_device(const VerifyCommand& command, std::size_t index, const VerifySettings& settings,
                           std::size_t& devices) {
    const SupervisorSink sink{
        .device =
            [&](const DeviceChecks& device, const std::vector<std::string>& unusable_devices, std::size_t count) {
                devices = count;
                if (is_quiet()) return;
                for (const std::string& line : index == 0 ? unusable_devices : std::vector<std::string>{})
                    print(line + "\n");
                print(fmt::format("{} ({}, driver {})\n", device.name, device.platform, device.driver));
            },
        .running =
            [&](const std::string& id, double seconds) {
                if (command.is_gtest() && seconds == 0) print(fmt::format("[ RUN      ] {}\n", id));
                if (shows_progress()) show_status(fmt::format("running {} ... {:.0f} s", id, seconds));
            },
        .finished =
            [&](const Check& check) {
                if (command.is_gtest())
                    print(gtest_lines(check));
                else if ((!is_quiet() && settings.soak_s == 0) || is_unwanted(check.verdict.outcome))
                    print(check_lines(check));
            }};
    DeviceChecks all = supervise(command.device, index, settings, sink);
    if (!is_quiet() || devices == 1 || !all.all_passed())
        print(fmt::format("{}: {}\n", all.name, closing_text(all.checks, all.seconds)));
    return all;
}

// Writes the case of the device's first failure, if --reproduce asks for it.
void reproduce_first_failure(const VerifyCommand& command, const DeviceChecks& device, const VerifySettings& settings) {
    const auto check =
        std::ranges::find_if(device.checks, [](const Check& c) { return c.verdict.outcome == Outcome::kFail; });
    if (check == device.checks.end()) return;
    if (command.reproduce.empty()) {
        if (!is_quiet()) fmt::print("--reproduce DIR writes the first failure as a C program, for a bug report\n");
        return;
    }
    try {
        fmt::print("{}", reproduce(command.device, device, settings, *check, command.reproduce));
    } catch (const UserError& error) {
        warn(error.what());
    }
}

// Returns the results as the OpenCL conformance tests write them; of several devices, the worst result of each check.
std::string conformance_results(const std::vector<DeviceChecks>& devices) {
    std::vector<std::string> words = split(read_input("/proc/self/cmdline"), '\0');
    words.pop_back();  // after the last NUL
    Json results = Json::object();
    for (const DeviceChecks& device : devices)
        for (const Check& check : device.checks) {
            const Outcome outcome = check.verdict.outcome;
            Json& result = results[check.id()];
            if (is_unwanted(outcome) || result == "fail")
                result = "fail";
            else if (outcome == Outcome::kPass || result == "pass")
                result = "pass";
            else
                result = "skip";
        }
    return json_dump(
               {{"cmd", words.front()}, {"args", std::vector(words.begin() + 1, words.end())}, {"results", results}},
               2) +
           "\n";
}

void run_verify(const VerifyCommand& command) {
    if (command.brief + command.quick + command.full > 1) throw UserError("--brief, --quick, --full: give one of them");
    if (!command.page.empty()) check_page_name("--page", command.page);
    const VerifySettings settings = settings_of(command);
    if (command.list || command.gtest_list) return list_checks(command, settings);
    if (!command.reproduce.empty() && command.device == "all")
        throw UserError("--reproduce with --device all: name the device with the failed check");
    if (!command.reproduce.empty()) check_case_folder(command.reproduce);
    Warnings warnings;
    warn_of_build_options(warnings);
    std::vector<DeviceChecks> device_checks;
    for (std::size_t devices = 1; device_checks.size() < devices;)
        device_checks.push_back(verify_device(command, device_checks.size(), settings, devices));
    for (const std::string& text : unmatched_patterns(settings.expected_failures, device_checks))
        warn(text + "; raya verify --full --list prints the IDs of all checks");
    write_report_and_page({command.report, command.page}, to_json(VerifyReport{settings.depth, device_checks}));
    if (!command.junit.empty()) write_whole_file(command.junit, junit_report("raya verify", device_checks));
    if (!command.conformance.empty()) write_whole_file(command.conformance, conformance_results(device_checks));
    if (std::ranges::all_of(device_checks, &DeviceChecks::all_passed)) return;
    if (device_checks.size() == 1) reproduce_first_failure(command, device_checks.front(), settings);
    throw CheckFailure{};
}

}  // namespace

void add_verify_command(CLI::App& program) {
    CLI::App* command = program.add_subcommand(
        "verify", "Check arithmetic, hits, machines and images of a device, its driver and its compiler bit for bit");
    add_examples(*command, {{"raya verify", "Run the default checks and print a line for each check"},
                            {"raya verify --brief --only number --report verify.json",
                             "Run only the brief checks of arithmetic, and write a report"}});
    const auto options = std::make_shared<VerifyCommand>();
    OptionGroup group(*command, "Checks");
    command->add_flag("--quick", options->quick,
                      "Check with the device's default lanes, common formats and images (the default depth)");
    command->add_flag("--brief", options->brief,
                      "Few kernels with few rays: for simulators, and for compilers that take a minute for a kernel");
    command->add_flag(
        "--full", options->full,
        "All formats, lanes and group sizes: about five minutes with PoCL on an idle CPU, longer if the compiler is "
        "slow on wide vectors");
    add_value(
        *command, "--lanes V", options->checks.lanes,
        "Check only this number of lanes, for compilers that are slow on wide vectors; if not given: the device's "
        "default number of lanes, or with --full, every number of lanes")
        ->check(CLI::IsMember({1, 4, 8, 16}));
    add_value(*command, "--only TEXT", options->checks.only,
              "Run only checks whose ID contains this text: number, image.glass, spa22, ...; * stands for any text");
    add_value(*command, "--skip TEXT", options->checks.skip, "Run no check whose ID contains this text, as for --only");
    command->add_flag("--list", options->list, "Print the IDs of the selected checks, and run none");
    add_value(*command, "--gtest_filter TEXT", options->checks.filter,
              "As GoogleTest: run the checks that one of these patterns matches, separated by \":\", and none of those "
              "after \"-\"; print lines such as [       OK ]");
    command->add_flag("--gtest_list_tests", options->gtest_list, "As --list, in the form of GoogleTest");
    in_range(add_value(*command, "--repeat N", options->checks.repeat,
                       "Number of runs of each check; it fails if one of them fails"),
             1, 1e6);
    in_range(add_value(*command, "--random N", options->checks.random,
                       "Run N random kernels, whose exact results raya computes on the host, instead of the checks"),
             1, 1e9);
    in_range(add_value(*command, "--soak TIME", options->checks.soak_s,
                       "Run random checks with random lanes, and random kernels, for this time, such as 60s, 30m, 2h; "
                       "print only failures"),
             0, 1e6, "seconds")
        ->transform(CLI::AsNumberWithUnit(std::map<std::string, double>{{"s", 1}, {"m", 60}, {"h", 3600}}));
    add_value(*command, "--seed N", options->checks.seed,
              "Seed of --random and --soak: the same seed gives the same kernels and checks")
        ->default_str("1");
    add_value(*command, "--shard I/N", options->shard,
              "Run the I-th of N parts of the selected checks, to divide them over N jobs");
    in_range(add_value(*command, "--timeout S", options->checks.timeout_s,
                       "Seconds after which a check counts as failed and its process is ended, builds included; 0: "
                       "never"),
             0, 1e6, "seconds")
        ->capture_default_str();
    add_file(
        *command, FileUse::kRead, "--expect FILE", options->expect,
        "Checks that are known to fail, one on each line: PATTERN | REASON | LINK, with a pattern as for --only. Their "
        "failures do not count; if one passes, the exit code is 4");
    add_device_option(*command, options->device);
    command->get_option("--device")
        ->description(command->get_option("--device")->get_description() + "; all: every usable device, in turn");
    group.next(kKernels);
    add_kernel_source_options(*command, options->kernel_dir);
    group.next(kDiagnostics);
    add_file(*command, FileUse::kWritten, "--report FILE.json", options->report,
             "Write all checks and their failures as JSON; -: stdout; the lines about the checks then go to stderr");
    add_file(*command, FileUse::kWritten, "--junit FILE.xml", options->junit, "Write the results as JUnit XML");
    add_file(*command, FileUse::kWritten, "--conformance FILE.json", options->conformance,
             "Write \"pass\", \"fail\" or \"skip\" of each check as the OpenCL conformance tests do; default: the "
             "variable CL_CONFORMANCE_RESULTS_FILENAME")
        ->envname("CL_CONFORMANCE_RESULTS_FILENAME");
    add_file(
        *command, FileUse::kWrittenFolder, "--reproduce DIR", options->reproduce,
        "If a check fails: write the kernel launch that computes wrong words as a self-contained case, a C program "
        "with kernel, inputs and expected words, into this new folder");
    add_file(*command, FileUse::kWritten, "--page FILE.html", options->page,
             "Write all checks, and the first failure in full, as an HTML page; raya page makes the same page from a "
             "report");
    command->callback([options] { run_verify(*options); });
}

}  // namespace raya
