// Set-up of a render on the torus: final settings, the division of the job among nodes and ranks, and for each node the
// pixels whose primary rays may enter the bounding box at the node's voxels.
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

/// Half-open ranges of rows and columns: [0] is the first one, [1] is one past the last.
struct PixelWindow {
    std::uint32_t rows[2], columns[2];
};

/// Returns for each node a window that contains every pixel whose primary ray enters the bounding box at one of the
/// node's voxels. A ray enters through a face of a voxel that is part of a side of the box facing the eye. The window
/// bounds the projections of these faces, widened by the rounding error of a ray's direction. It is the whole image if
/// the eye is in a voxel of the node or too close to such a side, or if the format has too few bits for an error bound.
/// It is empty for a node that no primary ray can enter.
std::vector<PixelWindow> pixel_windows(const raya_job& job, const raya_grid& grid, const raya_torus& torus,
                                       const NumberFormat& format);

/// Returns kDefaultNodes nodes with one voxel each, the default bounces and format of the machine, and no memory limit.
TorusSettings default_torus(const ImageSize& size);

JobSettings job_settings(const TorusSettings& settings, const LengthScale& scale);

/// Throws UserError if there are more voxels or lights than the fields of a packet can number.
void check_packets(const TorusSettings& settings, const Scene& scene);

/// Returns the settings with lanes and group size filled in. Throws UserError like check_packets(), and if the kernels
/// cannot be built with the settings. Called before the scene is packed and memory is allocated.
TorusSettings checked_settings(TorusSettings settings, const Scene& scene, const DeviceInfo& device);

/// Returns the number of pixels to trace.
std::uint64_t pixels_of(const TorusSettings& settings);

KernelOptions kernel_options(const TorusSettings& settings, const PackedJob& job);

/// Writes pixel_windows() into the headers of the nodes.
void set_windows(NodeMemories& memories, const TorusSettings& settings, const PackedJob& job,
                 const Partition& partition);

struct TorusJob {
    PackedJob header_only;  // the job's header, without objects
    NodeMemories memories;  // of this rank's nodes, by slot; except `copies` and `max_objects`, which are of all nodes
    LengthScale scale;
    NodeBuffers buffers;
    std::uint64_t words = 0;          // total of all nodes
    std::uint64_t fullest_words = 0;  // of the fullest node
};

/// Memory needs of the fullest node.
struct NodeNeeds {
    LengthScale scale;
    std::uint64_t words = 0, bytes = 0;  // scene words; bytes of scene words and buffers
};

/// Divides the scene as a render does, without a device. Throws UserError like check_packets(), or NodesDoNotFit.
NodeNeeds node_needs(const Scene& scene, const TorusSettings& settings);

/// Returns the minimum over the devices of all ranks.
DeviceMemory smallest_device_memory(const DeviceInfo& device, Ranks& ranks);

/// Rank 0 packs the scene, divides it among the nodes and sends each rank the words of its nodes. Until then, rank 0's
/// host memory holds the words of all nodes. Other ranks do not read `scene`. `device`: smallest_device_memory().
/// Throws UserError if the scene or the buffers exceed the memory of a node or of the device.
TorusJob make_torus_job(const Session& session, const Scene& scene, const TorusSettings& settings,
                        const NodeShare& share, const DeviceMemory& device, Ranks& ranks);

}  // namespace raya
