// raya verify under mpirun: every rank checks its own device, and rank 0 prints and reports the results.
#pragma once
#include <functional>
#include <vector>

#include "host/cli/verify_output.hpp"
#include "host/ranks/ranks.hpp"
#include "host/verify/device_checks.hpp"

namespace raya {

/// Collective: calls `check_device(print)` in a thread of every rank. Rank 0 prints the lines that the ranks print,
/// with rank and host before each text. On rank 0, returns the results of all ranks; on other ranks, an empty vector. A
/// DeviceError, and a GPU that another rank on the host checks too, become failed checks, so that the results of the
/// other ranks are not lost. Throws any other exception of check_device().
std::vector<DeviceChecks> check_on_ranks(Ranks& ranks,
                                         const std::function<DeviceChecks(const PrintLines&)>& check_device);

}  // namespace raya
