// Which PEs of the ring a rank has: consecutive ones, as many as the others have, or one more.
#pragma once
#include <cstdint>

#include "host/ranks/ranks.hpp"

namespace raya {

struct PeSegment {
    std::uint32_t first = 0, count = 0;
};

/// Those of a rank, of `pes` >= `ranks` in all.
inline PeSegment segment_of(std::uint32_t pes, std::uint32_t ranks, std::uint32_t rank) {
    const auto begin = [&](std::uint64_t r) { return static_cast<std::uint32_t>(r * pes / ranks); };
    return {begin(rank), begin(rank + 1) - begin(rank)};
}

/// The rank that has a PE.
inline std::uint32_t rank_of_pe(std::uint32_t pes, std::uint32_t ranks, std::uint64_t pe) {
    return static_cast<std::uint32_t>(((pe + 1) * ranks - 1) / pes);
}

inline PeSegment own_segment(std::uint32_t pes, const Ranks& ranks) {
    return segment_of(pes, ranks.count(), ranks.rank());
}

}  // namespace raya
