// What each node of the torus holds of the scene (kernels/shared/node.h).
#pragma once
#include <cstdint>
#include <vector>

#include "host/accel/partition.hpp"
#include "host/scene/packer.hpp"
#include "kernels/shared/node.h"

namespace raya {

struct NodeMemories {
    std::vector<std::uint32_t> words;   // of all nodes, one after another
    std::vector<std::uint32_t> starts;  // [nodes + 1]: where each node's words start
    std::uint64_t copies = 0;        // objects in voxels beyond each one's first; planes, which all hold, not counted
    std::uint32_t most_objects = 0;  // in one node, planes among them
};

/// Cuts the job up. Every word that a kernel reads of an object, surface, light or header is the job's, but for "at"
/// words. UserError where that makes more than 2^30 words.
NodeMemories pack_nodes(const PackedJob& job, const Partition& partition, const raya_torus& torus);

/// Words of the fullest node that pack_nodes would make, without making them.
std::uint64_t fullest_node_words(const PackedJob& job, const Partition& partition, const raya_torus& torus);

}  // namespace raya
