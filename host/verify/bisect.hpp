// Finds out which setting makes a failing check pass.
#pragma once
#include <functional>
#include <string>

#include "host/verify/supervisor.hpp"

namespace raya {

/// Searches for a smallest set of changes with which the failed check `full_name` passes: build options, macros of the
/// kernels, one lane, groups of one work-item, and for PoCL its environment variables. Runs the check a few times for
/// each change of the result, by the QuickXplain algorithm (Junker 2004), which assumes that more changes never make a
/// passing check fail. Calls `print` with a line after each run, such as "PASS  --lanes 1", and at the end with the
/// result. Each run has an empty cache of PoCL, because PoCL's variables are not part of the cache's keys. `selector`
/// selects the device, as in choose_device().
void bisect(const std::string& selector, const DeviceChecks& device, const VerifySettings& settings,
            const std::string& full_name, const std::function<void(const std::string& line)>& print);

}  // namespace raya
