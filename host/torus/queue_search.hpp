// A longer queue for a machine that stands still. A machine's traffic is not to be foreseen, so it is found by trying.
#pragma once
#include <cstdint>
#include <functional>
#include <string>

#include "host/torus/node_buffers.hpp"

namespace raya {

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

}  // namespace raya
