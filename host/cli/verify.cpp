// raya verify: is this device, with its driver and its compiler, right?
#include "verify/verify.hpp"

#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>

#include "cli/commands.hpp"
#include "cli/parse.hpp"
#include "error.hpp"
#include "report/whole_file.hpp"

namespace raya {
namespace {

struct VerifyCommand {
    std::string device, report, kernel_dir, only, breakage;
    std::uint32_t lanes = 0;
    bool quick = false, full = false;
};

// What came of one device.
struct DeviceChecks {
    DeviceInfo device;
    std::vector<Check> checks;
    double seconds = 0;

    bool is_right() const { return count_of(checks, Outcome::kFail) == 0 && count_of(checks, Outcome::kPass) > 0; }
};

// "57 checks passed, 0 failed, 2 skipped in 12.3 s"
std::string closing_text(const std::vector<Check>& checks, double seconds) {
    return fmt::format("{} checks passed, {} failed, {} skipped in {:.1f} s", count_of(checks, Outcome::kPass),
                       count_of(checks, Outcome::kFail), count_of(checks, Outcome::kSkip), seconds);
}

DeviceChecks verify_one(const cl::Device& device, const VerifySettings& settings) {
    DeviceChecks result;
    result.device = device_info(device);
    fmt::print("{} ({}, driver {})\n", result.device.name, result.device.platform, result.device.driver);
    result.checks = verify(device, settings, [&](const Check& check) {
        result.seconds += check.seconds;
        fmt::print("{}", check_lines(check));
        std::fflush(stdout);
    });
    fmt::print("{}: {}\n", result.device.name, closing_text(result.checks, result.seconds));
    return result;
}

std::vector<cl::Device> devices_of(const std::string& wanted) {
    if (wanted != "all") return {choose_device(wanted)};
    std::vector<cl::Device> usable;
    for (const cl::Device& device : all_devices()) {
        const DeviceInfo info = device_info(device);
        if (info.available && info.compiler_available)
            usable.push_back(device);
        else
            fmt::print("{} ({}): not available, or without a compiler; left out\n", info.name, info.platform);
    }
    if (usable.empty()) choose_device("");  // throws, with the remedy
    return usable;
}

nlohmann::ordered_json report_of(const std::vector<DeviceChecks>& all, bool full) {
    nlohmann::ordered_json devices = nlohmann::ordered_json::array();
    for (const DeviceChecks& one : all) {
        nlohmann::ordered_json checks = nlohmann::ordered_json::array();
        for (const Check& check : one.checks) checks.push_back(to_json(check));
        devices.push_back({{"name", one.device.name},
                           {"platform", one.device.platform},
                           {"version", one.device.version},
                           {"driver", one.device.driver},
                           {"right", one.is_right()},
                           {"passed", count_of(one.checks, Outcome::kPass)},
                           {"failed", count_of(one.checks, Outcome::kFail)},
                           {"skipped", count_of(one.checks, Outcome::kSkip)},
                           {"seconds", one.seconds},
                           {"checks", checks}});
    }
    return {{"program", "raya " RAYA_VERSION}, {"depth", full ? "full" : "quick"}, {"devices", devices}};
}

void print_overall(const std::vector<DeviceChecks>& all) {
    std::vector<Check> checks;
    double seconds = 0;
    for (const DeviceChecks& one : all) {
        checks.insert(checks.end(), one.checks.begin(), one.checks.end());
        seconds += one.seconds;
    }
    fmt::print("{} devices: {}\n", all.size(), closing_text(checks, seconds));
}

void run_verify(const VerifyCommand& command) {
    if (command.quick && command.full) throw UserError("--quick and --full: leave one of them out");
    if (!command.report.empty()) check_writable(command.report);
    const VerifySettings settings{.depth = command.full ? Depth::kFull : Depth::kQuick,
                                  .breakage = breakage_named(command.breakage),
                                  .kernel_dir = command.kernel_dir,
                                  .only = command.only,
                                  .lanes = command.lanes};
    std::vector<DeviceChecks> all;
    bool right = true;
    for (const cl::Device& device : devices_of(command.device)) {
        all.push_back(verify_one(device, settings));
        right = right && all.back().is_right();
    }
    if (all.size() > 1) print_overall(all);
    if (!command.report.empty()) write_whole_file(command.report, report_of(all, command.full).dump(2) + "\n");
    if (!right) throw CheckFailure{};
}

}  // namespace

void add_verify_command(CLI::App& program) {
    CLI::App* command = program.add_subcommand(
        "verify", "Check a device, its driver and its compiler: arithmetic, hits, machines and images, all by bits");
    const auto options = std::make_shared<VerifyCommand>();
    add_device_option(*command, options->device);
    command->get_option("--device")
        ->description(command->get_option("--device")->get_description() +
                      "; all: every usable device, one after another");
    command->add_flag("--quick", options->quick,
                      "The device's own lanes, the usual formats, a dozen images: the default");
    command->add_flag("--full", options->full, "Every format, width of lanes and group size: some minutes");
    command->add_option("--report", options->report, "Write every check, with what is wrong, as JSON")
        ->type_name("FILE.json");
    command->add_option("--kernel-dir", options->kernel_dir, "Read the kernels from this folder, while developing them")
        ->type_name("DIR");
    command
        ->add_option("--lanes", options->lanes,
                     "This width of lanes alone, for compilers that are slow on wide vectors; default: the device's "
                     "own, with --full all")
        ->check(CLI::IsMember({1, 4, 8, 16}))
        ->type_name("V");
    command
        ->add_option("--only", options->only,
                     "Only checks with this text in \"LAYER NAME\", as printed: number, \"image glass\", spa22, ...")
        ->type_name("TEXT");
    // For the tests: makes checks fail on purpose, see verify/breakage.hpp. No group: not in the help.
    command->add_option("--break", options->breakage)->group("");
    refuse_odd_values(*command);
    command->callback([options] { run_verify(*options); });
}

}  // namespace raya
