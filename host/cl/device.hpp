// Enumeration and selection of OpenCL devices.
#pragma once
#include <cstddef>
#include <string>
#include <vector>

#include "host/cl/device_info.hpp"
#include "host/cl/opencl.hpp"

namespace raya {

/// All devices of all platforms, in the order of the ICD loader; empty if no driver is installed. DeviceError if a
/// platform fails with another error than CL_DEVICE_NOT_FOUND.
std::vector<cl::Device> all_devices();

/// Queries the properties of a device. DeviceError if a query fails.
DeviceInfo device_info(const cl::Device& device);

/// Returns the index into `devices` of the device that `wanted` selects:
/// - empty: of the usable GPUs, else the usable CPUs, else all usable devices, number `turn` modulo their count; a
///   device is usable if it is available and has a compiler;
/// - "0", "1", ...: the position in `devices`, as `raya devices` prints it, if there are that many;
/// - "gpu", "cpu", "other": the first usable device of the type;
/// - any other text: the first device whose platform, name, version or driver contains it, ignoring case;
/// - a comma-separated list of these: entry `turn` modulo its length.
/// DeviceError if there is no device (with a remedy), none matches (with a list of devices) or the one named is
/// unusable.
std::size_t device_index(const std::string& wanted, const std::vector<DeviceInfo>& devices, std::size_t turn = 0);

/// Returns the device of all platforms that `name_part` selects, see device_index(); if it is empty, the one that the
/// environment variable RAYA_DEVICE selects. `turn` as in device_index(). DeviceError as in device_index() and
/// all_devices().
cl::Device choose_device(const std::string& name_part, std::size_t turn = 0);

}  // namespace raya
