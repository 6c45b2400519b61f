// Build options of the kernels for a device. build_options() makes all -D options.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "host/cl/device_info.hpp"
#include "host/cl/kernel_source.hpp"
#include "host/model/number_format.hpp"
#include "kernels/shared/accel.h"

namespace raya {

/// Kernel parameters that, like lanes and group size, change only the time of a render. A value of 0 selects the
/// default of the kernels or of the compiler.
struct KernelTuning {
    std::uint32_t sphere_batch = 0;  // RAYA_SPHERE_BATCH: spheres tested before their hits are examined, 1..32
    std::uint32_t trees = 0;         // RAYA_TREES: ray trees that a lane traces concurrently, 1..8; only with a grid
    std::uint32_t beams = 0;         // RAYA_BEAMS: shadow rays of a hit traced concurrently, 1..8; only with a grid
    std::uint32_t registers = 0;     // register limit per work-item for NVIDIA's compiler, 16..255; other
                                     // compilers ignore the limit
    bool operator==(const KernelTuning&) const = default;
};

/// The parameters of kernels/ (each RAYA_* macro is documented where the kernels define its default).
struct KernelOptions {
    std::uint32_t lanes = 1;       // V: number of lanes of a work-item
    std::uint32_t group_size = 1;  // L: work-items per work-group
    std::uint32_t bounces = 8;
    NumberFormat format{};
    bool exact_divide = true;  // use the device's division and square root if correctly rounded; false: refine them
    bool exact_fma = true;     // use the device's fused multiply-add; false: emulate it
    bool words_local = true;   // work-groups copy the job's words (scene and settings) into local memory
    std::uint32_t accel = RAYA_ACCEL_NONE;  // accelerator of the job
    std::uint32_t stack = 0;                // RAYA_BVH_STACK: number of entries of the traversal stack
    bool filter = false;  // filter spheres and polygons in fp32 before the exact test, see filters_are_valid()
    // Each is true if the scene has such objects; patches are polygons with vertex normals.
    bool polygons = true, patches = true, cones = true;
    bool costs = false;    // torus nodes record the cost of each packet
    bool packets = false;  // ring: RingSettings::packets
    KernelTuning tuning{};
};

/// The method that moves packets over the links of a torus. kCopies: copies between buffers. kKernel: a kernel.
/// kAutomatic: the kernel on a CPU, else the method that a measurement finds faster. All methods give the same result.
enum class LinkMove : std::uint32_t { kAutomatic, kCopies, kKernel };

/// Kernel settings that the user, a check or tuning chooses for a device.
struct KernelChoice {
    std::uint32_t lanes = 0;       // V: 1, 4, 8 or 16; 0: chosen from the device
    std::uint32_t group_size = 0;  // L: 1..1024 work-items; 0: chosen from the device
    bool filter = true;            // use the fp32 filters if filters_are_valid(); they do not change the hits
    // If one of the next two members is false, the kernels use replacement code, even if the device does not need it.
    bool local_words = true;       // keep the job's words in local memory if they fit; false: in global memory
    bool exact_arithmetic = true;  // use the device's division, square root and fused multiply-add if they are
                                   // correctly rounded; false: refine or emulate them
    KernelSources sources{};
    KernelTuning tuning{};
    LinkMove link_move = LinkMove::kAutomatic;
    std::string origin{};  // for reports: source of lanes, group size and tuning, see chosen_kernels() in tuned.hpp
    std::string link_origin{};  // for reports: source of link_move
};

/// Returns the default V. On a CPU it is the width of the device's float vectors, at least 4. On other devices it is 1,
/// also on llvmpipe, which vectorises over work-items and takes minutes and gigabytes to compile wider kernels.
std::uint32_t default_lanes(const DeviceInfo& device);

/// Returns the default L. On a CPU it is 1, because a work-item's lanes fill the vectors. On llvmpipe it is 8,
/// because llvmpipe vectorises over work-items with 256-bit vectors. For a torus it is 1 on every CPU, because a node of
/// one work-item keeps packets in order (docs/packets.md). On other devices it is 128, or, if `pes` is not 0, the power
/// of 2 from 32 to 256 with which that many PEs have about 512 work-items on each compute unit: the fastest size for a
/// ring without acceleration structure on an H100 (docs/gpus.md).
std::uint32_t default_group_size(const DeviceInfo& device, bool torus = false, std::uint32_t pes = 0);

/// Returns true if the error bounds of kernels/geometry/sphere_filter.clh and outline_filter.clh are valid: `format` is
/// a reduced format with at least 10 fraction bits, and the scene's `extent` (scene units) is so small that squares do
/// not overflow. The filters change the time of a render, not its result.
bool filters_are_valid(const NumberFormat& format, double extent);

/// Returns the maximum group size of the kernels on this device.
std::uint32_t max_group_size_of(const DeviceInfo& device);

/// Returns true if the device's compiler has an option that limits registers (NVIDIA).
bool supports_register_limit(const DeviceInfo& device);

/// Returns the value of RAYA_TREES in kernels built with these options.
std::uint32_t trees_of(const KernelOptions& options);

/// Throws UserError for lanes other than 1, 4, 8, 16, a group size outside 1..max_group_size_of(), more than 31
/// bounces, or tuning parameters outside their ranges.
void check_kernel_options(const KernelOptions& options, const DeviceInfo& device);

/// Returns the build options of all kernels, including -cl-fp32-correctly-rounded-divide-sqrt if it is wanted and the
/// device supports it. Throws as check_kernel_options().
std::vector<std::string> build_options(const KernelOptions& options, const DeviceInfo& device);

}  // namespace raya
