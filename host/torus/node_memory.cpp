// Divides the words of a job among the memories of the torus nodes.
#include "host/torus/node_memory.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "host/error.hpp"
#include "host/model/number_format.hpp"
#include "host/scene/packer.hpp"
#include "host/torus/topology.hpp"
#include "kernels/shared/packet.h"

namespace raya {
namespace {

using ObjectNumbers = std::span<const std::uint32_t>;  // object numbers in the scene, ascending

// Access to the parts of a packed job.
class JobParts {
  public:
    explicit JobParts(const PackedJob& job) : header(job.header()), job_(job) {}

    const raya_job header;

    const std::uint32_t* at(std::uint32_t word) const { return job_.words().data() + word; }
    std::size_t surfaces() const { return surface(header.objects.spheres_at); }  // number of surfaces; spheres follow
    // Returns the number of the surface that starts at word `word` of the job.
    std::size_t surface(std::uint32_t word) const { return (word - kWordsOf<raya_job>) / RAYA_SURFACE_WORDS; }

    const std::uint32_t* plane(std::uint32_t i) const { return object(header.objects.spheres + i); }
    const std::uint32_t* object(std::uint32_t number) const { return job_.object(number); }

    // Returns the index of the first word of an object's surface.
    std::uint32_t surface_of(std::uint32_t number) const {
        const raya_objects& o = header.objects;
        return number < o.spheres ? *at(raya_sphere_surfaces_at(o.spheres_at, o.spheres) + number)
                                  : object(number)[RAYA_OBJECT_SURFACE_AT];
    }

  private:
    const PackedJob& job_;
};

std::size_t outline_words(const std::uint32_t* polygon) {
    return polygon[RAYA_POLYGON_CORNERS] * RAYA_CORNER_WORDS +
           (polygon[RAYA_POLYGON_NORMALS_AT] != 0 ? RAYA_PATCH_WORDS : 0);
}

// Object numbers of a voxel's list: of all objects, and of the objects of each kind.
struct VoxelLists {
    ObjectNumbers all;
#define RAYA_NUMBERS_OF_KIND(kind, kinds, KIND) ObjectNumbers kinds;
    RAYA_OBJECT_LIST(RAYA_NUMBERS_OF_KIND)
};

VoxelLists lists_of(const JobParts& job, const Partition& partition, std::uint32_t voxel) {
    const auto first = partition.objects.begin() + partition.starts[voxel];
    const auto last = partition.objects.begin() + partition.starts[voxel + 1];
    const auto begin = [&](std::uint32_t kind) {
        return std::lower_bound(first, last, raya_first_object(job.header.objects, kind));
    };
#define RAYA_PART_OF_LIST(kind, kinds, KIND) {begin(RAYA_##KIND), begin(RAYA_##KIND + 1)},
    return {{first, last}, RAYA_OBJECT_LIST(RAYA_PART_OF_LIST)};
}

// Packs the words of the nodes, one node after another.
class NodePacker {
  public:
    NodePacker(const PackedJob& job, const Partition& partition, const raya_torus& torus)
        : job_(job),
          partition_(partition),
          torus_(torus),
          last_search_(job_.surfaces(), 0),
          surface_at_(job_.surfaces(), 0) {
        if (partition.starts.size() != std::size_t{raya_voxels(partition.grid)} + 1)
            throw std::logic_error("a partition must have one more start than voxels");
    }

    // Returns the number of words of a node.
    std::uint64_t words(std::uint32_t node) {
        find_surfaces(node);
        const raya_job& h = job_.header;
        const std::uint32_t voxels = raya_node_voxels(torus_, partition_.grid, node);
        std::uint64_t words = kWordsOf<raya_node> + surfaces_.size() * RAYA_SURFACE_WORDS +
                              std::uint64_t{h.lights} * RAYA_LIGHT_WORDS + voxels * kWordsOf<raya_voxel_memory> +
                              std::uint64_t{h.objects.planes} * RAYA_PLANE_WORDS;
        for (std::uint32_t local = 0; local < voxels; ++local) {
            const VoxelLists lists = voxel_lists(node, local);
            words = padded_to_rows(words) + lists.all.size() + lists.spheres.size() * (RAYA_SPHERE_WORDS + 1) +
#define RAYA_ADD_WORDS(kind, kinds, KIND) +lists.kinds.size() * RAYA_##KIND##_WORDS
                    0 RAYA_SHAPE_LIST(RAYA_ADD_WORDS);
            for (const std::uint32_t number : lists.polygons) words += outline_words(job_.object(number));
        }
        return padded_to_rows(words);
    }

    // Returns the number of objects of a node, planes included.
    std::uint64_t objects(std::uint32_t node) const {
        std::uint64_t objects = job_.header.objects.planes;
        for (std::uint32_t local = 0; local < raya_node_voxels(torus_, partition_.grid, node); ++local)
            objects += voxel_lists(node, local).all.size();
        return objects;
    }

    // Appends the node's words to `words`.
    void append(std::uint32_t node, std::vector<std::uint32_t>& words) {
        words_ = &words;
        start_ = words.size();
        raya_node header{};
        header.job = job_.header;
        header.job.objects = {};
        header.job.objects.planes = job_.header.objects.planes;
        header.job.accel_at = 0;  // 0: a node has its voxels' object lists instead of the job's accelerator
        header.torus = torus_;
        header.grid = partition_.grid;
        header.number = node;
        header.voxels = raya_node_voxels(torus_, partition_.grid, node);
        words.resize(start_ + kWordsOf<raya_node>);
        append_surfaces(node);
        header.job.lights_at = current_offset();
        append_words(job_.at(job_.header.lights_at), std::size_t{job_.header.lights} * RAYA_LIGHT_WORDS);
        header.voxels_at = current_offset();
        words.resize(words.size() + header.voxels * kWordsOf<raya_voxel_memory>);
        header.job.objects.planes_at = current_offset();
        for (std::uint32_t i = 0; i < header.job.objects.planes; ++i) append_object(job_.plane(i), RAYA_PLANE_WORDS);
        append_voxels(header);
        fill_row();
        put_record(words, start_, header);
    }

  private:
    VoxelLists voxel_lists(std::uint32_t node, std::uint32_t local) const {
        return lists_of(job_, partition_, raya_voxel_of_node(torus_, partition_.grid, node, local));
    }

    // Returns the current offset from the node's first word.
    std::uint32_t current_offset() const { return static_cast<std::uint32_t>(words_->size() - start_); }

    void append_words(const std::uint32_t* source, std::size_t count) {
        words_->insert(words_->end(), source, source + count);
    }

    void append_object(const std::uint32_t* object, std::size_t words) {
        append_words(object, words);
        words_->end()[-static_cast<std::ptrdiff_t>(words) + RAYA_OBJECT_SURFACE_AT] =
            surface_at_[job_.surface(object[RAYA_OBJECT_SURFACE_AT])];
    }

    // Pads with zeros to a multiple of four words, at which the next row or node must start.
    void fill_row() { words_->resize(start_ + padded_to_rows(current_offset())); }

    void add_surface(std::uint32_t word) {
        const std::size_t surface = job_.surface(word);
        if (std::exchange(last_search_[surface], search_number_) != search_number_) surfaces_.push_back(surface);
    }

    // Finds the surfaces of the node's objects, in the order of the scene.
    void find_surfaces(std::uint32_t node) {
        ++search_number_;
        surfaces_.clear();
        for (std::uint32_t i = 0; i < job_.header.objects.planes; ++i)
            add_surface(job_.plane(i)[RAYA_OBJECT_SURFACE_AT]);
        const std::uint32_t voxels = raya_node_voxels(torus_, partition_.grid, node);
        for (std::uint32_t local = 0; local < voxels; ++local)
            for (const std::uint32_t number : voxel_lists(node, local).all) add_surface(job_.surface_of(number));
        std::sort(surfaces_.begin(), surfaces_.end());
    }

    void append_surfaces(std::uint32_t node) {
        find_surfaces(node);
        for (const std::size_t surface : surfaces_) {
            surface_at_[surface] = current_offset();
            const std::size_t first_word = kWordsOf<raya_job> + surface * RAYA_SURFACE_WORDS;
            append_words(job_.at(static_cast<std::uint32_t>(first_word)), RAYA_SURFACE_WORDS);
        }
    }

    void append_voxels(const raya_node& header) {
        for (std::uint32_t local = 0; local < header.voxels; ++local) {
            const VoxelLists lists = voxel_lists(header.number, local);
            const raya_voxel_memory voxel = append_voxel(lists, header.job.objects);
            put_record(*words_, start_ + header.voxels_at + local * kWordsOf<raya_voxel_memory>, voxel);
        }
    }

    raya_voxel_memory append_voxel(const VoxelLists& lists, const raya_objects& planes) {
        raya_voxel_memory voxel{planes, 0, job_.header.objects.spheres};
        voxel.objects.spheres = static_cast<std::uint32_t>(lists.spheres.size());
        fill_row();
        voxel.objects.spheres_at = current_offset();
        for (const std::uint32_t number : lists.spheres) append_words(job_.object(number), RAYA_SPHERE_WORDS);
        for (const std::uint32_t number : lists.spheres)
            words_->push_back(surface_at_[job_.surface(job_.surface_of(number))]);
#define RAYA_APPEND_KIND(kind, kinds, KIND)                               \
    voxel.objects.kinds = static_cast<std::uint32_t>(lists.kinds.size()); \
    voxel.objects.kinds##_at = current_offset();                          \
    for (const std::uint32_t number : lists.kinds) append_object(job_.object(number), RAYA_##KIND##_WORDS);
        RAYA_FIXED_LIST(RAYA_APPEND_KIND)
        voxel.objects.polygons = static_cast<std::uint32_t>(lists.polygons.size());
        voxel.objects.polygons_at = current_offset();
        append_polygons(lists.polygons);
        voxel.numbers_at = current_offset();
        append_words(lists.all.data(), lists.all.size());
        return voxel;
    }

    void append_polygons(ObjectNumbers polygons) {
        std::size_t record = words_->size();
        for (const std::uint32_t number : polygons) append_object(job_.object(number), RAYA_POLYGON_WORDS);
        for (const std::uint32_t number : polygons) {
            const std::uint32_t* const polygon = job_.object(number);
            (*words_)[record + RAYA_POLYGON_CORNERS_AT] = current_offset();
            append_words(job_.at(polygon[RAYA_POLYGON_CORNERS_AT]), polygon[RAYA_POLYGON_CORNERS] * RAYA_CORNER_WORDS);
            if (polygon[RAYA_POLYGON_NORMALS_AT] != 0) {
                (*words_)[record + RAYA_POLYGON_NORMALS_AT] = current_offset();
                append_words(job_.at(polygon[RAYA_POLYGON_NORMALS_AT]), RAYA_PATCH_WORDS);
            }
            record += RAYA_POLYGON_WORDS;
        }
    }

    JobParts job_;
    const Partition& partition_;
    const raya_torus torus_;
    std::uint32_t search_number_ = 0;              // number of calls of find_surfaces()
    std::vector<std::uint32_t> last_search_;       // [surface]: number of the last call that found the surface
    std::vector<std::size_t> surfaces_;            // surfaces found by the last call
    std::vector<std::uint32_t> surface_at_;        // [surface]: offset of the surface in the node being packed
    std::vector<std::uint32_t>* words_ = nullptr;  // words of all nodes packed so far
    std::size_t start_ = 0;                        // index of the current node's first word in *words_
};

}  // namespace

std::uint32_t NodeSizes::fullest() const {
    return static_cast<std::uint32_t>(std::max_element(words.begin(), words.end()) - words.begin());
}

NodeSizes node_sizes(const PackedJob& job, const Partition& partition, const raya_torus& torus) {
    NodePacker packer(job, partition, torus);
    NodeSizes sizes{.words = {}, .objects = {}, .copies = partition.copies(), .grid = partition.grid};
    for (std::uint32_t node = 0; node < raya_nodes(torus); ++node) {
        sizes.words.push_back(packer.words(node));
        sizes.objects.push_back(packer.objects(node));
    }
    return sizes;
}

void check_words(const NodeSizes& sizes, std::span<const std::uint32_t> nodes) {
    std::uint64_t total = 0;
    for (const std::uint32_t node : nodes) total += sizes.words[node];
    if (total > kMaxWords)
        throw UserError(
            fmt::format("{} nodes, {} voxels: the memories of {} nodes need {} words, more than the limit of {}; use "
                        "fewer nodes or voxels, or more processes (mpirun)",
                        sizes.words.size(), raya_voxels(sizes.grid), nodes.size(), total, kMaxWords));
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
    while (min_queue < max_queue) {
        const std::uint32_t middle = max_queue - (max_queue - min_queue) / 2;
        if (node_bytes(words, buffers_for(middle), links) <= memory)
            min_queue = middle;
        else
            max_queue = middle - 1;
    }
    return min_queue;
}

// Memory that the nodes need for a scene and their buffers, and memory that a node has.
struct MemoryDemand {
    const std::string& scene;
    const NodeSizes& sizes;
    const raya_torus& torus;
    std::uint64_t limit;  // memory of a node, bytes
    NodeBuffers buffers;

    std::uint32_t nodes() const { return raya_nodes(torus); }
    std::uint64_t bytes(std::uint64_t words) const { return node_bytes(words, buffers, links_of_node(torus)); }
};

// Returns text such as "node 219 (voxel 3, 3, 3 with 2310 objects)".
std::string node_text(const NodeSizes& sizes, const raya_torus& torus, std::uint32_t number) {
    const std::uint32_t count = raya_node_voxels(torus, sizes.grid, number);
    std::string voxels = counted(count, "voxel");
    if (count == 1) {
        const std::uint32_t voxel = raya_voxel_of_node(torus, sizes.grid, number, 0);
        const raya_place at = raya_place_of(voxel, sizes.grid.divisions[0], sizes.grid.divisions[1]);
        voxels = fmt::format("voxel {}, {}, {}", at.at[0], at.at[1], at.at[2]);
    }
    return fmt::format("node {} ({} with {})", number, voxels, counted(sizes.objects[number], "object"));
}

std::string remedies(const MemoryDemand& demand, std::uint64_t words, std::uint32_t min_queue) {
    const std::uint32_t links = links_of_node(demand.torus);
    const std::uint64_t whole_kb = (demand.bytes(words) + 1023) / 1024;
    const std::string memory = fmt::format("--pe-memory {}", 1024 * whole_kb);
    if (node_bytes(words, buffers_for(min_queue), links) > demand.limit) return "use more --nodes or " + memory;
    return fmt::format("use --queue {} or {}",
                       longest_queue(words, links, demand.limit, min_queue, demand.buffers.queue), memory);
}

[[noreturn]] void throw_does_not_fit(const MemoryDemand& demand, std::uint32_t min_queue) {
    const std::uint32_t fullest = demand.sizes.fullest();
    std::uint32_t fitting = 0;
    for (const std::uint64_t words : demand.sizes.words) fitting += demand.bytes(words) <= demand.limit;
    const std::uint64_t words = demand.sizes.words[fullest];
    throw NodesDoNotFit(
        fmt::format("{}: does not fit: {} of {} nodes can hold their voxels, {} cannot; {} needs {} for the "
                    "scene and {} for buffers, a node has {}; {}",
                    demand.scene, fitting, demand.nodes(), demand.nodes() - fitting,
                    node_text(demand.sizes, demand.torus, fullest), required_size_text(4 * words),
                    required_size_text(demand.bytes(0)), available_size_text(demand.limit),
                    remedies(demand, words, min_queue)),
        demand.bytes(words), demand.limit, demand.nodes(), fitting, fullest);
}

/// Returns true if the queues and mailboxes of `nodes` nodes fit the device.
bool fits_device(const NodeBuffers& buffers, std::uint32_t nodes, const DeviceMemory& memory) {
    const std::uint64_t queue_bytes = kPacketBytes * nodes * buffers.queue;
    const std::uint64_t box_bytes = kPacketBytes * RAYA_LINKS * nodes * (std::uint64_t{1} + buffers.box);
    const std::uint64_t all_bytes = queue_bytes + 2 * box_bytes + 2 * box_bytes * kReturnBytes / kPacketBytes;
    return std::max(queue_bytes, box_bytes) <= memory.max_buffer && all_bytes <= memory.total;
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
    const MemoryDemand demand{scene, sizes, torus, *memory_bytes, buffers_for(queue > 0 ? queue : min_queue)};
    const std::uint64_t words = sizes.words[sizes.fullest()];
    if (demand.bytes(words) > *memory_bytes) throw_does_not_fit(demand, min_queue);
    return buffers_for(longest_queue(words, links_of_node(torus), *memory_bytes, demand.buffers.queue, max_queue));
}

void check_device_memory(const std::string& scene, const NodeBuffers& buffers, std::uint32_t nodes,
                         const std::string& device, const DeviceMemory& memory) {
    if (fits_device(buffers, nodes, memory)) return;
    std::uint32_t queue = buffers.queue;
    while (queue > 1 && !fits_device(buffers_for(queue), nodes, memory)) queue /= 2;
    throw UserError(
        fmt::format("{}: queues of {} packets and their mailboxes in {} nodes do not fit the memory of {}; use "
                    "--queue {} or fewer nodes",
                    scene, buffers.queue, nodes, device, queue));
}

}  // namespace raya
