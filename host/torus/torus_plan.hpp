// Set-up of a render on the torus: final settings, the division of the job among nodes and ranks, and the pixel windows
// of the nodes.
#pragma once
#include <cstdint>
#include <functional>
#include <vector>

#include "host/base/checkpoint.hpp"
#include "host/cl/commands.hpp"
#include "host/cl/device.hpp"
#include "host/model/mapping_rule.hpp"
#include "host/model/number_format.hpp"
#include "host/ranks/ranks.hpp"
#include "host/scene/packer.hpp"
#include "host/scene/scene.hpp"
#include "host/torus/node_memory.hpp"
#include "host/torus/topology.hpp"

namespace raya {

/// A rectangle of pixels: rows rows[0] to rows[1] - 1 and columns columns[0] to columns[1] - 1.
struct PixelWindow {
    std::uint32_t rows[2], columns[2];
};

/// Returns [node]: window that contains every pixel whose primary ray enters the bounding box at one of the node's
/// voxels. Such a ray enters through a face of the voxel that lies in a side of the box facing the eye. The window
/// bounds the projections of these faces, widened by the rounding error of a ray's direction. The window is the whole
/// image in three cases: the eye is in a voxel of the node, the eye is too close to one of these sides, or the format
/// has too few bits for an error bound. The window is empty if no primary ray can enter the box at the node.
std::vector<PixelWindow> pixel_windows(const raya_job& job, const raya_grid& grid, const raya_torus& torus,
                                       const NumberFormat& format);

/// Returns the settings of a torus of kDefaultNodes nodes with one voxel each, the default bounces and format of the
/// machine, and no memory limit.
TorusSettings default_torus(const ImageSize& size);

JobSettings job_settings(const TorusSettings& settings, const LengthScale& scale);

/// Returns the settings with the lanes, group size and other kernel settings chosen for the device. Throws UserError
/// like check_packet_fields(), and if the kernels cannot be built with the settings. Needs neither the packed scene nor
/// device memory, so that raya can fail early.
TorusSettings checked_settings(TorusSettings settings, const Scene& scene, const DeviceInfo& device);

/// Returns the number of pixels to trace.
std::uint64_t traced_pixels(const TorusSettings& settings);

/// Part of a TorusJob that is the same in all ranks.
struct TorusJobHeader {
    raya_job header;  // of the packed scene
    bool has_patches = false;
    LengthScale scale;
    NodeBuffers buffers;
    std::uint64_t fullest_words = 0;  // number of words of the fullest node
    std::uint64_t copies = 0;         // see NodeSizes
};

/// Job of a rank.
struct TorusJob : TorusJobHeader {
    NodeMemories memories;  // of this rank's nodes
};

/// Length scale of a scene, and memory that the fullest node needs.
struct NodeNeeds {
    LengthScale scale;
    std::uint64_t words = 0;  // number of scene words
    std::uint64_t bytes = 0;  // number of bytes of scene words and buffers together
};

/// Divides the scene as a render does, but without a device. Throws DoesNotFit; see check_packet_fields().
NodeNeeds node_needs(const Scene& scene, const TorusSettings& settings);

/// Collective: returns this rank's job. Rank 0 packs the scene, divides it among the nodes and sends each rank the
/// words of its nodes, one rank after another. Then no rank holds the whole scene. Other ranks do not read `scene`;
/// rank 0 calls `packed`, if not empty, when it no longer needs the scene's objects. Throws UserError if the scene or
/// the buffers exceed the memory of a node.
TorusJob make_torus_job(const Session& session, const Scene& scene, const TorusSettings& settings,
                        const NodeDistribution& distribution, const std::function<void()>& packed = {});

/// Collective: returns the settings that determine the state of a render, for checkpoints.
StateSettings state_settings(const TorusSettings& settings, const TorusJob& job, const NodeDistribution& distribution);

}  // namespace raya
