// Runs a device's checks in a process of its own, since a driver that crashes takes its process with it, and once more
// from where it ended if a driver ends it. What that process writes, a JSON object a line:
//
//     {"devices": N, "left_out": [TEXT, ...], "name": ..., "platform": ..., "version": ..., "driver": ...}
//     {"started": {"layer": LAYER, "name": NAME}}    a check begins
//     {"check": {...}}      and has ended: to_json() of check.hpp
//     {"ended": true}       that was all
//     {"error": TEXT, "kind": "user" or "device" or "internal"}      nothing more comes
#pragma once
#include <cstddef>
#include <functional>
#include <string>
#include <vector>

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

/// Checks device number `index` of those that `wanted` names: "all" the usable ones, else one as choose_device() has
/// it. A process that ends before it has told the end is a check that failed, the one that ran; the checks after it
/// follow in another process, as long as each ends at least one. `devices` becomes how many devices are named.
/// UserError, DeviceError as the process itself met them, and DeviceError if the driver ends it before any check.
DeviceChecks supervise(const std::string& wanted, std::size_t index, const VerifySettings& settings,
                       const SupervisorSink& sink, std::size_t& devices);

/// The task of that process (host/base/own_process.hpp), and what it does: writes all lines but the last.
inline constexpr const char* kVerifyTask = "verify";
void run_checks(int lines, const Json& order);

}  // namespace raya
