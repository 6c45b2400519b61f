// Checks of a device with its driver and compiler against known answers, from the number layer up to whole images.
#pragma once
#include <functional>
#include <string>
#include <vector>

#include "host/base/json.hpp"
#include "host/cl/commands.hpp"
#include "host/cl/device.hpp"
#include "host/cl/kernels.hpp"
#include "host/verify/verdict.hpp"

namespace raya {

/// "PASS", "FAIL", "SKIP".
const char* outcome_name(Outcome outcome);

struct Check {
    std::string layer, name;  // "number", "e6m15, 16 lanes"
    double seconds = 0;       // wall-clock time
    Verdict verdict;
};

/// Runs and times `body`. An exception becomes a failed check with its message, so that the remaining checks run:
/// drivers reject kernels, and with wrong arithmetic the torus may lose packets, which it reports as an internal error.
Check run_check(const std::string& layer, const std::string& name, const std::function<Verdict()>& body);

/// Remedies for errors of the compiler or driver, except those that this run already applies.
std::vector<std::string> compiler_remedies();

/// Number of checks with this outcome.
std::size_t count_of(const std::vector<Check>& checks, Outcome outcome);

/// "PASS  number    e6m15, 16 lanes  0.41 s  310 answers"; a failure adds indented lines with its details.
std::string check_lines(const Check& check);

/// An object with layer, name, status, seconds and result; a failure also has where, expected, got, build_options and
/// remedies.
Json to_json(const Check& check);

/// Inverse of to_json(Check).
Check check_of(const Json& json);

enum class Depth {
    kBrief,  // few kernels and few rays: for simulators, and for compilers that take a minute a kernel
    kQuick,  // one number of lanes, the common formats, a dozen images: seconds
    kFull    // every format, number of lanes and group size: minutes
};

/// Member "kind" of a report, which identifies it.
inline constexpr const char* kVerifyReportKind = "raya verify";

/// "quick"
const char* depth_name(Depth depth);

struct VerifySettings {
    Depth depth = Depth::kQuick;
    KernelSources sources{};
    std::string only{};       // run only checks whose "LAYER NAME" contains this text; empty: all
    std::uint32_t lanes = 0;  // the only number of lanes: 1, 4, 8 or 16; 0: the device's default, with kFull all
    std::size_t done = 0;     // skip this many checks at the beginning
};

/// Callbacks at the start (layer, name) and at the end of every check.
struct CheckSink {
    std::function<void(const std::string&, const std::string&)> started{};
    std::function<void(const Check&)> finished{};
};

/// Checks `device` layer by layer, from the number layer to the images, so that the first failure is nearest to the
/// cause. Throws DeviceError if the device's properties cannot be read, std::logic_error for patches that do not apply.
std::vector<Check> verify(const cl::Device& device, const VerifySettings& settings, const CheckSink& sink = {});

/// "LAYER NAME" of every check that verify() would run, in the same order.
std::vector<std::string> check_names(const cl::Device& device, const VerifySettings& settings);

/// Device, settings and results of a run; the layers register their checks with check().
class Verification {
  public:
    /// `runs`: run the checks; false: only collect their names.
    Verification(const cl::Device& device, const VerifySettings& settings, const CheckSink& sink, bool runs = true);

    const DeviceInfo& device() const { return info_; }
    Depth depth() const { return settings_.depth; }
    bool full() const { return depth() == Depth::kFull; }

    /// Runs one check in its own session: a failed command may make a context unusable.
    void check(const std::string& layer, const std::string& name, const std::function<Verdict(Session&)>& body);

    const KernelSources& sources() const { return settings_.sources; }
    /// Sources and options of a renderer's kernels; 0 lanes: given_lanes().
    KernelChoice kernels(std::uint32_t lanes, std::uint32_t group_size) const;

    /// VerifySettings::lanes: the only number of lanes to check, 0: not set.
    std::uint32_t given_lanes() const { return settings_.lanes; }
    /// given_lanes(), or the device's default.
    std::uint32_t own_lanes() const { return settings_.lanes ? settings_.lanes : default_lanes(info_); }
    /// Every number of lanes to check.
    std::vector<std::uint32_t> lanes() const;

    /// Remedies for failures that may depend on the number of lanes; empty for one lane.
    std::vector<std::string> lanes_remedies(std::uint32_t lanes) const;

    std::vector<Check> take_checks() { return std::move(checks_); }
    std::vector<std::string> take_names() { return std::move(names_); }

  private:
    cl::Device device_;
    DeviceInfo info_;
    VerifySettings settings_;
    CheckSink sink_;
    bool runs_;
    std::vector<Check> checks_;
    std::vector<std::string> names_;  // of checks_ and of the skipped settings_.done before them
};

// The layers; each relies on those before it.
void verify_numbers(Verification& verification);
void verify_geometry(Verification& verification);
void verify_machines(Verification& verification);
void verify_images(Verification& verification);

}  // namespace raya
