// OpenCL devices: properties, enumeration and selection.
#pragma once
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "host/base/members.hpp"

namespace cl {
class Device;
}

namespace raya {

/// The properties that a device reports. Sizes are in bytes, widths in floats per vector.
struct DeviceInfo {
    std::string name, platform, version, driver;
    std::string type;           // "cpu", "gpu" or "other"
    std::string pci_address{};  // "0000:3b:00.0"; empty without the extension cl_khr_pci_bus_info
    std::uint32_t compute_units = 0;
    std::uint64_t local_memory_bytes = 0;    // available to one work-group
    bool local_memory_is_dedicated = false;  // false: part of global memory, as on CPUs
    std::uint64_t global_memory_bytes = 0;
    bool separate_memory = false;            // global memory is separate from the host's memory
    std::uint64_t max_allocation_bytes = 0;  // maximum size of one buffer
    std::size_t max_group_size = 0;          // maximum number of work-items of a work-group
    // The device may end long loops without an error: Mesa's llvmpipe before version 25, after 65,535 iterations of a
    // work-item (tests/portability/nested_loops.cl). Kernels detect it (kernels/shared/loop_canary.clh).
    bool ends_loops_early = false;
    std::uint32_t native_float_width = 0;
    bool correctly_rounded_divide_sqrt = false;  // supports -cl-fp32-correctly-rounded-divide-sqrt
    bool fused_multiply_add = false;             // CL_FP_FMA; kernels find FP_FAST_FMAF defined if it is fast
    bool denormals = false;                      // CL_FP_DENORM of fp32
    bool profiling = false;                      // the device can record the times of commands
    bool available = false, compiler_available = false;
    std::string il_versions{};  // as in il_versions(): versions of SPIR-V that the device accepts
};

/// Lists the names of a device and its driver, for reports.
template <class Device>
void device_members(Members& m, Device& device) {
    m("name", device.name, "CL_DEVICE_NAME.");
    m("platform", device.platform, "CL_PLATFORM_NAME.");
    m("version", device.version, "CL_DEVICE_VERSION.");
    m("driver", device.driver, "CL_DRIVER_VERSION.");
}

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
