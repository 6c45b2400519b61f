// Random scenes, partitions and nodes. The layout of a node's memory depends only on which objects each voxel lists, so
// the lists are random and the tests need no geometry.
#pragma once
#include <algorithm>
#include <cstdint>
#include <numeric>
#include <set>
#include <vector>

#include "host/scene/packer.hpp"
#include "host/torus/node_memory.hpp"
#include "host/torus/topology.hpp"
#include "tests/kernels/random_scene.hpp"
#include "tests/torus/random_torus.hpp"

namespace raya {

inline PackedJob pack(const Scene& scene) {
    JobSettings settings;
    settings.image = {16, 16};
    return pack_job(scene, settings);
}

/// Returns a scene with 0 to `max_count` objects of each kind, 1 to 12 surfaces and 0 to 5 lights.
inline Scene random_objects(SplitMix& random, std::uint64_t max_count) {
    Scene scene = empty_scene();
    for (const ObjectKind& kind : object_kinds()) {
        const std::uint32_t count = random.next() % 3 == 0 ? 0 : random_below(random, max_count + 1);
        for (std::uint32_t i = 0; i < count; ++i) kind.add(scene, random);
    }
    scene.surfaces.resize(1 + random_below(random, 12));
    for (Surface& surface : scene.surfaces) surface.colour = random_point(random, 1);
    const auto assign_surfaces = [&](auto& objects) {
        for (auto& object : objects) object.surface = static_cast<int>(random_below(random, scene.surfaces.size()));
    };
    assign_surfaces(scene.spheres);
    assign_surfaces(scene.planes);
    assign_surfaces(scene.polygons);
    assign_surfaces(scene.cones);
    scene.lights.resize(random_below(random, 6), {{1, 2, 3}, {}});
    for (Light& light : scene.lights) light.position = random_point(random, 5);
    return scene;
}

/// Returns a partition whose voxels list no objects, with an arbitrary box and arbitrary cell sizes.
inline Partition empty_partition(const Divisions& divisions) {
    Partition p;
    p.grid = {{-1, -2, -3}, {0.25F, 0.5F, 0.75F}, {divisions[0], divisions[1], divisions[2]}, 100};
    p.starts.assign(raya_voxels(p.grid) + 1, 0);
    return p;
}

/// Returns a partition with the given object lists, indexed by voxel. The lists must not contain planes.
inline Partition partition_of(const Divisions& divisions, const std::vector<std::set<std::uint32_t>>& lists) {
    Partition p = empty_partition(divisions);
    std::set<std::uint32_t> distinct;
    for (std::size_t voxel = 0; voxel < lists.size(); ++voxel) {
        p.objects.insert(p.objects.end(), lists[voxel].begin(), lists[voxel].end());
        p.starts[voxel + 1] = static_cast<std::uint32_t>(p.objects.size());
        distinct.insert(lists[voxel].begin(), lists[voxel].end());
    }
    p.listed_objects = distinct.size();
    return p;
}

/// Returns the numbers of all objects of a job except its planes.
inline std::vector<std::uint32_t> finite_objects(const PackedJob& job) {
    const raya_objects o = job.header().objects;
    std::vector<std::uint32_t> finite;
    for (std::uint32_t i = 0; i < o.spheres + o.planes + o.polygons + o.cones; ++i)
        if (i < o.spheres || i >= o.spheres + o.planes) finite.push_back(i);
    return finite;
}

/// Returns a partition that lists every finite object in random voxels: about half of the objects are each in a single
/// voxel, the others each in up to `max_copies` voxels.
inline Partition random_partition(SplitMix& random, const PackedJob& job, const Divisions& divisions,
                                  std::uint32_t max_copies) {
    std::vector<std::set<std::uint32_t>> lists(divisions[0] * divisions[1] * divisions[2]);
    for (const std::uint32_t object : finite_objects(job)) {
        const std::uint32_t copies = random.next() % 2 ? 1 : 1 + random_below(random, max_copies);
        for (std::uint32_t i = 0; i < copies; ++i) lists[random_below(random, lists.size())].insert(object);
    }
    return partition_of(divisions, lists);
}

/// Packs the words of all nodes.
inline NodeMemories pack_all(const PackedJob& job, const Partition& partition, const raya_torus& torus) {
    std::vector<std::uint32_t> nodes(raya_nodes(torus));
    std::iota(nodes.begin(), nodes.end(), 0);
    return pack_nodes(job, partition, torus, nodes);
}

/// Reads the words of a node and counts how often each word is read.
class NodeReader {
  public:
    NodeReader(const NodeMemories& memories, std::uint32_t node)
        : words_(memories.words.begin() + memories.starts[node], memories.words.begin() + memories.starts[node + 1]),
          reads_(words_.size(), 0),
          header_(take<raya_node>(0)) {}

    const raya_node& header() const { return header_; }
    std::size_t size() const { return words_.size(); }
    raya_voxel_memory voxel(std::uint32_t local) {
        return take<raya_voxel_memory>(header_.voxels_at + local * sizeof(raya_voxel_memory) / 4);
    }
    std::uint32_t word(std::size_t at) { return section(at, 1)[0]; }
    std::vector<std::uint32_t> section(std::size_t at, std::size_t count) {
        std::vector<std::uint32_t> words;
        for (std::size_t i = at; i < at + count; ++i) {
            ++reads_.at(i);
            words.push_back(words_.at(i));
        }
        return words;
    }

    /// Returns the number of words that were read `times` times.
    std::size_t words_read(int times) const {
        return static_cast<std::size_t>(std::count(reads_.begin(), reads_.end(), times));
    }

  private:
    template <class T>
    T take(std::size_t at) {
        return record_at<T>(section(at, kWordsOf<T>), 0);
    }

    std::vector<std::uint32_t> words_;
    std::vector<int> reads_;
    raya_node header_;
};

}  // namespace raya
