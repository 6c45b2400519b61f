// Finds out which setting makes a failing check pass.
#pragma once
#include <functional>
#include <string>
#include <vector>

#include "host/verify/supervisor.hpp"

namespace raya {

/// Result of bisect(). Each change is text such as "--lanes 1" or "POCL_WORK_GROUP_METHOD=loops".
struct Bisection {
    std::vector<std::string> tried;     // all changes
    std::vector<std::string> smallest;  // a smallest set of changes with which the check passes; empty: none of them
};

/// Searches for a smallest set of changes with which the failed check `full_name` passes: build options, macros of the
/// kernels, one lane, groups of one work-item, and for PoCL its environment variables. Runs the check a few times for
/// each change of the result, by the QuickXplain algorithm (Junker 2004), which assumes that more changes never make a
/// passing check fail. Calls `finished` after each run with the changes and the outcome. Each run has an empty cache of
/// PoCL, because PoCL's variables are not part of the cache's keys.
Bisection bisect(const std::string& selector, std::size_t index, const DeviceChecks& device,
                 const VerifySettings& settings, const std::string& full_name,
                 const std::function<void(const std::vector<std::string>& changes, bool passed)>& finished);

}  // namespace raya
