// How the kernels are built for a device: the one place that makes their -D values.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "host/cl/device.hpp"
#include "host/kernels/kernel_source.hpp"
#include "host/machine/number_format.hpp"

namespace raya {

/// The tunables of kernels/ (each RAYA_* macro is explained where the kernels define its default).
struct KernelOptions {
    std::uint32_t lanes = 1;       // V
    std::uint32_t group_size = 1;  // L
    std::uint32_t bounces = 8;
    NumberFormat format{};
    bool words_local = true;  // PEs take the broadcast words into local memory
    bool accel = false;       // the job has a grid: rays walk through it
    bool filter = false;      // spheres are filtered in fp32 before the exact test, see sphere_filter_holds
    bool polygons = true, patches = true, cones = true;
};

/// How the kernels are built for a device. 0: chosen from the device.
struct KernelChoice {
    std::uint32_t lanes = 0;                  // V: 1, 4, 8 or 16
    std::uint32_t group_size = 0;             // L: 1..64 work-items
    bool filter = true;                       // the sphere filter, where it holds: the same hits, sooner
    KernelSources sources{};                  // where they come from
    std::vector<std::string> more_options{};  // appended to the build options
};

/// V: as wide as the device's float vectors on a CPU, 1 elsewhere.
std::uint32_t default_lanes(const DeviceInfo& device);

/// L: 1 on a CPU, where lanes do its work, 32 elsewhere.
std::uint32_t default_group_size(const DeviceInfo& device);

/// What chooses the number format and how it divides: options for any kernel on the number layer, the OpenCL C version
/// among them.
std::vector<std::string> format_options(const NumberFormat& format, const DeviceInfo& device);

/// Whether the bounds of kernels/geometry/sphere_filter.clh hold: a reduced format of 10 fraction bits or more, and a
/// scene whose extent (scene units) leaves room for squares. The filter changes the time of a render only, no bit of
/// it.
bool sphere_filter_holds(const NumberFormat& format, double extent);

/// Throws UserError for lanes other than 1, 4, 8, 16, a group size outside 1..64 or above the device's limit, more than
/// 31 bounces.
void check_kernel_options(const KernelOptions& options, const DeviceInfo& device);

/// The build options, correctly rounded division and square root among them where the device offers a choice. Checks
/// `options` as above.
std::vector<std::string> build_options(const KernelOptions& options, const DeviceInfo& device);

/// Behind build_options(), these take something away that a device has, so that what kernels do without it is tested on
/// any: local memory for words; division, square root and a b + c that are rounded correctly.
std::vector<std::string> without_local_words();
std::vector<std::string> without_exact_arithmetic();

}  // namespace raya
