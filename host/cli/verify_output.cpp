#include "host/cli/verify_output.hpp"

#include <fmt/core.h>

#include <cstdio>

#include "host/base/log.hpp"
#include "host/model/unit_text.hpp"
#include "host/version.hpp"

namespace raya {
namespace {

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

void print_now(const std::string& lines) {
    clear_status();
    fmt::print("{}", lines);
    std::fflush(stdout);
}

}  // namespace

DeviceOutput::DeviceOutput(const VerifySettings& settings, std::size_t index)
    : settings_(settings), print_(print_now), index_(index) {}

void DeviceOutput::device(const DeviceChecks& device, const std::vector<std::string>& unusable_devices,
                          std::size_t devices) {
    if (of_rank_) return;
    device_count_ = devices;
    if (soaks() && devices > 1) prefix_ = device.name + ": ";
    if (is_quiet()) return;
    if (index_ == 0)
        for (const std::string& line : unusable_devices) print_(line + "\n");
    print_(fmt::format("{} ({}, driver {})\n", device.name, device.platform, device.driver));
}

void DeviceOutput::running(const std::string& layer, const std::string& name, double seconds) const {
    if (shows_progress() && !of_rank_)
        show_status(fmt::format("{}running {} {} ... {:.0f} s", prefix_, layer, name, seconds));
}

void DeviceOutput::finished(const Check& check) {
    std::string lines;
    if (soaks())
        lines = counts_.add(check, seconds_since(start_));
    else if ((!is_quiet() && !of_rank_) || is_unwanted(check.verdict.outcome))
        lines = check_lines(check);
    if (!lines.empty()) print_(prefix_ + lines);
}

void DeviceOutput::ended(const DeviceChecks& all) const {
    std::string lines;
    if (soaks()) lines = fmt::format("{}random checks with --seed {}\n", counts_.summary(), settings_.seed);
    if (!is_quiet() || (device_count_ == 1 && !of_rank_) || !all.all_passed())
        lines +=
            fmt::format("{}{}: {}\n", all.name, of_rank_ && !all.pci_address.empty() ? ", PCI " + all.pci_address : "",
                        closing_text(all.checks, all.seconds));
    if (!lines.empty()) print_(lines);
}

void print_device_totals(const std::vector<DeviceChecks>& device_checks) {
    std::vector<Check> checks;
    double seconds = 0;
    for (const DeviceChecks& device : device_checks) {
        checks.insert(checks.end(), device.checks.begin(), device.checks.end());
        seconds += device.seconds;
    }
    fmt::print("{}: {}\n", counted(device_checks.size(), "device"), closing_text(checks, seconds));
}

Json verify_report(const std::vector<DeviceChecks>& device_checks, const VerifySettings& settings) {
    Json devices = Json::array();
    for (const DeviceChecks& device : device_checks) devices.push_back(to_json(device));
    Json report = {{"kind", kVerifyReportKind}, {"program", name_and_version()}, {"depth", depth_name(settings.depth)}};
    if (!settings.as.empty()) report["as"] = settings.as;
    report["devices"] = devices;
    return report;
}

}  // namespace raya
