// Memories of the torus nodes: the part of the scene that each node stores (kernels/shared/node.h).
#pragma once
#include <cstdint>
#include <vector>

#include "host/accel/partition.hpp"
#include "host/scene/packer.hpp"
#include "kernels/shared/node.h"

namespace raya {

struct NodeMemories {
    std::vector<std::uint32_t> words;   // words of all nodes, concatenated
    std::vector<std::uint32_t> starts;  // [nodes + 1]: index of each node's first word
    std::uint64_t copies = 0;       // duplicates: references to finite objects beyond the first one of each
    std::uint32_t max_objects = 0;  // maximum number of objects in a node, with planes
};

/// Divides the job among the nodes. Objects, surfaces, lights and header have the same words as in the job, except for
/// offsets (fields named "..._at"). Throws UserError if the nodes have more than 2^30 words in total.
NodeMemories pack_nodes(const PackedJob& job, const Partition& partition, const raya_torus& torus);

/// Returns the number of words of the fullest node that pack_nodes() would produce.
std::uint64_t fullest_node_words(const PackedJob& job, const Partition& partition, const raya_torus& torus);

}  // namespace raya
