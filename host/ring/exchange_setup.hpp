// What the kernels of the neighbour exchange are launched with.
#pragma once
#include <cstdint>

#include "host/cl/commands.hpp"
#include "host/ring/pe_segment.hpp"

namespace raya {

struct ExchangeSetup {
    Session& session;
    Buffer<std::uint32_t> broadcast;  // the job's words
    PeSegment pes;                    // on the device
    std::uint32_t capacity = 0;       // pixels in the memory of each PE
    std::uint32_t group_size = 1;
};

}  // namespace raya
