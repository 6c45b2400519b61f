// How a render on the torus is set up: what is chosen where the user leaves the choice.
#pragma once
#include <cstdint>

#include "host/cl/device_info.hpp"
#include "host/cl/kernel_options.hpp"
#include "host/model/image_size.hpp"
#include "host/scene/length_scale.hpp"
#include "host/scene/packer.hpp"
#include "host/scene/scene.hpp"
#include "host/torus/node_memory.hpp"
#include "host/torus/torus_settings.hpp"

namespace raya {

/// The usual nodes with a voxel each, without a limit of memory, on the machine's bounces and in its format.
TorusSettings usual_torus(const ImageSize& size);

JobSettings job_settings(const TorusSettings& settings, const LengthScale& scale);

/// UserError if packets cannot name the voxels or lights.
void check_packets(const TorusSettings& settings, const Scene& scene);

/// The settings with lanes and group size chosen. UserError, before anything is packed or taken, if packets cannot name
/// the voxels or lights, or the kernels cannot be built with them.
TorusSettings checked(TorusSettings settings, const Scene& scene, const DeviceInfo& device);

/// How many pixels are traced.
std::uint64_t pixels_of(const TorusSettings& settings);

KernelOptions kernel_options(const TorusSettings& settings, const PackedJob& job);

/// Tells each node's header which pixels to look at.
void set_windows(NodeMemories& memories, const TorusSettings& settings, const PackedJob& job,
                 const Partition& partition);

}  // namespace raya
