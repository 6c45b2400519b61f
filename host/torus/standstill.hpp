// A torus machine that has come to a stand before its image was done: its packets wait for each other's links.
#pragma once
#include <cstdint>
#include <string>

#include "host/error.hpp"

namespace raya {

/// The figures of a stand.
struct StandstillFigures {
    std::string scene;
    std::uint64_t superstep = 0;
    std::uint64_t live = 0;   // packets in the machine
    std::uint64_t full = 0;   // nodes whose queue is full, of
    std::uint32_t nodes = 0;  // so many
    std::uint32_t queue = 0;  // packets that a queue holds
};

/// A longer queue mends it; host/torus/queue_search.hpp finds one.
struct Standstill : UserError {
    explicit Standstill(const StandstillFigures& stand, const std::string& remedy = "use a longer queue");

    StandstillFigures figures;
};

}  // namespace raya
