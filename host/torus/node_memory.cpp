// Divides the words of a job among the memories of the torus nodes.
#include <fmt/core.h>

#include <algorithm>
#include <map>
#include <ranges>
#include <stdexcept>

#include "host/error.hpp"
#include "host/model/number_format.hpp"
#include "host/scene/packer.hpp"
#include "host/torus/topology.hpp"
#include "host/torus/torus_plan.hpp"
#include "kernels/shared/packet.h"

namespace raya {
namespace {

using ObjectNumbers = std::span<const std::uint32_t>;  // object numbers in the scene, ascending

// Object numbers of a voxel's list: of all objects, and of the objects of each kind.
struct VoxelLists {
    ObjectNumbers all;
#define RAYA_NUMBERS_OF_KIND(kind, kinds, KIND) ObjectNumbers kinds;
    RAYA_OBJECT_LIST(RAYA_NUMBERS_OF_KIND)
};

// Packs the words of the nodes, one node after another.
class NodePacker {
  public:
    NodePacker(const PackedJob& job, const Partition& partition, const raya_torus& torus)
        : job_(job), job_header_(job.header()), partition_(partition), torus_(torus) {
        if (partition.starts.size() != std::size_t{raya_voxels(partition.grid)} + 1)
            throw std::logic_error("a partition must have one more start than voxels");
    }

    // Appends the node's words to `words`.
    void append(std::uint32_t node, std::vector<std::uint32_t>& words) {
        words_ = &words;
        start_ = words.size();
        raya_node header{};
        header.job = job_header_;
        header.job.objects = {};
        header.job.objects.planes = job_header_.objects.planes;
        header.job.accel_at = 0;  // 0: a node has its voxels' object lists instead of the job's accelerator
        header.torus = torus_;
        header.grid = partition_.grid;
        header.number = node;
        header.voxels = raya_node_voxels(torus_, partition_.grid, node);
        words.resize(start_ + kWordsOf<raya_node>);
        append_surfaces(header);
        header.job.lights_at = current_offset();
        append_words(job_at(job_header_.lights_at), std::size_t{job_header_.lights} * RAYA_LIGHT_WORDS);
        header.voxels_at = current_offset();
        words.resize(words.size() + header.voxels * kWordsOf<raya_voxel_memory>);
        header.job.objects.planes_at = current_offset();
        for (std::uint32_t i = 0; i < header.job.objects.planes; ++i) append_object(plane(i), RAYA_PLANE_WORDS);
        append_voxels(header);
        fill_row();
        put_record(words, start_, header);
    }

  private:
    const std::uint32_t* job_at(std::uint32_t word) const { return job_.words().data() + word; }
    const std::uint32_t* plane(std::uint32_t i) const { return job_.object(job_header_.objects.spheres + i); }

    // Returns the index of the first word of an object's surface in the job.
    std::uint32_t surface_of(std::uint32_t number) const {
        const raya_objects& o = job_header_.objects;
        return number < o.spheres ? *job_at(raya_sphere_surfaces_at(o.spheres_at, o.spheres) + number)
                                  : job_.object(number)[RAYA_OBJECT_SURFACE_AT];
    }

    VoxelLists voxel_lists(std::uint32_t node, std::uint32_t local) const {
        const std::uint32_t voxel = raya_voxel_of_node(torus_, partition_.grid, node, local);
        const auto objects = partition_.objects.begin();
        const ObjectNumbers all(objects + partition_.starts[voxel], objects + partition_.starts[voxel + 1]);
        const auto begin = [&](std::uint32_t kind) {
            return std::ranges::lower_bound(all, raya_first_object(job_header_.objects, kind));
        };
#define RAYA_PART_OF_LIST(kind, kinds, KIND) {begin(RAYA_##KIND), begin(RAYA_##KIND + 1)},
        return {all, RAYA_OBJECT_LIST(RAYA_PART_OF_LIST)};
    }

    // Returns the current offset from the node's first word.
    std::uint32_t current_offset() const { return static_cast<std::uint32_t>(words_->size() - start_); }

    void append_words(const std::uint32_t* source, std::size_t count) {
        words_->insert(words_->end(), source, source + count);
    }

    void append_object(const std::uint32_t* object, std::size_t words) {
        append_words(object, words);
        words_->end()[-static_cast<std::ptrdiff_t>(words) + RAYA_OBJECT_SURFACE_AT] =
            surface_at_.at(object[RAYA_OBJECT_SURFACE_AT]);
    }

    // Pads with zeros to a multiple of four words, at which the next row or node must start.
    void fill_row() { words_->resize(start_ + padded_to_rows(current_offset())); }

    // Appends the surfaces of the node's objects, in the order of the scene.
    void append_surfaces(const raya_node& header) {
        surface_at_.clear();
        for (std::uint32_t i = 0; i < header.job.objects.planes; ++i) surface_at_[plane(i)[RAYA_OBJECT_SURFACE_AT]] = 0;
        for (std::uint32_t local = 0; local < header.voxels; ++local)
            for (const std::uint32_t number : voxel_lists(header.number, local).all)
                surface_at_[surface_of(number)] = 0;
        for (auto& [job_word, offset] : surface_at_) {
            offset = current_offset();
            append_words(job_at(job_word), RAYA_SURFACE_WORDS);
        }
    }

    void append_voxels(const raya_node& header) {
        for (std::uint32_t local = 0; local < header.voxels; ++local) {
            const raya_voxel_memory voxel = append_voxel(voxel_lists(header.number, local), header.job.objects);
            put_record(*words_, start_ + header.voxels_at + local * kWordsOf<raya_voxel_memory>, voxel);
        }
    }

    raya_voxel_memory append_voxel(const VoxelLists& lists, const raya_objects& planes) {
        raya_voxel_memory voxel{planes, 0, job_header_.objects.spheres};
        voxel.objects.spheres = static_cast<std::uint32_t>(lists.spheres.size());
        fill_row();
        voxel.objects.spheres_at = current_offset();
        for (const std::uint32_t number : lists.spheres) append_words(job_.object(number), RAYA_SPHERE_WORDS);
        for (const std::uint32_t number : lists.spheres) words_->push_back(surface_at_.at(surface_of(number)));
#define RAYA_APPEND_KIND(kind, kinds, KIND)                               \
    voxel.objects.kinds = static_cast<std::uint32_t>(lists.kinds.size()); \
    voxel.objects.kinds##_at = current_offset();                          \
    for (const std::uint32_t number : lists.kinds) append_object(job_.object(number), RAYA_##KIND##_WORDS);
        RAYA_FIXED_LIST(RAYA_APPEND_KIND)
        RAYA_APPEND_KIND(polygon, polygons, POLYGON)
        append_details(lists.polygons, start_ + voxel.objects.polygons_at);
        voxel.numbers_at = current_offset();
        append_words(lists.all.data(), lists.all.size());
        return voxel;
    }

    // Appends the corners and normals of polygons, whose words begin at (*words_)[record].
    void append_details(ObjectNumbers polygons, std::size_t record) {
        for (const std::uint32_t number : polygons) {
            const std::uint32_t* const polygon = job_.object(number);
            (*words_)[record + RAYA_POLYGON_CORNERS_AT] = current_offset();
            append_words(job_at(polygon[RAYA_POLYGON_CORNERS_AT]), polygon[RAYA_POLYGON_CORNERS] * RAYA_CORNER_WORDS);
            if (polygon[RAYA_POLYGON_NORMALS_AT] != 0) {
                (*words_)[record + RAYA_POLYGON_NORMALS_AT] = current_offset();
                append_words(job_at(polygon[RAYA_POLYGON_NORMALS_AT]), RAYA_PATCH_WORDS);
            }
            record += RAYA_POLYGON_WORDS;
        }
    }

    const PackedJob& job_;
    const raya_job job_header_;
    const Partition& partition_;
    const raya_torus torus_;
    std::map<std::uint32_t, std::uint32_t> surface_at_;  // first word in the job -> offset in the node being packed
    std::vector<std::uint32_t>* words_ = nullptr;        // words of all nodes packed so far
    std::size_t start_ = 0;                              // index of the current node's first word in *words_
};

}  // namespace

NodeSizes node_sizes(const PackedJob& job, const Partition& partition, const raya_torus& torus) {
    NodePacker packer(job, partition, torus);
    NodeSizes sizes;
    std::vector<std::uint32_t> words;
    for (std::uint32_t node = 0; node < raya_nodes(torus); ++node) {
        words.clear();
        packer.append(node, words);
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
    NodePacker packer(job, partition, torus);
    NodeMemories memories;
    memories.starts.push_back(0);
    for (const std::uint32_t node : nodes) {
        packer.append(node, memories.words);
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
    const auto longer = std::views::iota(std::uint64_t{min_queue} + 1, std::uint64_t{max_queue} + 1);
    return static_cast<std::uint32_t>(*std::ranges::partition_point(longer, fits) - 1);
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
