// A device and the results of its checks, and their form in reports.
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "host/base/json.hpp"
#include "host/cl/device_info.hpp"
#include "host/verify/verify.hpp"

namespace raya {

struct DeviceChecks {
    std::string name, platform, version, driver;
    std::string pci_address{};            // see DeviceInfo
    std::optional<std::uint32_t> rank{};  // with several ranks: the rank that checked its device
    std::string host{};                   // with several ranks: the rank's host
    std::vector<std::string> names{};     // "LAYER NAME" of each check of Depth::kFull, selected or not; not in reports
    std::vector<Check> checks{};
    double seconds = 0;  // sum of the checks' times

    /// Returns the device's name; with several ranks, "rank 2 on node7: NAME, PCI 0000:3b:00.0".
    std::string title() const;

    /// Returns true if checks ran and each had the expected outcome.
    bool all_passed() const {
        return count_of(checks, Outcome::kFail) + count_of(checks, Outcome::kUnexpectedPass) == 0 &&
               count_of(checks, Outcome::kPass) + count_of(checks, Outcome::kExpectedFail) > 0;
    }
};

/// Returns the properties of a device, without checks.
DeviceChecks device_checks_of(const DeviceInfo& info);

/// Returns the device's object in the report of `raya verify`; device_checks_of() is the inverse.
Json to_json(const DeviceChecks& device);
DeviceChecks device_checks_of(const Json& json);

}  // namespace raya
