// Enumeration and selection of OpenCL devices.
#pragma once
#include <cstddef>
#include <string>
#include <vector>

#include "host/cl/device_info.hpp"
#include "host/cl/opencl.hpp"

namespace raya {

/// Returns all devices of all platforms, in the order of the ICD loader; empty if no driver is installed. Leaves out
/// platforms whose queries fail, with a warning; throws DeviceError if no other platform has a device.
std::vector<cl::Device> all_devices();

/// Queries the properties of a device. Throws DeviceError if a query fails.
DeviceInfo device_info(const cl::Device& device);

/// Returns the reason why raya cannot use the device: it is not available, has no compiler, or does not accept SPIR-V
/// while uses_il() is true. Empty if the device is usable.
std::string unusable_reason(const DeviceInfo& device);

/// Returns the index into `devices` of the device that `wanted` selects. `ordinal` is a number for round-robin
/// selection, such as the index of an MPI rank on its host. "Usable": see unusable_reason(). Values of `wanted`:
/// - empty: among the usable GPUs, the device with index `ordinal` modulo their number. If no GPU is usable, the
///   function chooses among the usable CPUs, and if no CPU is usable, among the other usable devices;
/// - "0", "1", ...: the index in `devices`, as `raya devices` prints it, if it is less than the number of devices;
/// - "gpu", "cpu", "other": the first usable device of that type;
/// - any other text: the first device whose platform, name, version or driver contains the text, ignoring case;
/// - a comma-separated list of such values: the entry with index `ordinal` modulo the number of entries applies.
/// Throws DeviceError if there is no device, if none matches, or if the selected device is not usable.
std::size_t device_index(const std::string& wanted, const std::vector<DeviceInfo>& devices, std::size_t ordinal = 0);

/// Returns the device in all_devices() that device_index() selects for `wanted` and `ordinal`. If `wanted` is
/// empty, the environment variable RAYA_DEVICE replaces it. Throws DeviceError as device_index() and all_devices() do.
cl::Device choose_device(const std::string& wanted, std::size_t ordinal = 0);

}  // namespace raya
