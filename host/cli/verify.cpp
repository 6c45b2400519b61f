// raya verify: is this device, with its driver and its compiler, right?
#include "host/verify/verify.hpp"

#include <fmt/core.h>

#include <cstdio>
#include <memory>

#include "host/base/json.hpp"
#include "host/base/say.hpp"
#include "host/base/whole_file.hpp"
#include "host/cli/command_tree.hpp"
#include "host/cli/commands.hpp"
#include "host/cli/file_options.hpp"
#include "host/cli/options.hpp"
#include "host/cli/page.hpp"
#include "host/cli/parse.hpp"
#include "host/cli/scene_input.hpp"
#include "host/error.hpp"
#include "host/model/unit_text.hpp"
#include "host/verify/supervisor.hpp"
#include "host/version.hpp"

namespace raya {
namespace {

struct VerifyCommand {
    std::string device, report, page, kernel_dir, only;
    std::uint32_t lanes = 0;
    bool brief = false, quick = false, full = false;

    Depth depth() const { return full ? Depth::kFull : brief ? Depth::kBrief : Depth::kQuick; }
};

// "57 checks passed, 0 failed, 2 skipped in 12.3 s"
std::string closing_text(const std::vector<Check>& checks, double seconds) {
    return fmt::format("{} passed, {} failed, {} skipped in {:.1f} s",
                       counted(count_of(checks, Outcome::kPass), "check"), count_of(checks, Outcome::kFail),
                       count_of(checks, Outcome::kSkip), seconds);
}

DeviceChecks verify_one(const VerifyCommand& command, std::size_t index, const VerifySettings& settings,
                        std::size_t& devices) {
    const bool brief = is_quiet(), shows = shows_progress();
    const auto print = [&](const std::string& line) {
        clear_status();
        fmt::print("{}", line);
        std::fflush(stdout);
    };
    const SupervisorSink sink{
        .device =
            [&](const DeviceChecks& device, const std::vector<std::string>& left_out) {
                if (brief) return;
                if (index == 0)
                    for (const std::string& line : left_out) print(line + "\n");
                print(fmt::format("{} ({}, driver {})\n", device.name, device.platform, device.driver));
            },
        .running =
            [&](const std::string& layer, const std::string& name, double seconds) {
                if (shows) show_status(fmt::format("running {} {} ... {:.0f} s", layer, name, seconds));
            },
        .finished =
            [&](const Check& check) {
                if (!brief || check.verdict.outcome == Outcome::kFail) print(check_lines(check));
            }};
    DeviceChecks result = supervise(command.device, index, settings, sink, devices);
    if (!brief || devices == 1 || !result.is_right())
        print(fmt::format("{}: {}\n", result.name, closing_text(result.checks, result.seconds)));
    return result;
}

Json report_of(const std::vector<DeviceChecks>& all, Depth depth) {
    Json devices = Json::list();
    for (const DeviceChecks& one : all) {
        Json checks = Json::list();
        for (const Check& check : one.checks) checks.push_back(to_json(check));
        devices.push_back({{"name", one.name},
                           {"platform", one.platform},
                           {"version", one.version},
                           {"driver", one.driver},
                           {"right", one.is_right()},
                           {"passed", count_of(one.checks, Outcome::kPass)},
                           {"failed", count_of(one.checks, Outcome::kFail)},
                           {"skipped", count_of(one.checks, Outcome::kSkip)},
                           {"seconds", one.seconds},
                           {"checks", checks}});
    }
    return {{"kind", kVerifyReportKind},
            {"program", name_and_version()},
            {"depth", depth_name(depth)},
            {"devices", devices}};
}

void print_overall(const std::vector<DeviceChecks>& all) {
    std::vector<Check> checks;
    double seconds = 0;
    for (const DeviceChecks& one : all) {
        checks.insert(checks.end(), one.checks.begin(), one.checks.end());
        seconds += one.seconds;
    }
    fmt::print("{}: {}\n", counted(all.size(), "device"), closing_text(checks, seconds));
}

void run_verify(const VerifyCommand& command) {
    if (command.brief + command.quick + command.full > 1) throw UserError("--brief, --quick, --full: give one of them");
    if (!command.page.empty()) check_page_name("--page", command.page);
    Warnings warnings;
    warn_of_build_options(warnings);
    const VerifySettings settings{
        .depth = command.depth(), .sources = {command.kernel_dir}, .only = command.only, .lanes = command.lanes};
    std::vector<DeviceChecks> all;
    bool right = true;
    for (std::size_t devices = 1; all.size() < devices;) {
        all.push_back(verify_one(command, all.size(), settings, devices));
        right = right && all.back().is_right();
    }
    if (all.size() > 1) print_overall(all);
    write_report_and_page({command.report, command.page}, report_of(all, command.depth()));
    if (!right) throw CheckFailure{};
}

}  // namespace

void add_verify_command(CLI::App& program) {
    CLI::App* command = program.add_subcommand(
        "verify", "Check a device, its driver and its compiler: arithmetic, hits, machines and images, all by bits");
    add_examples(*command, {{"raya verify", "All that matters of this device, a line for each check"},
                            {"raya verify --brief --only number --report verify.json",
                             "Few of the checks, those of arithmetic, and what was found as JSON"}});
    const auto options = std::make_shared<VerifyCommand>();
    OptionGroup group(*command, "What is checked");
    command->add_flag("--quick", options->quick,
                      "The device's own lanes, the usual formats, a dozen images: the default");
    command->add_flag("--brief", options->brief,
                      "What few kernels show, with few rays: for compilers that take a minute for a kernel, and for "
                      "simulators");
    command->add_flag(
        "--full", options->full,
        "Every format, width of lanes and group size: about five minutes with PoCL on an idle CPU, longer where "
        "compilers are slow on wide vectors");
    add_value(*command, "--lanes", options->lanes,
              "This width of lanes alone, for compilers that are slow on wide vectors; default: the device's "
              "own, with --full all")
        ->check(CLI::IsMember({1, 4, 8, 16}))
        ->type_name("V");
    add_value(*command, "--only", options->only,
              "Only checks with this text in \"LAYER NAME\", as printed: number, \"image glass\", spa22, ...")
        ->type_name("TEXT");
    add_device_option(*command, options->device);
    command->get_option("--device")
        ->description(command->get_option("--device")->get_description() +
                      "; all: every usable device, one after another");
    group.next(kKernels);
    add_file(*command, FileUse::kKernelFolder, "--kernel-dir", options->kernel_dir, "DIR",
             "Read the kernels from this folder, while developing them");
    group.next(kCloserLook);
    add_file(*command, FileUse::kWritten, "--report", options->report, "FILE.json",
             "Write every check, with what is wrong, as JSON; -: stdout, and the lines on stderr");
    add_file(*command, FileUse::kWritten, "--page", options->page, "FILE.html",
             "Write every check, and the first that failed in full, as a page for a browser; it is what raya page "
             "makes of the report");
    command->callback([options] { run_verify(*options); });
}

}  // namespace raya
