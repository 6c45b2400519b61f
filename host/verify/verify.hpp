// Is this device, with its driver and its compiler, right? Known answers from the number layer up to whole images;
// each check measured, with what came of it.
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
    double seconds = 0;       // measured
    Verdict verdict;
};

/// Runs `body` and measures it. What it throws is a check that failed with that message, not the end of the others:
/// drivers refuse, and a machine whose arithmetic is wrong may lose packets, which the torus reports as a fault of
/// ours.
Check run_check(const std::string& layer, const std::string& name, const std::function<Verdict()>& body);

/// What to try where the compiler or the driver may be at fault, without what is tried already.
std::vector<std::string> compiler_remedies();

/// How many of `checks` ended so.
std::size_t count_of(const std::vector<Check>& checks, Outcome outcome);

/// "PASS  number    e6m15, 16 lanes  310 answers  0.41 s", and indented lines for a fault.
std::string check_lines(const Check& check);

/// An object with layer, name, status, seconds and told; of a failure also where, expected, got, build_options and
/// remedies.
Json to_json(const Check& check);

/// The inverse.
Check check_of(const Json& json);

enum class Depth {
    kBrief,  // of kQuick what few kernels and few rays show: for simulators, and compilers that take a minute a kernel
    kQuick,  // one width of lanes, the usual formats, a dozen images: seconds
    kFull    // every format, lanes and group size: minutes
};

/// By which a report is known again: its member "kind".
inline constexpr const char* kVerifyReportKind = "raya verify";

/// "quick"
const char* depth_name(Depth depth);

struct VerifySettings {
    Depth depth = Depth::kQuick;
    KernelSources sources{};  // of the kernels
    std::string only{};       // checks with this in "LAYER NAME" alone; empty: all
    std::uint32_t lanes = 0;  // this width alone, 1, 4, 8 or 16; 0: the device's own, with kFull all
    std::size_t done = 0;     // so many checks, the first ones, are left out
};

/// Is told of every check as it begins, by layer and name, and as it ends.
struct CheckSink {
    std::function<void(const std::string&, const std::string&)> started{};
    std::function<void(const Check&)> finished{};
};

/// Checks `device` from the number layer to the images, layer by layer, so that the first failure is nearest to the
/// fault. DeviceError if the device says nothing of itself; std::logic_error for patches that do not fit.
std::vector<Check> verify(const cl::Device& device, const VerifySettings& settings, const CheckSink& sink = {});

/// "LAYER NAME" of every check that verify() would run, in their order.
std::vector<std::string> check_names(const cl::Device& device, const VerifySettings& settings);

/// What the layers' checks have in common: the device, the depth, and how a check is run.
class Verification {
  public:
    /// `runs`: checks are run; else they are named alone.
    Verification(const cl::Device& device, const VerifySettings& settings, const CheckSink& sink, bool runs = true);

    const DeviceInfo& device() const { return info_; }
    Depth depth() const { return settings_.depth; }
    bool full() const { return depth() == Depth::kFull; }

    /// Runs one check in a session of its own: a failed command may leave a context of no use.
    void check(const std::string& layer, const std::string& name, const std::function<Verdict(Session&)>& body);

    const KernelSources& sources() const { return settings_.sources; }
    /// The same for a renderer's kernels.
    KernelChoice kernels(std::uint32_t lanes, std::uint32_t group_size) const;

    /// The only width of lanes to try; 0: none is given.
    std::uint32_t given_lanes() const { return settings_.lanes; }
    /// Lanes that are asked for, or the device's own.
    std::uint32_t own_lanes() const { return settings_.lanes ? settings_.lanes : default_lanes(info_); }
    /// All widths of lanes to try.
    std::vector<std::uint32_t> lanes() const;

    /// What to try where a width of lanes may be at fault; nothing where that has been tried.
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
    std::vector<std::string> names_;  // of those and of settings_.done before them
};

// The layers, in the order in which they rest on each other.
void verify_numbers(Verification& verification);
void verify_geometry(Verification& verification);
void verify_machines(Verification& verification);
void verify_images(Verification& verification);

}  // namespace raya
