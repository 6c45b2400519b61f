// Sizes of the nodes' queues and mailboxes. Checks that they fit the memory of a node and of the device, suggests
// remedies if they do not, and searches for a queue length with which a deadlocked machine completes.
#pragma once
#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "host/accel/partition.hpp"
#include "host/model/machine.hpp"
#include "host/model/number_format.hpp"
#include "host/scene/packer.hpp"
#include "host/torus/node_memory.hpp"
#include "host/torus/torus_settings.hpp"

namespace raya {

/// Returns a queue of `queue` packets, and mailboxes of a quarter of that, at least 1 packet.
NodeBuffers buffers_for(std::uint32_t queue);

/// Memory of a node in bytes: `words` scene words, the queue of rays, an outbox and an inbox of rays for each of
/// `links` links, an inbox of returns for each link, and one outbox of returns, for the link towards the root. Returns
/// that have reached the root are in the host's memory and not included.
std::uint64_t node_bytes(std::uint64_t words, const NodeBuffers& buffers, std::uint32_t links);

/// Default capacity of a queue in packets: 8,192, or less for more than 2,048 nodes, so that all queues and mailboxes
/// together take less than 6 GB.
std::uint32_t default_queue(std::uint32_t nodes);

/// Binary search: the largest number in [first, above) for which `holds` is true. `holds` must be monotonic (true up to
/// some number, then false) and true for `first`.
template <class Holds>
std::uint32_t last_where(std::uint64_t first, std::uint64_t above, const Holds& holds) {
    while (above - first > 1) {
        const std::uint64_t middle = first + (above - first) / 2;
        (holds(static_cast<std::uint32_t>(middle)) ? first : above) = middle;
    }
    return static_cast<std::uint32_t>(first);
}

inline constexpr std::uint32_t kMaxQueue = 1u << 30;  // packets

/// Limits and callbacks of the search for a longer queue.
struct QueueTrial {
    std::function<std::uint64_t(const NodeBuffers&)> node_bytes;  // memory that the fullest node needs, bytes
    std::uint64_t node_memory = UINT64_MAX;                       // memory of a node, bytes
    std::uint32_t max_queue = kMaxQueue;                          // longest queue to try, packets
    std::function<bool(const NodeBuffers&)> fits_device;          // the device can hold the buffers of all nodes
    // Returns true if the machine completes an image without a deadlock. Throws DeviceError if allocating the buffers
    // fails although fits_device() returned true.
    std::function<bool(const NodeBuffers&)> completes;
};

/// Result of find_longer_queue().
struct QueueSearchResult {
    std::uint32_t queue = 0;  // longest queue that was tried, packets
    bool completes = false;   // the machine completes an image with this queue
    bool fits = false;        // the queue fits the memory of a node
    std::uint64_t bytes = 0;  // memory that the fullest node needs
};

/// Doubles the queue length, starting from `queue`, until the machine completes an image. Before it exceeds a node's
/// memory, it tries the longest queue that fits.
QueueSearchResult find_longer_queue(std::uint32_t queue, const QueueTrial& trial);

/// Text of the remedy for error messages: "--queue 74 is long enough (tried)".
std::string queue_remedy(const QueueSearchResult& found);

/// Result of dividing the same job among another number of nodes.
struct NodeTrialResult {
    std::uint64_t words = 0;  // scene words of the fullest node
    Divisions voxels{};       // divisions of the bounding box
};
using NodeTrial = std::function<std::optional<NodeTrialResult>(const std::array<std::uint32_t, 3>& nodes)>;

/// Makes a trial that doubles `voxels` along each axis until every node has a voxel. The trial returns nullopt if the
/// partition would be too large. It keeps a reference to `job`.
NodeTrial make_node_trial(const PackedJob& job, const NumberFormat& format, const Divisions& voxels);

/// The scene or the buffers do not fit the nodes. `needed` is the memory that the fullest node needs.
struct NodesDoNotFit : DoesNotFit {
    NodesDoNotFit(const std::string& message, std::uint64_t needed, std::uint64_t memory, std::uint32_t node_count,
                  std::uint32_t fitting_nodes, std::uint32_t fullest_node)
        : DoesNotFit(message, needed, memory), nodes(node_count), fitting(fitting_nodes), fullest(fullest_node) {}

    std::uint32_t nodes, fitting, fullest;  // number of nodes; number of nodes that fit; number of the fullest node
};

/// Chooses the capacity of the queues: `queue` packets if > 0, otherwise as many as fit `memory_bytes` (empty: no
/// limit) together with the words of the fullest node, at most default_queue(). Mailboxes have the size that
/// buffers_for() returns. Throws NodesDoNotFit if words and buffers exceed `memory_bytes`. The message states how many
/// nodes fit, the voxels, objects and bytes of the fullest node, and a remedy: more memory, a shorter queue, or, if
/// `trial` is given, a sufficient number of nodes. `trial` finds it in about a second. `min_queue`: maximum number of
/// packets that the ray tree of a single primary ray needs. Throws UserError if 0 < `queue` < `min_queue`.
NodeBuffers plan_buffers(const std::string& scene, const NodeMemories& memories, const raya_torus& torus,
                         std::optional<std::uint64_t> memory_bytes, std::uint32_t queue, std::uint32_t min_queue,
                         const NodeTrial& trial = {});

/// Memory of a device, and maximum size of one buffer, in bytes.
struct DeviceMemory {
    std::uint64_t total = 0, max_buffer = 0;
};

/// Returns true if the queues and mailboxes of `nodes` nodes fit the device.
bool fits_device(const NodeBuffers& buffers, std::uint32_t nodes, const DeviceMemory& memory);

/// Throws UserError if !fits_device(); the message states the longest queue that fits.
void check_device_memory(const std::string& scene, const NodeBuffers& buffers, std::uint32_t nodes,
                         const std::string& device, const DeviceMemory& memory);

}  // namespace raya
