// Preparation of a render on a ring machine: the user's settings, the settings that raya chooses, and the packed scene.
#pragma once
#include <cstdint>
#include <functional>
#include <optional>

#include "host/cl/commands.hpp"
#include "host/cl/device_info.hpp"
#include "host/cl/kernel_options.hpp"
#include "host/model/machine.hpp"
#include "host/ranks/ranks.hpp"
#include "host/ring/antialias.hpp"
#include "host/ring/pe_memory.hpp"
#include "host/ring/tracer.hpp"
#include "host/scene/length_scale.hpp"
#include "host/scene/packer.hpp"
#include "host/scene/scene.hpp"
#include "kernels/shared/mapping.h"

namespace raya {

/// Settings of a render on a ring machine.
struct RingSettings {
    Machine machine;
    std::optional<DynamicPlan> dynamic;  // dynamic distribution, whose loads are simulated from the pixels' costs
    raya_mapping mapping{};              // image size, number of PEs, and owner of each pixel
    std::uint32_t bounces = 8;
    NumberFormat format;
    Sampling sampling = Sampling::kCentres;
    Antialias antialias;
    // Rays of neighbouring pixels descend through the BVH together, which takes less time. Only rays and their hits are
    // counted then, because the numbers of steps and tests would depend on the neighbours. See use_packets().
    bool packets = false;
    bool record_costs = false;  // record each pixel's cost, which takes 8 bytes of host memory; implied by `dynamic`
    Accel accel;
    KernelChoice kernels;
    // Maximum number of pixels of all PEs that the device holds at a time, 20 bytes each. With anti-aliasing the device
    // holds all pixels.
    std::uint64_t device_pixels = 1 << 22;
    // Maximum number of tests and traversal steps of a lane's rays in one launch; 0: chosen so that a launch takes
    // about one second.
    std::uint32_t work_per_launch = 0;
};

/// Sets settings.packets if that is possible: in fp32 with a BVH, if the mapping is tiles, so that the lanes hold
/// neighbouring pixels. If `may_change_mapping`, first chooses small tiles that divide the image, if there are any.
void use_packets(RingSettings& settings, bool may_change_mapping);

JobSettings job_settings(const RingSettings& settings, const LengthScale& scale);

/// Returns the properties of a render that determine a PE's memory. `scene`: name of the scene, for messages.
/// `job_words`: number of words of the job.
PeDemand pe_demand(const RingSettings& settings, const std::string& scene, std::uint64_t job_words);

/// Returns the settings with the number of lanes and the group size chosen for the device. Throws UserError if the
/// kernels cannot be built with these settings. Call it before packing the scene, so that raya fails early.
RingSettings checked_settings(RingSettings settings, const DeviceInfo& device);

/// Returns the work limits of a launch. A launch should take at most about a second, so that progress is shown, Ctrl-C
/// takes effect and no GPU watchdog ends the launch. It must not exceed the loop iterations that the device allows.
/// `objects`, `lights`: numbers of objects and lights of the scene; `pes`: number of PEs on this device.
LaunchWork launch_work(const RingSettings& settings, const KernelOptions& options, std::size_t objects,
                       std::size_t lights, std::uint32_t pes, const DeviceInfo& device);

/// Returns the kernel options for the packed job. `accel`: summary of the accelerator that settings.accel selects.
KernelOptions kernel_options(const RingSettings& settings, const PackedJob& job, const AccelSummary& accel,
                             const DeviceInfo& device);

/// A packed job with its grid or BVH.
struct RingJob {
    PackedJob job;
    AccelSummary accel;
    double accel_s = 0;  // measured build time of the accelerator, seconds
    LengthScale scale;
    std::uint64_t objects = 0;  // number of objects of the scene
};

/// Packs a scene for the ring machine, with its mapping but without an accelerator.
PackedJob pack_for_ring(const Scene& scene, const RingSettings& settings, const LengthScale& scale);

/// Builds the accelerator of settings.accel, which must not be kNone, and appends it to the job.
AccelSummary append_accel(PackedJob& job, const RingSettings& settings);

/// Collective: rank 0 packs the scene, calls `packed` if it is not empty, and sends the job to all ranks. After the
/// call of `packed` the scene's objects are not used. Other ranks do not use `scene`.
RingJob make_ring_job(const Session& session, const Scene& scene, const RingSettings& settings, Ranks& ranks,
                      const std::function<void()>& packed = {});

}  // namespace raya
