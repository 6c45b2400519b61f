// Queue and boxes weighed against a node's memory and the device's; and what would do where they do not fit.
#pragma once
#include <cstdint>
#include <optional>
#include <string>

#include "host/model/does_not_fit.hpp"
#include "host/torus/node_buffers.hpp"
#include "host/torus/node_memory.hpp"
#include "host/torus/node_trial.hpp"

namespace raya {

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
