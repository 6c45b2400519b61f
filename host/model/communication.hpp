// What went over bus and ring.
#pragma once
#include <cstdint>

namespace raya {

/// Transfers and their words, counted where they were made. A word is the machine's: one number.
struct Communication {
    std::uint64_t broadcasts = 0, broadcast_words = 0;        // host to all PEs
    std::uint64_t rotations = 0, rotation_words = 0;          // every PE to its neighbour
    std::uint64_t gathers = 0, gather_words = 0;              // all PEs to the host
    std::uint64_t transfers = 0, transfer_words = 0;          // one PE to one other, over the bus
    std::uint64_t pe_broadcasts = 0, pe_broadcast_words = 0;  // one PE to all, over the bus
};

}  // namespace raya
