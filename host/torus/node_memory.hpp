// Memories of the torus's nodes: the part of the scene that each node holds (kernels/shared/node.h).
#pragma once
#include <cstdint>
#include <vector>

#include "host/accel/partition.hpp"
#include "host/scene/packer.hpp"
#include "kernels/shared/node.h"

namespace raya {

struct NodeMemories {
    std::vector<std::uint32_t> words;   // of all nodes, one after another
    std::vector<std::uint32_t> starts;  // [nodes + 1]: first word of each node
    std::uint64_t copies = 0;       // objects in voxels beyond each one's first; planes, which all hold, not counted
    std::uint32_t max_objects = 0;  // in one node, planes among them
};

/// Divides the job among the nodes. Objects, surfaces, lights and header keep the job's words, except for "at" words
/// (offsets). Throws UserError for more than 2^30 words in all.
NodeMemories pack_nodes(const PackedJob& job, const Partition& partition, const raya_torus& torus);

/// Words of the fullest node of pack_nodes(), without packing.
std::uint64_t fullest_node_words(const PackedJob& job, const Partition& partition, const raya_torus& torus);

}  // namespace raya
