// Properties of an OpenCL device.
#pragma once
#include <cstddef>
#include <cstdint>
#include <string>

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
    // Number of loop iterations of a work-item, summed over its loops, after which the device ends the loops without an
    // error; 0: no known limit.
    std::uint32_t max_loop_iterations = 0;
    std::uint32_t native_float_width = 0, preferred_float_width = 0;
    bool correctly_rounded_divide_sqrt = false;  // supports -cl-fp32-correctly-rounded-divide-sqrt
    bool fused_multiply_add = false;             // CL_FP_FMA; kernels find FP_FAST_FMAF defined if it is fast
    // Properties of fp32: CL_FP_DENORM, CL_FP_ROUND_TO_NEAREST, CL_FP_INF_NAN.
    bool denormals = false, round_to_nearest = false, inf_nan = false;
    bool profiling = false;  // the device can record the times of commands
    bool available = false, compiler_available = false;
    std::string il_versions{};  // as in il_versions(): versions of SPIR-V that the device accepts
};

/// Returns true for Mesa's llvmpipe, the only device with a known limit of loop iterations.
inline bool is_llvmpipe(const DeviceInfo& device) { return device.max_loop_iterations > 0; }

}  // namespace raya
