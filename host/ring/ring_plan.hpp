// What a render on a ring machine is asked for, what is chosen where the user leaves the choice, and what every PE
// holds of the scene.
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
    std::optional<DynamicPlan> dynamic;  // loads are those of a dynamic distribution, simulated from the pixels' costs
    raya_mapping mapping{};              // image size, PEs, which of them owns which pixel
    std::uint32_t bounces = 8;
    NumberFormat format;
    Sampling sampling = Sampling::kCentres;
    Antialias antialias;
    bool keep_costs = false;  // of each pixel, 8 bytes on the host; a dynamic distribution keeps them by itself
    Accel accel;
    KernelChoice kernels;
    std::uint64_t device_pixels = 1 << 22;  // of all PEs that lie on the device at a time, 20 bytes each; smoothed
                                            // images lie there as a whole
    std::uint32_t work_per_launch = 0;      // tests and steps of a lane's rays; 0: as much as takes about a second
};

JobSettings job_settings(const RingSettings& settings, const LengthScale& scale);

/// What a PE has to hold of a job of so many words; `scene` is its name.
PeDemand pe_demand(const RingSettings& settings, const std::string& scene, std::uint64_t job_words);

/// The settings with lanes and group size chosen. UserError, before anything is packed or taken, if the kernels cannot
/// be built with them.
RingSettings checked(RingSettings settings, const DeviceInfo& device);

/// How much one launch should do: no more than takes about a second, so that a progress bar moves, Ctrl-C is heard and
/// a GPU's watchdog sleeps, and no more than the device lets loops do. `objects`: of the scene; `lights`: of it; `pes`:
/// on this device.
LaunchWork launch_work(const RingSettings& settings, const KernelOptions& options, std::size_t objects,
                       std::size_t lights, std::uint32_t pes, const DeviceInfo& device);

/// `accel`: what was made of settings.accel.
KernelOptions kernel_options(const RingSettings& settings, const PackedJob& job, const AccelSummary& accel,
                             const DeviceInfo& device);

/// A job with the grid or tree behind it, and what was made of that.
struct RingJob {
    PackedJob job;
    AccelSummary accel;
    double accel_s = 0;  // measured: to make it
    LengthScale scale;
    std::uint64_t objects = 0;
};

/// The words of a scene for this machine, without accelerator.
PackedJob pack_for_ring(const Scene& scene, const RingSettings& settings, const LengthScale& scale);

/// Puts the settings' accelerator behind them, which is not none.
AccelSummary append_accel(PackedJob& job, const RingSettings& settings);

/// Packed by rank 0 and sent to all; elsewhere `scene` is not looked at.
RingJob make_ring_job(const Session& session, const Scene& scene, const RingSettings& settings, Ranks& ranks);

}  // namespace raya
