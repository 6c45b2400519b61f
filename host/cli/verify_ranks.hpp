// raya verify under mpirun: every rank checks its own device, and rank 0 prints and reports the results.
#pragma once
#include <string>
#include <vector>

#include "host/ranks/ranks.hpp"
#include "host/verify/device_checks.hpp"

namespace raya {

/// Collective: every rank checks its own device, in a child process. Rank 0 prints failures, and a line for each rank.
/// On rank 0, returns the results of all ranks; on other ranks, an empty vector. A DeviceError, and a GPU that another
/// rank on the host checks too, become failed checks, so that the results of the other ranks are not lost. `device`: as
/// given to --device. Throws UserError as supervise() does.
std::vector<DeviceChecks> verify_on_ranks(const std::string& device, const VerifySettings& settings, Ranks& ranks);

}  // namespace raya
