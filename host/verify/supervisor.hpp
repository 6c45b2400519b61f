// Runs a device's checks in a process of its own (worker.hpp), and once more from where it ended if a driver ends it.
#pragma once
#include <functional>
#include <string>
#include <vector>

#include "host/verify/check.hpp"
#include "host/verify/verify.hpp"

namespace raya {

/// What a device says of itself, and what came of its checks.
struct DeviceChecks {
    std::string name, platform, version, driver;
    std::vector<Check> checks;
    double seconds = 0;

    bool is_right() const { return count_of(checks, Outcome::kFail) == 0 && count_of(checks, Outcome::kPass) > 0; }
};

struct SupervisorSink {
    /// Before a device's first check; `left_out`: lines about devices that cannot be used.
    std::function<void(const DeviceChecks&, const std::vector<std::string>& left_out)> device{};
    /// A check has been running for so many seconds; told about once a second.
    std::function<void(const std::string& layer, const std::string& name, double seconds)> running{};
    std::function<void(const Check&)> finished{};
};

/// Checks device number `index` of those that `arguments` name: "verify" and its options, without those that are the
/// worker's. A process that ends before it has told the end is a check that failed, the one that ran; the checks after
/// it follow in another process, as long as each ends at least one. `devices` becomes how many devices are named.
/// UserError, DeviceError as the process itself met them, and DeviceError if the driver ends it before any check.
DeviceChecks supervise(const std::vector<std::string>& arguments, std::size_t index, const VerifySettings& settings,
                       const SupervisorSink& sink, std::size_t& devices);

}  // namespace raya
