// Sizes of the nodes' queues and mailboxes. Checks that queues and mailboxes fit the memory of a node and of the
// device, suggests remedies if they do not fit, and searches for a queue length with which a deadlocked machine
// completes.
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

/// Returns the capacities of a queue of `queue` packets and of mailboxes of max(1, queue / 4) packets.
NodeBuffers buffers_for(std::uint32_t queue);

/// Returns the memory that a node needs, in bytes: `words` scene words, the queue of rays, an outbox and an inbox of
/// rays for each of `links` links, an inbox of returns for each link, and one outbox of returns for the return link.
/// The returns that have reached the root are not included, because they are in the host's memory.
std::uint64_t node_bytes(std::uint64_t words, const NodeBuffers& buffers, std::uint32_t links);

/// Returns the default capacity of a queue in packets: 8,192, or less for more than 2,048 nodes, so that all queues and
/// mailboxes together take less than 6 GB.
std::uint32_t default_queue(std::uint32_t nodes);

/// Returns the largest number in [first, end) for which `holds` is true, by binary search. `holds` must be true for
/// `first` and for all numbers up to the result, and false for all others.
template <class Holds>
std::uint32_t largest_where(std::uint64_t first, std::uint64_t end, const Holds& holds) {
    while (end - first > 1) {
        const std::uint64_t middle = first + (end - first) / 2;
        (holds(static_cast<std::uint32_t>(middle)) ? first : end) = middle;
    }
    return static_cast<std::uint32_t>(first);
}

inline constexpr std::uint32_t kMaxQueue = 1u << 30;  // maximum capacity of a queue, packets

/// Limits and callbacks of the search for a longer queue.
struct QueueTrial {
    std::function<std::uint64_t(const NodeBuffers&)> node_bytes;  // memory that the fullest node needs, bytes
    std::uint64_t node_memory = UINT64_MAX;                       // memory of a node, bytes
    std::uint32_t max_queue = kMaxQueue;                          // longest queue to try, packets
    std::function<bool(const NodeBuffers&)> fits_device;          // true: the device can hold the buffers of all nodes
    // Returns true if the machine completes an image without a deadlock. Throws DeviceError if allocating the buffers
    // fails although fits_device() returned true.
    std::function<bool(const NodeBuffers&)> completes;
};

/// Result of find_longer_queue().
struct QueueSearchResult {
    std::uint32_t queue = 0;  // longest queue that was tried, packets
    bool completes = false;   // the machine completes an image with this queue
    bool fits = false;        // scene words and buffers of the fullest node fit its memory
    std::uint64_t bytes = 0;  // memory that the fullest node needs, bytes
};

/// Doubles the queue length, starting from `queue`, until the machine completes an image. Tries the longest queue that
/// fits a node's memory before any longer queue.
QueueSearchResult find_longer_queue(std::uint32_t queue, const QueueTrial& trial);

/// Returns the remedy for an error message: "--queue 74 is long enough (tried)".
std::string queue_remedy(const QueueSearchResult& found);

/// Result of a NodeTrial.
struct NodeTrialResult {
    std::uint64_t words = 0;  // number of scene words of the fullest node
    Divisions voxels{};       // numbers of voxels along x, y, z
};
/// Divides a job among `nodes` nodes along x, y, z. Returns nullopt if the partition would be too large.
using NodeTrial = std::function<std::optional<NodeTrialResult>(const std::array<std::uint32_t, 3>& nodes)>;

/// Makes a trial that divides `job` into `voxels` voxels, doubled along each axis until every node has a voxel. `job`
/// must outlive the trial.
NodeTrial make_node_trial(const PackedJob& job, const NumberFormat& format, const Divisions& voxels);

/// Thrown if the scene or the buffers do not fit the nodes. `needed`: bytes that the fullest node needs; `memory`:
/// bytes that a node has.
struct NodesDoNotFit : DoesNotFit {
    NodesDoNotFit(const std::string& message, std::uint64_t needed, std::uint64_t memory, std::uint32_t node_count,
                  std::uint32_t fitting_nodes, std::uint32_t fullest_node)
        : DoesNotFit(message, needed, memory), nodes(node_count), fitting(fitting_nodes), fullest(fullest_node) {}

    std::uint32_t nodes, fitting, fullest;  // number of nodes; number of nodes that fit; number of the fullest node
};

/// Chooses the capacity of the queues. If `queue` > 0, it is `queue` packets. If `queue` is 0, it is as many packets as
/// fit `memory_bytes` (empty: no limit) together with the words of the fullest node, at most default_queue().
/// buffers_for() determines the size of the mailboxes. Throws NodesDoNotFit if words and buffers exceed `memory_bytes`.
/// The message states how many nodes fit, the voxels, objects and bytes of the fullest node, and a remedy: more memory
/// or a shorter queue. If `trial` is given, the remedy may be more nodes; the search for a sufficient number takes
/// about a second. `min_queue`: number of packets that the ray tree of a single primary ray may need. Throws
/// UserError if 0 < `queue` < `min_queue`.
NodeBuffers plan_buffers(const std::string& scene, const NodeSizes& sizes, const raya_torus& torus,
                         std::optional<std::uint64_t> memory_bytes, std::uint32_t queue, std::uint32_t min_queue,
                         const NodeTrial& trial = {});

/// Memory of a device in bytes. `max_buffer`: maximum size of one buffer.
struct DeviceMemory {
    std::uint64_t total = 0, max_buffer = 0;
};

/// Returns true if the queues and mailboxes of `nodes` nodes fit the device.
bool fits_device(const NodeBuffers& buffers, std::uint32_t nodes, const DeviceMemory& memory);

/// Throws UserError if !fits_device(); the message states a queue length that fits.
void check_device_memory(const std::string& scene, const NodeBuffers& buffers, std::uint32_t nodes,
                         const std::string& device, const DeviceMemory& memory);

}  // namespace raya
