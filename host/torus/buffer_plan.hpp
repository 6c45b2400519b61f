// Queue and boxes weighed against a node's memory and the device's; what would do where they do not fit; and a longer
// queue for a machine that stands still, found by trying.
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

/// A queue and its boxes: a quarter of it, 1 at least.
NodeBuffers buffers_for(std::uint32_t queue);

/// Bytes of a node: its words, its queue of rays, an outbox and an inbox of rays for each of its links, an inbox of
/// returns for each and one outbox for the link home. What the root hands to the host lies in the host's memory.
std::uint64_t node_bytes(std::uint64_t words, const NodeBuffers& buffers, std::uint32_t links);

/// Packets: 8,192, fewer where there are more than 2,048 nodes, so that all queues and boxes stay below 6 GB.
std::uint32_t default_queue(std::uint32_t nodes);

/// The last number below `above` for which `holds` is true: it is for `first`, and of two numbers for the larger one
/// only if it is for the smaller.
template <class Holds>
std::uint32_t last_that_holds(std::uint64_t first, std::uint64_t above, const Holds& holds) {
    while (above - first > 1) {
        const std::uint64_t middle = first + (above - first) / 2;
        (holds(static_cast<std::uint32_t>(middle)) ? first : above) = middle;
    }
    return static_cast<std::uint32_t>(first);
}

inline constexpr std::uint32_t kLongestQueue = 1u << 30;  // packets

/// What longer queues are weighed against and tried with.
struct QueueTrial {
    std::function<std::uint64_t(const NodeBuffers&)> bytes;  // of the fullest node
    std::uint64_t limit = UINT64_MAX;                        // bytes of a node's memory
    std::uint32_t most = kLongestQueue;                      // packets of the longest to be tried
    std::function<bool(const NodeBuffers&)> device_holds;    // those of all nodes
    std::function<bool(const NodeBuffers&)>
        ends;  // the machine comes to an end; DeviceError: it cannot be had after all
};

/// What a search has come to.
struct QueueFound {
    std::uint32_t queue = 0;  // packets: the longest that was tried
    bool ends = false;        // the machine ends with it
    bool fits = false;        // it fits a node's memory,
    std::uint64_t bytes = 0;  // of which the fullest node needs so much
};

/// The first of twice, four times, ... as many packets as `queue` with which the machine ends, or the longest that fits
/// a node's memory; where none that fits does, a longer one.
QueueFound longer_queue(std::uint32_t queue, const QueueTrial& trial);

/// What to ask for: "--queue 74 is long enough (tried)".
std::string queue_remedy(const QueueFound& found);

/// The same job on another number of nodes: words of its fullest node, and into which voxels the box was cut.
struct TrialNodes {
    std::uint64_t words = 0;
    Divisions voxels{};
};
using NodeTrial = std::function<std::optional<TrialNodes>(const std::array<std::uint32_t, 3>& nodes)>;

/// A trial that doubles `voxels` along each axis until every node has one; empty where the scene cannot be cut up so
/// far. It refers to the job.
NodeTrial trial_of(const PackedJob& job, const NumberFormat& format, const Divisions& voxels);

/// Nodes that cannot hold what they have to; the figures are the fullest one's.
struct NodesDoNotFit : DoesNotFit {
    NodesDoNotFit(const std::string& message, std::uint64_t needed, std::uint64_t memory, std::uint32_t all,
                  std::uint32_t that_fit, std::uint32_t most_needed)
        : DoesNotFit(message, needed, memory), nodes(all), fitting(that_fit), fullest(most_needed) {}

    std::uint32_t nodes, fitting, fullest;  // how many there are and fit; the fullest one's number
};

/// The queue asked for (`queue` > 0), or as many packets as the memory leaves beside the fullest node's words, at most
/// default_queue(); boxes as buffers_for() says.
/// NodesDoNotFit where words or buffers do not fit `memory_bytes` (empty: no limit): how many of the nodes fit and how
/// many do not, the fullest one with its number, voxels, objects and bytes beside the limit; the remedy: how many nodes
/// would do (found by `trial`, in a second or so; without one that is left out), or how much memory. UserError too
/// where the queue is shorter than `fewest` packets, which the tree of a single ray can ask for: the message names that
/// number.
NodeBuffers plan_buffers(const std::string& scene, const NodeMemories& memories, const raya_torus& torus,
                         std::optional<std::uint64_t> memory_bytes, std::uint32_t queue, std::uint32_t fewest,
                         const NodeTrial& trial = {});

/// What a device holds, in bytes.
struct DeviceMemory {
    std::uint64_t all = 0, one_buffer = 0;
};

/// Whether a device can hold the queues and boxes of that many nodes.
bool device_holds(const NodeBuffers& buffers, std::uint32_t nodes, const DeviceMemory& memory);

/// UserError where it cannot; it names the longest queue that it can.
void check_device_memory(const std::string& scene, const NodeBuffers& buffers, std::uint32_t nodes,
                         const std::string& device, const DeviceMemory& memory);

}  // namespace raya
