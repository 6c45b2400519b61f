// Supersteps, as time models and traces are told of them.
#pragma once
#include <cstdint>
#include <functional>
#include <vector>

namespace raya {

/// What was counted in one superstep, for time models and traces.
struct Superstep {
    std::uint64_t most_cycles = 0;      // computing, of the busiest node
    std::uint64_t most_link_words = 0;  // over one link in one direction, the busiest
    std::uint64_t live = 0;             // packets in queues and boxes at its end
};

/// What every node did in one superstep.
struct SuperstepDetail {
    const Superstep& all;
    std::vector<std::uint64_t> cycles;             // [node]: computing
    const std::vector<std::uint64_t>& link_words;  // [node][RAYA_LINKS]: sent over each link
};
using SuperstepSink = std::function<void(const SuperstepDetail&)>;

}  // namespace raya
