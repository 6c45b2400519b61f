// Memories of the torus nodes: the part of the scene that each node stores (kernels/shared/node.h).
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "host/accel/partition.hpp"
#include "host/scene/packer.hpp"
#include "kernels/shared/node.h"

namespace raya {

/// Sizes of the memories of all nodes.
struct NodeSizes {
    std::vector<std::uint64_t> words, objects;  // [node]; objects: planes included
    std::uint64_t copies = 0;                   // number of voxel list entries minus number of distinct objects in them
    raya_grid grid{};                           // the voxels

    /// Returns the number of the node with the most words, the first of several.
    std::uint32_t fullest() const;
};
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

}  // namespace raya
