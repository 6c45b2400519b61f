// Files for continuous integration (CI): results of checks as JUnit XML and as TAP, and the list of expected failures.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "host/verify/supervisor.hpp"

namespace raya {

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
