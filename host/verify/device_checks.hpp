// A device and the results of its checks, and their form in reports.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "host/base/json.hpp"
#include "host/cl/device.hpp"
#include "host/verify/verify.hpp"

namespace raya {

struct DeviceChecks {
    std::string name, platform, version, driver;
    std::string pci_address{};         // see DeviceInfo
    std::vector<std::string> names{};  // "LAYER NAME" of each check of Depth::kFull, selected or not; not in reports
    std::vector<Check> checks{};
    double seconds = 0;  // sum of the checks' times

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

// Files for continuous integration (CI): results of checks as JUnit XML and as TAP, and the list of expected failures.

/// Reads a list of checks that are known to fail. A line has a pattern (name_matches()), a reason, and optionally a
/// link, separated by " | "; # starts a comment line. An empty path is an empty list. Throws UserError with file and
/// line.
std::vector<ExpectedFailure> read_expected_failures(const std::filesystem::path& path);

/// Returns a warning for each pattern that matches no check of any device, whether selected or not.
std::vector<std::string> unmatched_patterns(const std::vector<ExpectedFailure>& failures,
                                            const std::vector<DeviceChecks>& devices);

/// Returns the results of `command`, such as "raya verify", as JUnit XML: one test suite for each device, one test case
/// for each check. Expected failures are skipped test cases, unexpected passes are failures.
std::string junit_report(const std::string& command, const std::vector<DeviceChecks>& devices);

/// Returns the results in the Test Anything Protocol, version 14. Expected failures are TODO tests.
std::string tap_report(const std::vector<DeviceChecks>& devices);

}  // namespace raya
