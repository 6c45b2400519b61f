#pragma once
#include <map>
#include <string>
#include <vector>

#include "host/base/json.hpp"
#include "host/base/log.hpp"
#include "host/cli/render_command.hpp"
#include "host/verify/render_case.hpp"
#include "host/verify/supervisor.hpp"
#include "host/verify/verify.hpp"

namespace raya {

// Output of `raya verify`: lines on the terminal, and the JSON report.

// Results of a soak test (verify_at_random()): which checks failed, when, how often, and with which first wrong word.

class SoakCounts {
  public:
    /// Counts a check that has ended `seconds` after the start. Returns the lines to print: none if the check has
    /// passed; its details only for the first failure of the check.
    std::string add(const Check& check, double seconds);

    /// Returns a line for each check that has failed, such as "machine bus: failed 2 of 31 times, first after 12.3 s; 2
    /// times with the same first wrong word: ...".
    std::string summary() const;

  private:
    struct Count {
        std::size_t runs = 0, failures = 0;
        std::size_t repeats = 0;  // number of failures that equal the first one
        double first_s = 0;
        std::string first_wrong{};  // place, expected and actual bits of the first failure
    };
    std::map<std::string, Count> counts_;  // by "LAYER NAME"
};

/// Prints the checks of one device. In a soak test, prints only failures.
class DeviceOutput {
  public:
    /// `settings` must outlive this object. `index`: number of the device among those that --device selects.
    DeviceOutput(const VerifySettings& settings, std::size_t index);

    // The callbacks of SupervisorSink.
    void device(const DeviceChecks& device, const std::vector<std::string>& unusable_devices, std::size_t devices);
    void running(const std::string& layer, const std::string& name, double seconds) const;
    void finished(const Check& check);

    /// Prints the counts after the last check.
    void ended(const DeviceChecks& all) const;

  private:
    bool soaks() const { return settings_.soak_s > 0; }

    const VerifySettings& settings_;
    std::size_t index_ = 0, device_count_ = 1;
    Clock::time_point start_ = Clock::now();
    SoakCounts counts_;
    std::string prefix_;  // the device's name, if several soak tests run at once
};

/// Prints the counts of several devices.
void print_device_totals(const std::vector<DeviceChecks>& device_checks);

/// The report of --report.
struct VerifyReport {
    Depth depth = Depth::kQuick;
    std::string as;  // VerifySettings::as
    std::vector<DeviceChecks> devices;
};
void members_of(Members& m, const VerifyReport& report);

// The option --as of `raya verify`: a render command, parsed like that of `raya render`.

/// Returns the render of such a command: reads its scene, and loads the values of raya tune unless the command has
/// --no-tuned. Throws UserError like `raya render`.
RenderCase render_case(const std::string& text);

}  // namespace raya
