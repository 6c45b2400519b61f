// How a render on the torus is set up: what is chosen where the user leaves the choice, what a rank knows of the scene,
// and which pixels' rays may enter the box at which node's voxels.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "host/cl/commands.hpp"
#include "host/cl/device_info.hpp"
#include "host/cl/kernel_options.hpp"
#include "host/model/mapping_rule.hpp"
#include "host/model/number_format.hpp"
#include "host/ranks/ranks.hpp"
#include "host/scene/length_scale.hpp"
#include "host/scene/packer.hpp"
#include "host/scene/scene.hpp"
#include "host/torus/buffer_plan.hpp"
#include "host/torus/node_memory.hpp"
#include "host/torus/node_share.hpp"
#include "host/torus/torus_settings.hpp"
#include "kernels/shared/node.h"

namespace raya {

/// Rows from, to, and columns from, to, the last not included.
struct PixelWindow {
    std::uint32_t rows[2], columns[2];
};

/// For each node a window that holds every pixel whose primary ray enters the box at one of its voxels: all where the
/// eye is in that voxel; else those that its faces in the sides of the box before the eye cover, widened by what the
/// format can turn a ray. The whole image where the eye is so near to such a side, or the format has so few bits, that
/// no bound is known. Empty for a node where no ray enters.
std::vector<PixelWindow> pixel_windows(const raya_job& job, const raya_grid& grid, const raya_torus& torus,
                                       const NumberFormat& format);

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

struct TorusJob {
    PackedJob outline;      // the job's header, with no object behind it
    NodeMemories memories;  // of the rank's nodes, by slots; `copies` and `most_objects` are of all
    LengthScale scale;
    NodeBuffers buffers;
    std::uint64_t words = 0;          // of all nodes
    std::uint64_t fullest_words = 0;  // of the node that has most
};

/// What the fullest node holds, of a machine that is on no device.
struct NodeNeeds {
    LengthScale scale;
    std::uint64_t words = 0, bytes = 0;  // of the scene; with the node's buffers
};

/// As a render would divide the scene. UserError where packets cannot name voxels or lights, NodesDoNotFit.
NodeNeeds node_needs(const Scene& scene, const TorusSettings& settings);

/// Memory that the device of every rank has.
DeviceMemory least_memory(const DeviceInfo& device, Ranks& ranks);

/// Rank 0 packs the scene, divides it among the nodes and sends every rank the words of its own: meanwhile it holds
/// those of all. Elsewhere `scene` is not looked at. `device`: what each has at
/// least. UserError where nodes do not fit theirs or a device's memory.
TorusJob make_torus_job(const Session& session, const Scene& scene, const TorusSettings& settings,
                        const NodeShare& share, const DeviceMemory& device, Ranks& ranks);

}  // namespace raya
