// Output of `raya verify`: lines on the terminal, and the JSON report.
#pragma once
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "host/base/clock.hpp"
#include "host/base/json.hpp"
#include "host/verify/soak.hpp"
#include "host/verify/supervisor.hpp"

namespace raya {

using PrintLines = std::function<void(const std::string& lines)>;

/// Prints the checks of one device. In a soak test, prints only failures.
class DeviceOutput {
  public:
    /// `settings` must outlive this object. `index`: number of the device among those that --device selects.
    DeviceOutput(const VerifySettings& settings, std::size_t index);

    /// For a rank among several: prints only failures and the counts, with `print`.
    DeviceOutput(const VerifySettings& settings, PrintLines print)
        : settings_(settings), print_(std::move(print)), of_rank_(true) {}

    // The callbacks of SupervisorSink.
    void device(const DeviceChecks& device, const std::vector<std::string>& unusable_devices, std::size_t devices);
    void running(const std::string& layer, const std::string& name, double seconds) const;
    void finished(const Check& check);

    /// Prints the counts after the last check.
    void ended(const DeviceChecks& all) const;

  private:
    bool soaks() const { return settings_.soak_s > 0; }

    const VerifySettings& settings_;
    PrintLines print_;
    bool of_rank_ = false;
    std::size_t index_ = 0, device_count_ = 1;
    Clock::time_point start_ = Clock::now();
    SoakCounts counts_;
    std::string prefix_;  // the device's name, if several soak tests run at once
};

/// Prints the counts of several devices.
void print_device_totals(const std::vector<DeviceChecks>& device_checks);

/// Returns the report of --report (docs/report.md).
Json verify_report(const std::vector<DeviceChecks>& device_checks, const VerifySettings& settings);

}  // namespace raya
