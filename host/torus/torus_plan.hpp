// Set-up of a render on the torus: the memories of the nodes, final settings, the division of the job among nodes and
// ranks, and the pixel windows of the nodes.
#pragma once
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "host/accel/partition.hpp"
#include "host/base/checkpoint.hpp"
#include "host/cl/commands.hpp"
#include "host/cl/device.hpp"
#include "host/model/machine.hpp"
#include "host/model/mapping_rule.hpp"
#include "host/model/number_format.hpp"
#include "host/ranks/ranks.hpp"
#include "host/scene/packer.hpp"
#include "host/scene/scene.hpp"
#include "host/torus/topology.hpp"
#include "kernels/shared/node.h"

namespace raya {

// Memories of the torus nodes: the part of the scene that each node stores (kernels/shared/node.h).

/// [node]: number of words of the node's memory.
using NodeSizes = std::vector<std::uint64_t>;
NodeSizes node_sizes(const PackedJob& job, const Partition& partition, const raya_torus& torus);

/// Throws UserError if `nodes` have more than 2^30 words in total.
void check_words(const NodeSizes& sizes, std::span<const std::uint32_t> nodes);

/// Words of some nodes, in the order of their slots.
struct NodeMemories {
    std::vector<std::uint32_t> words;   // words of the nodes, node after node
    std::vector<std::uint32_t> starts;  // [slots + 1]: index of each node's first word
};

/// Packs the words of `nodes`, which check_words() has accepted. The nodes' objects, surfaces, lights and headers have
/// the same words as in the job, except for offsets (fields named "..._at").
NodeMemories pack_nodes(const PackedJob& job, const Partition& partition, const raya_torus& torus,
                        std::span<const std::uint32_t> nodes);

// Sizes of the nodes' queues and mailboxes. Checks that they fit the memory of a node, and suggests remedies if not.

/// Returns the capacities of a queue of `queue` packets and of mailboxes of max(1, queue / 4) packets.
NodeBuffers buffers_for(std::uint32_t queue);

/// Returns the memory that a node needs, in bytes: `words` scene words, the queue of rays, an outbox and an inbox of
/// rays for each of `links` links, an inbox of returns for each link, and one outbox of returns for the return link.
/// The returns that have reached the root are not included, because they are in the host's memory.
std::uint64_t node_bytes(std::uint64_t words, const NodeBuffers& buffers, std::uint32_t links);

/// Returns the default capacity of a queue in packets: 8,192, or less for more than 2,048 nodes, so that all queues and
/// mailboxes together take less than 6 GB.
std::uint32_t default_queue(std::uint32_t nodes);

/// Chooses the capacity of the queues. If `queue` > 0, it is `queue` packets. If `queue` is 0, it is as many packets as
/// fit `memory_bytes` (empty: no limit) together with the words of the fullest node, at most default_queue().
/// buffers_for() determines the size of the mailboxes. Throws DoesNotFit if words and buffers exceed `memory_bytes`.
/// The message states how many nodes fit, the bytes of the fullest node, and a remedy: more memory or a shorter queue.
/// `min_queue`: number of packets that the ray tree of a single primary ray may need. Throws UserError if
/// 0 < `queue` < `min_queue`.
NodeBuffers plan_buffers(const std::string& scene, const NodeSizes& sizes, const raya_torus& torus,
                         std::optional<std::uint64_t> memory_bytes, std::uint32_t queue, std::uint32_t min_queue);

// Final settings, the job of each rank and its nodes' windows.

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
    std::uint64_t copies = 0;         // Partition::copies()
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
