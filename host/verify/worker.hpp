// A process of its own in which a device's checks run: a driver that crashes takes this process with it, and no other.
// What it writes, a JSON object a line:
//
//     {"devices": N, "left_out": [TEXT, ...], "name": ..., "platform": ..., "version": ..., "driver": ...}
//     {"started": {"layer": LAYER, "name": NAME}}    a check begins
//     {"check": {...}}      and has ended: to_json() of check.hpp
//     {"ended": true}       that was all
//     {"error": TEXT, "kind": "user" or "device" or "internal"}      nothing more comes
#pragma once
#include <cstddef>
#include <string>
#include <vector>

#include "host/verify/verify.hpp"

namespace raya {

/// The devices that a text names: "all" the usable ones, else one as choose_device() has it. DeviceError as there.
struct NamedDevices {
    std::vector<cl::Device> devices;
    std::vector<std::string> left_out;  // lines about those that cannot be used
};
NamedDevices named_devices(const std::string& wanted);

/// Checks device number `index` of those that `wanted` names and writes the lines above to the file `lines`. What goes
/// wrong becomes a line, not an exception.
void run_worker(int lines, const std::string& wanted, std::size_t index, const VerifySettings& settings);

}  // namespace raya
