// How a render on a ring machine is set up on a device: what is chosen where the user leaves the choice.
#pragma once
#include "host/cl/device_info.hpp"
#include "host/cl/kernel_options.hpp"
#include "host/ring/pe_memory.hpp"
#include "host/ring/ring_settings.hpp"
#include "host/ring/tracer.hpp"
#include "host/scene/length_scale.hpp"
#include "host/scene/packer.hpp"

namespace raya {

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

}  // namespace raya
