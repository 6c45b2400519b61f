// What a rank of the torus knows of the scene: the words of its own nodes, and the figures that all ranks share.
#pragma once
#include <cstdint>
#include <string>

#include "host/cl/commands.hpp"
#include "host/ranks/ranks.hpp"
#include "host/scene/length_scale.hpp"
#include "host/scene/packer.hpp"
#include "host/scene/scene.hpp"
#include "host/torus/buffer_plan.hpp"
#include "host/torus/node_buffers.hpp"
#include "host/torus/node_memory.hpp"
#include "host/torus/node_share.hpp"
#include "host/torus/torus_settings.hpp"

namespace raya {

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
