// How the kernels are built for a device: the one place that makes their -D values.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "host/cl/device_info.hpp"
#include "host/cl/kernel_source.hpp"
#include "host/model/number_format.hpp"
#include "kernels/shared/accel.h"

namespace raya {

/// What the kernels leave open beside lanes and group, and what changes a render's time only; 0: the kernels' own
/// default, or the compiler's.
struct KernelTuning {
    std::uint32_t sphere_batch = 0;  // RAYA_SPHERE_BATCH: spheres that are passed before hits are looked for, 1..32
    std::uint32_t trees = 0;         // RAYA_TREES: that a lane walks at once, 1..8; with a grid alone
    std::uint32_t beams = 0;         // RAYA_BEAMS: lights that a hit sends rays to at once, 1..8; with a grid alone
    std::uint32_t registers = 0;     // that NVIDIA's compiler may give a work-item, 16..255; others are not told
    bool operator==(const KernelTuning&) const = default;
};

/// The tunables of kernels/ (each RAYA_* macro is explained where the kernels define its default).
struct KernelOptions {
    std::uint32_t lanes = 1;       // V
    std::uint32_t group_size = 1;  // L
    std::uint32_t bounces = 8;
    NumberFormat format{};
    bool exact_divide = true;  // division and root are the device's own where it rounds them correctly; false: refined
    bool exact_fma = true;     // so is a b + c; false: emulated
    bool words_local = true;   // PEs take the broadcast words into local memory
    std::uint32_t accel = RAYA_ACCEL_NONE;  // what the job has for rays to walk through
    std::uint32_t stack = 0;                // RAYA_BVH_STACK: links that wait while a ray goes down the tree, at most
    bool filter = false;  // spheres and polygons are filtered in fp32 before the exact test, see filters_hold
    bool polygons = true, patches = true, cones = true;
    bool costs = false;  // torus nodes tell what each packet cost them
    KernelTuning more{};
};

/// How packets come over the links of a torus's device: as copies between buffers, as a kernel of their own, or as
/// suits the device: the kernel on a CPU, elsewhere what takes less time, measured. The same packets arrive.
enum class LinkMove : std::uint32_t { kOfDevice, kCopies, kKernel };

/// How the kernels are built for a device and what else is run there, as far as the user or a check chooses.
struct KernelChoice {
    std::uint32_t lanes = 0;       // V: 1, 4, 8 or 16; 0: chosen from the device
    std::uint32_t group_size = 0;  // L: 1..1024 work-items; 0: chosen from the device
    bool filter = true;            // the filters, where they hold: the same hits, sooner
    // What a device has may be left alone, so that what kernels do without it is tested on any.
    bool local_words = true;       // words in local memory, where they fit
    bool exact_arithmetic = true;  // the device's own division, square root and a b + c, where it rounds them correctly
    KernelSources sources{};
    KernelTuning more{};
    LinkMove link_move = LinkMove::kOfDevice;
    std::string origin{};       // where lanes and what follows from them come from, see chosen() in tuned.hpp
    std::string link_origin{};  // likewise of link_move
};

/// V: as wide as the device's float vectors on a CPU, 1 elsewhere and on llvmpipe, which makes vectors of work-items
/// itself and takes minutes and gigabytes to compile wider kernels.
std::uint32_t default_lanes(const DeviceInfo& device);

/// L: 1 on a CPU, where lanes do its work; 8 on llvmpipe, whose vectors of 256 bits are a group's work-items; 128
/// elsewhere: 256 PEs of four warps are about what 132 multiprocessors hold at the 150 registers a work-item that trace
/// takes (docs/gpu_resources.md). A torus node on any CPU is one work-item, which keeps packets in order
/// (docs/packets.md).
std::uint32_t default_group_size(const DeviceInfo& device, bool torus = false);

/// Whether the bounds of kernels/geometry/sphere_filter.clh and outline_filter.clh hold: a reduced format of 10
/// fraction bits or more, and a scene whose extent (scene units) leaves room for squares. They change the time of a
/// render only, no bit of it.
bool filters_hold(const NumberFormat& format, double extent);

/// The largest group that kernels are built for on this device.
std::uint32_t most_group_size(const DeviceInfo& device);

/// Whether the device's compiler has an option that limits registers: NVIDIA's has.
bool takes_register_limit(const DeviceInfo& device);

/// RAYA_TREES as the kernels have it.
std::uint32_t trees_of(const KernelOptions& options);

/// Throws UserError for lanes other than 1, 4, 8, 16, a group size outside 1..1024 or above the device's limit, more
/// than 31 bounces, or a tuning outside its ranges.
void check_kernel_options(const KernelOptions& options, const DeviceInfo& device);

/// The build options of every kernel, correctly rounded division and square root among them where the device offers a
/// choice. Checks `options` as above.
std::vector<std::string> build_options(const KernelOptions& options, const DeviceInfo& device);

}  // namespace raya
