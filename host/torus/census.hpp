// What the nodes' status says of the machine as a whole.
#pragma once
#include <cstdint>
#include <vector>

#include "host/torus/node_status.hpp"

namespace raya {

/// Packets that live, or rays that have still to be made.
struct Census {
    std::uint64_t live = 0, full = 0, progress = 0, cycles = 0;  // full: queues; cycles: of the busiest node
    std::uint32_t fullest = 0;                                   // packets in the fullest queue
    bool all_made = true;
    double looked = 0;  // share of the rows that nodes have looked at
};

/// `capacity`: packets that a queue holds.
Census census_of(const NodeStatus& status, std::uint32_t nodes, std::uint32_t capacity);

/// Modelled cycles of each node in the superstep.
std::vector<std::uint64_t> cycles_of_nodes(const NodeStatus& status, std::uint32_t nodes);

}  // namespace raya
