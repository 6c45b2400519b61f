// How the clocks of ranks, on other hosts perhaps, lie against rank 0's.
#pragma once
#include <cstdint>
#include <functional>

#include "host/ranks/ranks.hpp"

namespace raya {

/// Adding `offset_ns` to a time of this rank gives rank 0's, at most `uncertainty_ns` off.
struct RankClock {
    std::int64_t offset_ns = 0;
    std::uint64_t uncertainty_ns = 0;
};

/// Each rank in turn asks rank 0 for its time, again and again, and takes the answer that came soonest: it lies between
/// the two looks at its own clock (as NTP has it, D. L. Mills 1991). Clocks may drift apart afterwards, which is not
/// seen. `now`: nanoseconds.
RankClock rank_clock(Ranks& ranks, const std::function<std::uint64_t()>& now);

}  // namespace raya
