// Divides the words of a job among the memories of the torus nodes.
#include <fmt/core.h>

#include <algorithm>
#include <numeric>
#include <stdexcept>

#include "host/error.hpp"
#include "host/model/number_format.hpp"
#include "host/scene/packer.hpp"
#include "host/torus/topology.hpp"
#include "host/torus/torus_plan.hpp"
#include "kernels/shared/packet.h"

namespace raya {
namespace {

using ObjectNumbers = std::vector<std::uint32_t>;  // object numbers in the scene, ascending

// Appends the words of a node.
void append_node(const PackedJob& job, const Partition& partition, const raya_torus& torus, std::uint32_t number,
                 std::vector<std::uint32_t>& words) {
    if (partition.starts.size() != std::size_t{raya_voxels(partition.grid)} + 1)
        throw std::logic_error("a partition must have one more start than voxels");
    raya_node node{};
    node.job = job.header();
    node.torus = torus;
    node.grid = partition.grid;
    node.number = number;
    node.voxels = raya_node_voxels(torus, partition.grid, number);
    std::vector<ObjectNumbers> lists;
    for (std::uint32_t local = 0; local < node.voxels; ++local) {
        const std::uint32_t voxel = raya_voxel_of_node(torus, partition.grid, number, local);
        const auto objects = partition.objects.begin();
        lists.emplace_back(objects + partition.starts[voxel], objects + partition.starts[voxel + 1]);
    }
    const raya_objects& all = job.header().objects;
    ObjectNumbers planes(all.planes);
    std::iota(planes.begin(), planes.end(), all.spheres);
    ObjectNumbers own = planes;
    for (const ObjectNumbers& list : lists) own.insert(own.end(), list.begin(), list.end());

    ObjectCopier copier(job, words, kWordsOf<raya_node>);
    copier.append_surfaces(own);
    node.job.lights_at = copier.offset();
    copier.append(job.header().lights_at, std::size_t{node.job.lights} * RAYA_LIGHT_WORDS);
    node.voxels_at = copier.offset();
    words.resize(words.size() + node.voxels * kWordsOf<raya_voxel_memory>);
    const raya_objects copied_planes = copier.append_objects(planes);
    node.job.objects = {};
    node.job.objects.planes = copied_planes.planes;
    node.job.objects.planes_at = copied_planes.planes_at;
    node.job.accel_at = 0;  // 0: a node has its voxels' object lists instead of the job's accelerator
    for (std::uint32_t local = 0; local < node.voxels; ++local) {
        copier.fill_row();
        raya_voxel_memory voxel{copier.append_objects(lists[local]), copier.offset(), all.spheres};
        voxel.objects.planes = copied_planes.planes;
        voxel.objects.planes_at = copied_planes.planes_at;
        words.insert(words.end(), lists[local].begin(), lists[local].end());
        copier.put(node.voxels_at + local * kWordsOf<raya_voxel_memory>, voxel);
    }
    copier.fill_row();
    copier.put(0, node);
}

}  // namespace

NodeSizes node_sizes(const PackedJob& job, const Partition& partition, const raya_torus& torus) {
    NodeSizes sizes;
    std::vector<std::uint32_t> words;
    for (std::uint32_t node = 0; node < raya_nodes(torus); ++node) {
        words.clear();
        append_node(job, partition, torus, node, words);
        sizes.push_back(words.size());
    }
    return sizes;
}

void check_words(const NodeSizes& sizes, std::span<const std::uint32_t> nodes) {
    std::uint64_t total = 0;
    for (const std::uint32_t node : nodes) total += sizes[node];
    if (total > kMaxWords)
        throw UserError(fmt::format(
            "{} nodes: the memories of {} nodes need {} words, more than the limit of {}; use fewer nodes or "
            "voxels, or more processes (mpirun)",
            sizes.size(), nodes.size(), total, kMaxWords));
}

NodeMemories pack_nodes(const PackedJob& job, const Partition& partition, const raya_torus& torus,
                        std::span<const std::uint32_t> nodes) {
    NodeMemories memories;
    memories.starts.push_back(0);
    for (const std::uint32_t node : nodes) {
        append_node(job, partition, torus, node, memories.words);
        memories.starts.push_back(static_cast<std::uint32_t>(memories.words.size()));
    }
    return memories;
}

namespace {

constexpr std::uint64_t kPacketBytes = RAYA_PACKET_WORDS * sizeof(std::uint32_t);
constexpr std::uint64_t kReturnBytes = RAYA_RETURN_WORDS * sizeof(std::uint32_t);

// Returns the longest queue in [min_queue, max_queue] with which the queue, the mailboxes and `words` words fit
// `memory` bytes. The queue `min_queue` must fit.
std::uint32_t longest_queue(std::uint64_t words, std::uint32_t links, std::uint64_t memory, std::uint32_t min_queue,
                            std::uint32_t max_queue) {
    const auto fits = [&](std::uint64_t queue) {
        return node_bytes(words, buffers_for(static_cast<std::uint32_t>(queue)), links) <= memory;
    };
    std::uint64_t longest = min_queue, too_long = std::uint64_t{max_queue} + 1;
    while (too_long - longest > 1) {
        const std::uint64_t middle = (longest + too_long) / 2;
        (fits(middle) ? longest : too_long) = middle;
    }
    return static_cast<std::uint32_t>(longest);
}

}  // namespace

NodeBuffers buffers_for(std::uint32_t queue) { return {queue, std::max(1u, queue / 4)}; }

std::uint32_t default_queue(std::uint32_t nodes) { return std::min(8192u, (1u << 24) / nodes); }

std::uint64_t node_bytes(std::uint64_t words, const NodeBuffers& buffers, std::uint32_t links) {
    const std::uint64_t return_boxes = links > 0 ? links + 1 : 0;
    return sizeof(std::uint32_t) * words + kPacketBytes * (buffers.queue + std::uint64_t{2} * links * buffers.box) +
           kReturnBytes * return_boxes * buffers.box;
}

NodeBuffers plan_buffers(const std::string& scene, const NodeSizes& sizes, const raya_torus& torus,
                         std::optional<std::uint64_t> memory_bytes, std::uint32_t queue, std::uint32_t min_queue) {
    min_queue = std::max(1u, min_queue);
    if (queue > 0 && queue < min_queue)
        throw UserError(
            fmt::format("{}: --queue {}: the tree of a single ray may need {} packets; use --queue {} or more", scene,
                        queue, min_queue, min_queue));
    const std::uint32_t max_queue = queue > 0 ? queue : std::max(default_queue(raya_nodes(torus)), min_queue);
    if (!memory_bytes) return buffers_for(max_queue);
    const auto fullest = std::ranges::max_element(sizes);
    const std::uint64_t words = *fullest, limit = *memory_bytes;
    const std::uint32_t links = links_of_node(torus), chosen = queue > 0 ? queue : min_queue;
    const auto bytes = [&](std::uint64_t node_words) { return node_bytes(node_words, buffers_for(chosen), links); };
    if (bytes(words) <= limit) return buffers_for(longest_queue(words, links, limit, chosen, max_queue));
    const auto fitting = std::ranges::count_if(sizes, [&](std::uint64_t w) { return bytes(w) <= limit; });
    const bool shorter_fits = node_bytes(words, buffers_for(min_queue), links) <= limit;
    throw DoesNotFit(
        fmt::format("{}: does not fit: {} of {} nodes can hold their voxels; node {} needs {} for the scene and {} for "
                    "buffers, a node has {}; use {} or --pe-memory {}",
                    scene, fitting, raya_nodes(torus), fullest - sizes.begin(), required_size_text(4 * words),
                    required_size_text(bytes(0)), available_size_text(limit),
                    shorter_fits ? fmt::format("--queue {}", longest_queue(words, links, limit, min_queue, chosen))
                                 : "more --nodes",
                    (bytes(words) + 1023) / 1024 * 1024),
        bytes(words), limit);
}

}  // namespace raya
