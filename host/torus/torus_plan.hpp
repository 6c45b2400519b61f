// Set-up of a render on the torus: chosen settings, the division of the job among nodes and ranks, and the pixels whose
// primary rays may enter the bounding box at each node's voxels.
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

/// Half-open ranges of rows and columns: [0], the first; [1], one past the last.
struct PixelWindow {
    std::uint32_t rows[2], columns[2];
};

/// For each node, a window that contains every pixel whose primary ray enters the bounding box at one of its voxels:
/// the projection of those of the voxels' faces that lie in a side of the box towards the eye, widened by the rounding
/// error of a ray's direction. It is the whole image if the eye is in a voxel of the node or too close to such a side,
/// or if the format has too few bits for a bound. It is empty for a node that no ray enters.
std::vector<PixelWindow> pixel_windows(const raya_job& job, const raya_grid& grid, const raya_torus& torus,
                                       const NumberFormat& format);

/// The default nodes with one voxel each, the machine's bounces and format, and no limit of memory.
TorusSettings default_torus(const ImageSize& size);

JobSettings job_settings(const TorusSettings& settings, const LengthScale& scale);

/// Throws UserError if there are more voxels or lights than a packet can name.
void check_packets(const TorusSettings& settings, const Scene& scene);

/// Returns the settings with lanes and group size chosen. Throws UserError, before anything is packed or allocated, if
/// packets cannot name the voxels or lights, or if the kernels cannot be built with the settings.
TorusSettings checked(TorusSettings settings, const Scene& scene, const DeviceInfo& device);

/// Number of pixels to trace.
std::uint64_t pixels_of(const TorusSettings& settings);

KernelOptions kernel_options(const TorusSettings& settings, const PackedJob& job);

/// Writes pixel_windows() into the headers of the nodes.
void set_windows(NodeMemories& memories, const TorusSettings& settings, const PackedJob& job,
                 const Partition& partition);

struct TorusJob {
    PackedJob outline;      // the job's header, without objects
    NodeMemories memories;  // of this rank's nodes, by slots; `copies` and `max_objects` are of all nodes
    LengthScale scale;
    NodeBuffers buffers;
    std::uint64_t words = 0;          // of all nodes
    std::uint64_t fullest_words = 0;  // of the fullest node
};

/// Memory that the fullest node needs.
struct NodeNeeds {
    LengthScale scale;
    std::uint64_t words = 0, bytes = 0;  // words of the scene; bytes of these and the buffers
};

/// Divides the scene as a render does, without a device. Throws UserError if packets cannot name the voxels or lights,
/// NodesDoNotFit.
NodeNeeds node_needs(const Scene& scene, const TorusSettings& settings);

/// The minimum over all ranks.
DeviceMemory smallest_device_memory(const DeviceInfo& device, Ranks& ranks);

/// Rank 0 packs the scene, divides it among the nodes and sends each rank the words of its nodes; meanwhile it holds
/// the words of all. Other ranks do not read `scene`. `device`: minimum over all ranks. Throws UserError if nodes do
/// not fit their memory or the device's.
TorusJob make_torus_job(const Session& session, const Scene& scene, const TorusSettings& settings,
                        const NodeShare& share, const DeviceMemory& device, Ranks& ranks);

}  // namespace raya
