// Memories of the torus nodes: the part of the scene that each node stores (kernels/shared/node.h).
#pragma once
#include <cstdint>
#include <vector>

#include "host/accel/partition.hpp"
#include "host/scene/packer.hpp"
#include "kernels/shared/node.h"

namespace raya {

/// Words of the nodes' memories, and statistics of the objects.
struct NodeMemories {
    std::vector<std::uint32_t> words;   // words of all nodes, node after node
    std::vector<std::uint32_t> starts;  // [nodes + 1]: index of each node's first word
    std::uint64_t copies = 0;           // number of voxel list entries minus number of distinct objects in the lists
    std::uint32_t max_objects = 0;      // maximum number of objects in a node, planes included
};

/// Divides the job among the nodes. The nodes' objects, surfaces, lights and headers have the same words as in the job,
/// except for offsets (fields named "..._at"). Throws UserError if the nodes have more than 2^30 words in total.
NodeMemories pack_nodes(const PackedJob& job, const Partition& partition, const raya_torus& torus);

/// Returns the number of words of the fullest node that pack_nodes() would produce.
std::uint64_t fullest_node_words(const PackedJob& job, const Partition& partition, const raya_torus& torus);

}  // namespace raya
