// Output of `raya verify`: lines on the terminal, and the JSON report.
#pragma once
#include <string>
#include <vector>

#include "host/base/clock.hpp"
#include "host/base/json.hpp"
#include "host/verify/soak.hpp"
#include "host/verify/supervisor.hpp"

namespace raya {

/// Prints the checks of one device. In a soak test, prints only failures.
class DeviceOutput {
  public:
    /// `settings` must outlive this object. `index`: number of the device among those that --device selects.
    DeviceOutput(const VerifySettings& settings, std::size_t index) : settings_(settings), index_(index) {}

    // The callbacks of SupervisorSink.
    void device(const DeviceChecks& device, const std::vector<std::string>& unusable_devices, std::size_t devices);
    void running(const std::string& layer, const std::string& name, double seconds) const;
    void finished(const Check& check);

    /// Prints the counts after the last check.
    void ended(const DeviceChecks& all) const;

  private:
    bool soaks() const { return settings_.soak_s > 0; }

    const VerifySettings& settings_;
    std::size_t index_, device_count_ = 1;
    Clock::time_point start_ = Clock::now();
    SoakCounts counts_;
    std::string prefix_;  // the device's name, if several soak tests run at once
};

/// Prints the counts of several devices.
void print_device_totals(const std::vector<DeviceChecks>& device_checks);

/// Returns the report of --report (docs/report.md).
Json verify_report(const std::vector<DeviceChecks>& device_checks, const VerifySettings& settings);

}  // namespace raya
