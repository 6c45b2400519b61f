// A longer queue for a machine that stands still. A machine's traffic is not to be foreseen, so it is found by trying.
#pragma once
#include <cstdint>
#include <functional>
#include <string>

#include "host/torus/node_buffers.hpp"

namespace raya {

/// What a longer queue is weighed against and tried with.
struct QueueTrial {
    std::function<std::uint64_t(const NodeBuffers&)> bytes;  // of the fullest node
    std::uint64_t limit = UINT64_MAX;                        // bytes of a node's memory
    std::function<bool(const NodeBuffers&)> ends;  // the machine comes to an end; DeviceError: it cannot be had
};

/// What to ask for instead of a queue of `queue` packets: the first of twice, four times, ... as many with which the
/// machine ends, or the longest that fits a node's memory; where none that fits does, a longer one and the memory for
/// it. "--queue 74 is long enough (tried)".
std::string longer_queue(std::uint32_t queue, const QueueTrial& trial);

}  // namespace raya
