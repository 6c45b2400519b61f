// Set-up of a render on a ring machine: settings, choices that the user leaves open, and the words of the scene.
#pragma once
#include <cstdint>
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

struct RingSettings {
    Machine machine;
    std::optional<DynamicPlan> dynamic;  // dynamic distribution, whose loads are simulated from the pixels' costs
    raya_mapping mapping{};              // image size, PEs and owners of pixels
    std::uint32_t bounces = 8;
    NumberFormat format;
    Sampling sampling = Sampling::kCentres;
    Antialias antialias;
    bool keep_costs = false;  // record the cost of each pixel, 8 bytes on the host; implied by `dynamic`
    Accel accel;
    KernelChoice kernels;
    std::uint64_t device_pixels = 1 << 22;  // pixels of all PEs on the device at a time, 20 bytes each; anti-aliased
                                            // images are there as a whole
    std::uint32_t work_per_launch = 0;      // tests and steps of a lane's rays; 0: about a second's worth
};

JobSettings job_settings(const RingSettings& settings, const LengthScale& scale);

/// Memory demand of a PE for a job of that many words; `scene`: name of the scene.
PeDemand pe_demand(const RingSettings& settings, const std::string& scene, std::uint64_t job_words);

/// Returns the settings with lanes and group size chosen. Throws UserError, before anything is packed or allocated, if
/// the kernels cannot be built with them.
RingSettings checked(RingSettings settings, const DeviceInfo& device);

/// Work of a launch: at most about a second, so that progress is shown, Ctrl-C takes effect and no GPU watchdog
/// intervenes, and at most the loop iterations that the device allows. `objects`, `lights`: of the scene; `pes`: on
/// this device.
LaunchWork launch_work(const RingSettings& settings, const KernelOptions& options, std::size_t objects,
                       std::size_t lights, std::uint32_t pes, const DeviceInfo& device);

/// `accel`: of the accelerator that settings.accel selected.
KernelOptions kernel_options(const RingSettings& settings, const PackedJob& job, const AccelSummary& accel,
                             const DeviceInfo& device);

/// A job with its grid or BVH.
struct RingJob {
    PackedJob job;
    AccelSummary accel;
    double accel_s = 0;  // measured build time of the accelerator
    LengthScale scale;
    std::uint64_t objects = 0;
};

/// The words of a scene for this machine, without accelerator.
PackedJob pack_for_ring(const Scene& scene, const RingSettings& settings, const LengthScale& scale);

/// Builds the settings' accelerator, which must not be kNone, and appends it to the job.
AccelSummary append_accel(PackedJob& job, const RingSettings& settings);

/// Rank 0 packs the job and sends it to all; other ranks do not read `scene`.
RingJob make_ring_job(const Session& session, const Scene& scene, const RingSettings& settings, Ranks& ranks);

}  // namespace raya
