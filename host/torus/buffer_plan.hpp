// Sizes of the queues and mailboxes of nodes: checks them against the memory of a node and of the device, finds
// remedies for a scene that does not fit, and searches for a longer queue for a machine that deadlocks.
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

/// A queue of that many packets, with mailboxes of a quarter of it, at least 1 packet.
NodeBuffers buffers_for(std::uint32_t queue);

/// Memory of a node in bytes: scene words, queue of rays, an outbox and an inbox of rays for each link, an inbox of
/// returns for each link, and one outbox for the link towards the root. The root's returns lie in the host's memory.
std::uint64_t node_bytes(std::uint64_t words, const NodeBuffers& buffers, std::uint32_t links);

/// Packets of a queue: 8,192, or fewer for more than 2,048 nodes, so that all queues and mailboxes stay below 6 GB.
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

inline constexpr std::uint32_t kLongestQueue = 1u << 30;  // packets

/// Limits and callbacks of the search for a longer queue.
struct QueueTrial {
    std::function<std::uint64_t(const NodeBuffers&)> bytes;  // memory that the fullest node needs
    std::uint64_t limit = UINT64_MAX;                        // memory of a node, bytes
    std::uint32_t most = kLongestQueue;                      // longest queue to try, packets
    std::function<bool(const NodeBuffers&)> fits_device;     // the device can hold the buffers of all nodes
    // The machine completes an image without a deadlock. Throws DeviceError if the device memory is short after all.
    std::function<bool(const NodeBuffers&)> ends;
};

/// Result of find_longer_queue().
struct QueueFound {
    std::uint32_t queue = 0;  // longest queue that was tried, packets
    bool ends = false;        // the machine completes with it
    bool fits = false;        // it fits the memory of a node
    std::uint64_t bytes = 0;  // that the fullest node needs
};

/// Doubles the queue until the machine completes. The longest queue that fits a node's memory is tried before any
/// longer one.
QueueFound find_longer_queue(std::uint32_t queue, const QueueTrial& trial);

/// The remedy in words, such as "--queue 74 is long enough (tried)".
std::string queue_remedy(const QueueFound& found);

/// The same job on another number of nodes.
struct NodeTrialResult {
    std::uint64_t words = 0;  // of the fullest node
    Divisions voxels{};       // into which the bounding box was divided
};
using NodeTrial = std::function<std::optional<NodeTrialResult>(const std::array<std::uint32_t, 3>& nodes)>;

/// A trial that doubles `voxels` along each axis until every node has one. It returns nothing if the partition would be
/// too large. It keeps a reference to the job.
NodeTrial make_node_trial(const PackedJob& job, const NumberFormat& format, const Divisions& voxels);

/// The scene or the buffers do not fit the nodes. `needed` is the memory that the fullest node needs.
struct NodesDoNotFit : DoesNotFit {
    NodesDoNotFit(const std::string& message, std::uint64_t needed, std::uint64_t memory, std::uint32_t all,
                  std::uint32_t that_fit, std::uint32_t most_needed)
        : DoesNotFit(message, needed, memory), nodes(all), fitting(that_fit), fullest(most_needed) {}

    std::uint32_t nodes, fitting, fullest;  // number of nodes; of those that fit; index of the fullest node
};

/// Chooses the queue: `queue` packets if it is > 0, else as many as fit `memory_bytes` (empty: no limit) next to the
/// words of the fullest node, at most default_queue(). Mailboxes as in buffers_for().
/// Throws NodesDoNotFit if words and buffers exceed `memory_bytes`. The message has the number of nodes that fit, the
/// fullest node with its voxels, objects and bytes, and a remedy: more memory, or a number of nodes that is sufficient,
/// which `trial` finds in about a second (without a trial the message has none).
/// Throws UserError if 0 < `queue` < `fewest`, the packets that the tree of a single ray may need.
NodeBuffers plan_buffers(const std::string& scene, const NodeMemories& memories, const raya_torus& torus,
                         std::optional<std::uint64_t> memory_bytes, std::uint32_t queue, std::uint32_t fewest,
                         const NodeTrial& trial = {});

/// Memory of a device, and its largest buffer, in bytes.
struct DeviceMemory {
    std::uint64_t all = 0, one_buffer = 0;
};

/// Returns true if the queues and mailboxes of that many nodes fit the device.
bool fits_device(const NodeBuffers& buffers, std::uint32_t nodes, const DeviceMemory& memory);

/// Throws UserError if they do not fit; the message has the longest queue that does.
void check_device_memory(const std::string& scene, const NodeBuffers& buffers, std::uint32_t nodes,
                         const std::string& device, const DeviceMemory& memory);

}  // namespace raya
