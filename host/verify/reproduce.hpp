// A self-contained case of a failed check: one kernel with its inputs and correct outputs, and a C program that runs it
// (host/verify/case/).
#pragma once
#include <filesystem>
#include <string>

#include "host/verify/supervisor.hpp"

namespace raya {

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
