// Self-contained case of a failed check: one kernel with its inputs and correct outputs, and a C program that runs it
// (host/verify/case/).
#pragma once
#include <cstddef>
#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "host/verify/supervisor.hpp"

namespace raya {

// Repeats one check in a child process with other settings, to find the cause of its failure.

/// How to run a check.
struct CheckRun {
    std::string name;                                  // for people: "-cl-opt-disable"
    std::string selector;                              // of the device, as in choose_device()
    VerifySettings settings;                           // select one check
    std::map<std::string, std::string> environment{};  // variables of the child process
};

/// A build or a launch of a run; see Capture (host/cl/capture.hpp).
struct Step {
    std::string name;
    bool done = false;
    std::map<std::string, std::string> outputs{};  // hashes by argument
};

/// One run of a check.
struct Observation {
    std::vector<Step> steps;   // steps[n - 1] is step n
    std::size_t expected = 0;  // step of which the check gave the correct words; 0: none
    bool passed = false;
};

/// Runs the check of `run`. Captures step number `step`, if not 0, in `folder`. Ends the run after
/// settings.timeout_s, or, if `ends_at_step`, when the inputs of the step have been captured.
Observation observe(const CheckRun& run, std::size_t step = 0, const std::filesystem::path& folder = {},
                    bool ends_at_step = false);

/// Searches for a smallest set of changes with which the failed check `full_name` passes: build options, macros of the
/// kernels, and for PoCL its environment variables. Runs the check a few times for each change of the result, by the
/// QuickXplain algorithm (Junker 2004), which assumes that more changes never make a passing check fail. Calls `print`
/// with a line after each run, such as "PASS  RAYA_BUILD_OPTIONS=-cl-opt-disable", and at the end with the result. Each
/// run has an empty cache of PoCL, because PoCL's variables are not part of the cache's keys. `selector` selects the
/// device, as in choose_device().
void bisect(const std::string& selector, const DeviceChecks& device, const VerifySettings& settings,
            const std::string& full_name, const std::function<void(const std::string& line)>& print);

// The files of a self-contained case of a failed check.

/// Writes a case of the failed check `check` into the folder `folder`, which must not exist or be empty. `selector`
/// selects the device, as in choose_device().
///
/// Finds the first kernel launch with wrong results: the check gives the correct words of its launch, or the check is
/// repeated with a reference that passes, and the first launch whose outputs differ is the wrong one. The reference is
/// the first that passes of: raya's own kernels instead of settings.sources.folder; -cl-opt-disable; another device of
/// this computer. If a build or launch failed, crashed or did not end, the case is that build or launch.
///
/// Returns the lines that describe the case. Throws UserError if `folder` is not empty or no case could be made.
std::string reproduce(const std::string& selector, const DeviceChecks& device, const VerifySettings& settings,
                      const Check& check, const std::filesystem::path& folder);

/// Throws UserError if `folder` exists and is not an empty folder, or cannot be made. Makes its parent folders.
void check_case_folder(const std::filesystem::path& folder);

}  // namespace raya
