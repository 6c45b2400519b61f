// What a node did in one superstep, packet by packet, as histories are told of it.
#pragma once
#include <cstdint>
#include <functional>
#include <span>

#include "kernels/shared/traffic.h"

namespace raya {

struct NodeWork {
    std::uint32_t node = 0;
    std::uint64_t injection_cycles = 0;       // for the primary rays that it made, and those that it looked at in vain
    std::span<const raya_treated> treated{};  // of each slot of its queue as it was before
    std::span<const raya_packet> queue{};     // as it is now: what was made or changed is RAYA_STATE_FRESH
};
using NodeWorkSink = std::function<void(const NodeWork&)>;

}  // namespace raya
