// The devices that there are, and which one is used.
#pragma once
#include <cstddef>
#include <string>
#include <vector>

#include "host/cl/device_info.hpp"
#include "host/cl/opencl.hpp"

namespace raya {

/// Every device of every platform, in the order of the ICD loader; empty where no driver is installed.
/// DeviceError if a platform fails in any other way than by having no device.
std::vector<cl::Device> all_devices();

/// DeviceError if the device does not answer.
DeviceInfo device_info(const cl::Device& device);

/// The index into `devices` of the one that `wanted` names:
/// - empty: of the GPUs, else of the CPUs, else of any, number `turn`; only devices that are available and have a
///   compiler; after the last one the first again;
/// - "0", "1", ...: the position in `devices`, as `raya devices` prints it, where there are that many;
/// - "gpu", "cpu", "other": the first usable one of the type;
/// - else the first device with `wanted`, upper and lower case alike, in its platform, name, version or driver;
/// - a list of those with commas: number `turn` of it, after the last one the first again.
/// DeviceError: there is none (names the remedy), none matches (lists what there is), or the one named is unusable.
std::size_t device_index(const std::string& wanted, const std::vector<DeviceInfo>& devices, std::size_t turn = 0);

/// The device that `name_part` names, see device_index; where it is empty, the one that the environment variable
/// RAYA_DEVICE names, if set; `turn` as in device_index. Looks at all platforms. DeviceError as in device_index and
/// all_devices.
cl::Device choose_device(const std::string& name_part, std::size_t turn = 0);

}  // namespace raya
