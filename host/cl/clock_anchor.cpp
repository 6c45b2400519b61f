#include "host/cl/clock_anchor.hpp"

#include <algorithm>
#include <stdexcept>

namespace raya {

ClockAnchor anchor_between(std::uint64_t before, std::uint64_t queued, std::uint64_t after) {
    if (before <= queued && queued <= after) return {};
    const std::uint64_t half = (after - before) / 2;
    return {.same_clock = false,
            .offset_ns = static_cast<std::int64_t>(before + half) - static_cast<std::int64_t>(queued),
            .uncertainty_ns = half + (after - before) % 2};
}

ClockAnchor clock_anchor(Session& session) {
    if (!session.profile().timed()) throw std::logic_error("clock_anchor: the device does not time its commands");
    constexpr int kTries = 16;
    Buffer<std::uint32_t> word = session.buffer<std::uint32_t>("anchor of clocks", 1);
    std::uint64_t shortest = ~std::uint64_t{0};
    ClockAnchor best;
    for (int i = 0; i < kTries; ++i) {
        session.clear_profile();
        const std::uint64_t before = host_clock_ns();
        session.fill("anchor", word, 0);
        const std::uint64_t after = host_clock_ns();
        const std::uint64_t queued = session.profile().commands().back().queued;
        if (after - before >= shortest) continue;
        shortest = after - before;
        best = anchor_between(before, queued, after);
    }
    session.clear_profile();
    return best;
}

}  // namespace raya
