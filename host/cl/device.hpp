// What a device is and can do, and which one is used.
#pragma once
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "host/cl/opencl.hpp"

namespace raya {

/// What a device says of itself. Sizes are bytes, widths are floats in a vector.
struct DeviceInfo {
    std::string name, platform, version, driver;
    std::string type;  // "cpu", "gpu" or "other"
    std::uint32_t compute_units = 0;
    std::uint64_t local_memory_bytes = 0;    // of one work-group
    bool local_memory_is_dedicated = false;  // false: it lies in global memory, as on CPUs
    std::uint64_t global_memory_bytes = 0;
    std::uint64_t max_allocation_bytes = 0;  // of one buffer
    std::size_t max_group_size = 0;          // work-items
    std::uint32_t native_float_width = 0, preferred_float_width = 0;
    bool correctly_rounded_divide_sqrt = false;  // the build option for it is accepted
    bool fused_multiply_add = false;             // CL_FP_FMA; whether it is fast only the kernel can see (FP_FAST_FMAF)
    bool denormals = false, round_to_nearest = false, inf_nan = false;
    bool profiling = false;
    bool available = false, compiler_available = false;
};

/// Every device of every platform, in the order of the ICD loader; empty where no driver is installed.
/// DeviceError if a platform fails in any other way than by having no device.
std::vector<cl::Device> all_devices();

/// DeviceError if the device does not answer.
DeviceInfo device_info(const cl::Device& device);

/// The index into `devices` of the one that `wanted` names:
/// - empty: the first GPU, else the first CPU, else any; only devices that are available and have a compiler;
/// - "0", "1", ...: the position in `devices`, as `raya devices` prints it, where there are that many;
/// - else the first device with `wanted`, upper and lower case alike, in "platform device name".
/// DeviceError: there is none (names the remedy), none matches (lists what there is), or the one named is unusable.
std::size_t device_index(const std::string& wanted, const std::vector<DeviceInfo>& devices);

/// The device that `name_part` names, see device_index; where it is empty, the one that the environment variable
/// RAYA_DEVICE names, if set. Looks at all platforms. DeviceError as in device_index and all_devices.
cl::Device choose_device(const std::string& name_part);

}  // namespace raya
