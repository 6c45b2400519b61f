// Checks of a device, its driver and its compiler: computes numbers, intersections, transfers and images on the device
// and compares them with known results.
#pragma once
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "host/base/members.hpp"
#include "host/cl/commands.hpp"
#include "host/cl/device.hpp"
#include "host/cl/kernel_options.hpp"
#include "host/verify/verdict.hpp"

namespace raya {

/// Returns "PASS", "FAIL", "SKIP", "XFAIL" or "XPASS".
const char* outcome_name(Outcome outcome);

struct Check {
    std::string layer;   // "number"
    std::string name;    // "e6m15"
    double seconds = 0;  // wall-clock time
    Verdict verdict;

    /// Returns the check's ID, such as "number.e6m15", of the characters [a-z0-9_.]. It is the same on every device.
    std::string id() const { return layer + "." + name; }
};

/// Runs and times `body`. If `body` throws, the returned check has failed with the exception's message, so that the
/// remaining checks still run. Examples: a driver rejects a kernel; the torus loses packets because of wrong arithmetic
/// and reports an internal error.
Check run_check(const std::string& layer, const std::string& name, const std::function<Verdict()>& body);

std::size_t count_of(const std::vector<Check>& checks, Outcome outcome);

/// Returns a line such as "PASS  number.e6m15  0.41 s  310 answers"; for a failure, indented lines with
/// its details follow.
std::string check_lines(const Check& check);

/// Lists the members of a check, for to_json(), schema_of() and from_json().
void members_of(Members& m, Check& check);

enum class Depth {
    kBrief,  // few kernels and rays: for simulated devices, and for compilers that take a minute per kernel
    kQuick,  // one number of lanes, common formats, 15 renderings: takes seconds
    kFull    // every format, every number of lanes, several group sizes: takes minutes
};

/// Value of the member "kind", which identifies the report.
inline constexpr const char* kVerifyReportKind = "raya verify";

/// Returns text such as "quick".
const char* depth_name(Depth depth);

/// Returns true if the ID of a check contains `pattern`, in which * stands for any text, and each run of other
/// characters than letters and digits for any such run.
bool id_matches(const std::string& id, const std::string& pattern);

/// Returns true if GoogleTest's --gtest_filter selects the ID: patterns separated by ":", in which * stands for any
/// text and ? for any character, and after "-" the patterns of IDs that are left out.
bool passes_filter(const std::string& id, const std::string& filter);

/// A check that is known to fail.
struct ExpectedFailure {
    std::string place;                  // "FILE:LINE"
    std::string pattern, reason, link;  // pattern: see id_matches()
};

/// Changes the outcome of a check that is expected to fail: a failure becomes kExpectedFail, a pass kUnexpectedPass.
void apply_expectations(Check& check, const std::vector<ExpectedFailure>& expected_failures);

struct VerifySettings {
    Depth depth = Depth::kQuick;
    KernelSources sources{};
    std::string filter{};                 // run only checks whose ID passes (passes_filter()); empty: all
    std::string only{};                   // run only checks whose ID matches (id_matches()); empty: all
    std::string skip{};                   // run no check whose ID matches; empty: skip none
    std::uint32_t shard = 1, shards = 1;  // of the selected checks, run those with number modulo `shards` = shard - 1
    std::uint32_t repeat = 1;             // number of runs of each check; it fails if one of them fails
    double timeout_s = 0;                 // time after which supervise() ends a check; 0: never
    double soak_s = 0;                    // if not 0: verify() runs random checks with random lanes for so many seconds
    std::uint64_t seed = 1;               // of the choice of checks, and of random kernels
    std::uint32_t random = 0;             // if not 0: check instead the random kernels random_first..random - 1,
    std::uint32_t random_first = 0;       // each with the changes `random_changes`; see random_kernel()
    std::vector<std::size_t> random_changes{};
    std::function<std::string(const std::string&)> change_random{};  // changes the text of random kernels, for tests
    std::vector<ExpectedFailure> expected_failures{};  // supervise() changes the outcome of checks that match
    std::uint32_t lanes = 0;  // check only this number of lanes: 1, 4, 8 or 16; 0: the device's default; at
                              // Depth::kFull, all four numbers
    std::size_t done = 0;     // number of checks, from the first on, that are already done; verify() skips them
};

/// Returns remedies for a failed check, the most promising first.
std::vector<std::string> remedies_of(const Check& check, const VerifySettings& settings);

/// Callbacks: `started` is called with the layer and name of every check before it runs, `finished` after it has run.
struct CheckSink {
    std::function<void(const std::string&, const std::string&)> started{};
    std::function<void(const Check&)> finished{};
};

/// Checks `device` layer by layer, from the number layer to images, so that the first failure is the closest to the
/// cause. Throws DeviceError if the device's properties cannot be read, std::logic_error if a patch of the kernel
/// sources does not apply.
std::vector<Check> verify(const cl::Device& device, const VerifySettings& settings, const CheckSink& sink = {});

/// Returns the settings to run only the check with this ID, once.
VerifySettings settings_of_one(VerifySettings settings, const std::string& id);

/// Returns the ID of every check that verify() would run, in the same order.
std::vector<std::string> check_ids(const cl::Device& device, const VerifySettings& settings);

/// Build option with which kernels use no builtins of clang, but their fallback code.
inline constexpr const char* kNoBuiltins = "-DRAYA_BUILTINS=0";

/// Device, settings and results of a run of verify(). The functions below, one per layer, call check() for each check.
class Verification {
  public:
    /// `runs`: true to run the checks, false to collect only their IDs.
    Verification(const cl::Device& device, const VerifySettings& settings, const CheckSink& sink, bool runs = true);

    const DeviceInfo& device() const { return info_; }
    const VerifySettings& settings() const { return settings_; }
    bool full() const { return settings_.depth == Depth::kFull; }

    /// Runs one check in a new session, because a failed command may make an OpenCL context unusable. Skips it on a
    /// device that does not allow groups of `group_size` work-items. The check's ID is that of layer and name, in lower
    /// case, with _ for each run of other characters than letters and digits.
    void check(const std::string& layer, const std::string& name, const std::function<Verdict(Session&)>& body,
               std::uint32_t group_size = 1);

    /// Returns the sources and options of a renderer's kernels. If `lanes` is 0, the options have settings().lanes.
    KernelChoice kernels(std::uint32_t lanes, std::uint32_t group_size) const {
        return {.lanes = lanes ? lanes : settings_.lanes, .group_size = group_size, .sources = settings_.sources};
    }

    /// Returns settings().lanes if set, else the device's default.
    std::uint32_t lanes_or_default() const { return settings_.lanes ? settings_.lanes : default_lanes(info_); }
    /// Returns every number of lanes to check.
    std::vector<std::uint32_t> lanes() const;
    /// Returns the end of a check's name: ", 16 lanes"; "" if all checks have one number of lanes, because IDs do not
    /// depend on the device's.
    std::string lanes_text(std::uint32_t lanes_of_check) const;

    std::vector<Check> take_checks() { return std::move(checks_); }
    std::vector<std::string> take_ids() { return std::move(ids_); }

  private:
    cl::Device device_;
    DeviceInfo info_;
    VerifySettings settings_;
    CheckSink sink_;
    bool runs_;
    std::vector<Check> checks_;
    std::size_t selected_ = 0;      // number of checks that `filter`, `only` and `skip` select, in all shards
    std::vector<std::string> ids_;  // of all checks of this shard, including the `done` checks
};

// Run the checks of one layer. Each layer relies on the layers before it.
void verify_numbers(Verification& verification);
void verify_geometry(Verification& verification);
void verify_machines(Verification& verification);
void verify_images(Verification& verification);
/// Layer "random": random kernels (random_kernel.hpp) of the sequence settings().seed.
void verify_random(Verification& verification);

/// A copy of blocks between two buffers in which the blocks have different layouts.
struct BlockCopy {
    Session::Blocks from, to;         // layouts in source and destination
    std::size_t block_words, blocks;  // words to copy from the start of each block; number of blocks
};

/// Size of each of the two buffers of check_copies(), in words.
inline constexpr std::size_t kCopiedWords = 4096;

/// Checks that each copy is correct and does not change the other words of the destination.
Verdict check_copies(Session& session, const std::vector<BlockCopy>& copies);

/// Number of kernels in a check of layer "random".
inline constexpr std::uint32_t kRandomBatch = 25;

struct RandomKernel;
struct KernelResults;
/// Runs a random kernel with settings.change_random and settings.sources. Throws DeviceError.
KernelResults run_random_kernel(Session& session, const RandomKernel& kernel, const std::vector<std::uint32_t>& in,
                                const VerifySettings& settings);

// A device and the results of its checks, and their form in reports.

struct DeviceChecks {
    std::string name, platform, version, driver;
    std::string pci_address{};       // see DeviceInfo
    std::vector<std::string> ids{};  // of each check of Depth::kFull, selected or not; not in reports
    std::vector<Check> checks{};
    double seconds = 0;  // sum of the checks' times

    /// Returns true if checks ran and each had the expected outcome.
    bool all_passed() const {
        return count_of(checks, Outcome::kFail) + count_of(checks, Outcome::kUnexpectedPass) == 0 &&
               count_of(checks, Outcome::kPass) + count_of(checks, Outcome::kExpectedFail) > 0;
    }
};

/// Lists the members of a device, for to_json(), schema_of() and from_json().
void members_of(Members& m, DeviceChecks& device);

/// The report of `raya verify --report`.
struct VerifyReport {
    Depth depth = Depth::kQuick;
    std::vector<DeviceChecks> devices;
};
void members_of(Members& m, const VerifyReport& report);

// Files for continuous integration (CI): results of checks as JUnit XML, and the list of expected failures.

/// Reads a list of checks that are known to fail. A line has a pattern (id_matches()), a reason, and optionally a
/// link, separated by " | "; # starts a comment line. An empty path is an empty list. Throws UserError with file and
/// line.
std::vector<ExpectedFailure> read_expected_failures(const std::filesystem::path& path);

/// Returns a warning for each pattern that matches no check of any device, whether selected or not.
std::vector<std::string> unmatched_patterns(const std::vector<ExpectedFailure>& failures,
                                            const std::vector<DeviceChecks>& devices);

/// Returns the results of `command`, such as "raya verify", as JUnit XML: one test suite for each device, one test case
/// for each check. Expected failures are skipped test cases, unexpected passes are failures.
std::string junit_report(const std::string& command, const std::vector<DeviceChecks>& devices);

}  // namespace raya
