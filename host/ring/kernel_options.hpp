// How the kernels are built for a device: the one place that makes their -D values.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "cl/device.hpp"
#include "machine/number_format.hpp"

namespace raya {

/// The tunables of kernels/ (each RAYA_* macro is explained where the kernels give its default).
struct KernelOptions {
    std::uint32_t lanes = 1;       // V
    std::uint32_t group_size = 1;  // L
    std::uint32_t bounces = 8;
    NumberFormat format;
    bool words_local = true;  // PEs take the broadcast words into local memory
    bool polygons = true, patches = true, cones = true;
};

/// V: as wide as the device's float vectors on a CPU, 1 elsewhere.
std::uint32_t default_lanes(const DeviceInfo& device);

/// L: 1 on a CPU, where lanes do its work, 32 elsewhere.
std::uint32_t default_group_size(const DeviceInfo& device);

/// Throws UserError for lanes other than 1, 4, 8, 16, a group size outside 1..64 or above the device's limit, more than
/// 31 bounces.
void check_kernel_options(const KernelOptions& options, const DeviceInfo& device);

/// The build options, correctly rounded division and square root among them where the device offers a choice. Checks
/// `options` as above.
std::vector<std::string> build_options(const KernelOptions& options, const DeviceInfo& device);

}  // namespace raya
