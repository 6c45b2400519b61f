// Runs a device's checks in a child process, because a crash in a driver ends the process. After a crash another child
// process continues with the next check. The child writes one JSON object per line:
//
//     {"devices": N, "left_out": [TEXT, ...], "device": {...}, "ids": [...]}
//                           the first line: number of selected devices, a text for each unusable device, the device
//                           that is checked, as in reports but without checks, and the IDs of all its checks
//     {"started": {"layer": LAYER, "name": NAME}}    a check starts
//     {"check": {...}}      the check is done; the object is that of to_json() in verify.hpp
//     {"ended": true}       all checks are done
//     {"error": TEXT, "kind": "user" or "device" or "internal"}      the last line, if an exception ends the process
#pragma once
#include <cstddef>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "host/verify/verify.hpp"

namespace raya {

/// Callbacks of supervise().
struct SupervisorSink {
    /// Called before a device's first check. `left_out`: one line for each unusable device; `devices`: number of
    /// selected devices.
    std::function<void(const DeviceChecks&, const std::vector<std::string>& left_out, std::size_t devices)> device{};
    /// Called when a check starts, and then about once a second, with the check's ID and its run time in seconds; 0: it
    /// starts.
    std::function<void(const std::string& id, double seconds)> running{};
    /// Called after each check.
    std::function<void(const Check&)> finished{};
};

/// Checks the device that `selector` and `index` select: of "all", usable device number `index`, from 0; of any other
/// text, choose_device(selector, index). If the child process ends early, or a check takes longer than
/// settings.timeout_s, the running check counts as failed, and the next checks run in a new process. Throws the
/// UserError or DeviceError that the child process reports, and DeviceError if the driver ends the process before the
/// first check.
DeviceChecks supervise(const std::string& selector, std::size_t index, const VerifySettings& settings,
                       const SupervisorSink& sink);

/// Returns the request of the child process's task: settings and device, see supervise(). With a member "capture",
/// {"step": N, "folder": TEXT}, the child also captures step N and writes the lines of Capture (host/cl/capture.hpp).
Json settings_json(const VerifySettings& settings, const std::string& selector, std::size_t index);

/// Name and function of the child process's task (host/base/child_process.hpp). run_checks() writes the lines to the
/// file descriptor `pipe`, except the line "error": run_checks() throws the exception, and its caller writes the line.
inline constexpr const char* kVerifyTask = "verify";
void run_checks(int pipe, const Json& request);

// A self-contained case of a failed check: one kernel with its inputs and correct outputs, and a C program that runs it
// (host/verify/reproduce.cpp, host/verify/case/).

/// Writes a case of the failed check `check` into the folder `folder`, which must not exist or be empty. `selector`
/// selects the device, as in choose_device().
///
/// Finds the first kernel launch with wrong results: the check gives the correct words of its launch, or the check is
/// repeated with a reference that passes, and the first launch whose outputs differ is the wrong one. The reference is
/// the first that passes of: raya's own kernels instead of settings.sources.folder; -cl-opt-disable; another device of
/// this computer. If a build or launch failed, crashed or did not end, the case is that build or launch. A random
/// kernel is first reduced to a smaller one that fails in the same way.
///
/// Returns the lines that describe the case. Throws UserError if `folder` is not empty or no case could be made.
std::string reproduce(const std::string& selector, const DeviceChecks& device, const VerifySettings& settings,
                      const Check& check, const std::filesystem::path& folder);

/// Throws UserError if `folder` exists and is not an empty folder, or cannot be made. Makes its parent folders.
void check_case_folder(const std::filesystem::path& folder);

}  // namespace raya
