// The measured offset between each rank's clock and rank 0's clock is correct within its reported uncertainty.
#include <catch2/catch.hpp>
#include <chrono>

#include "host/ranks/ranks.hpp"
#include "tests/ranks/thread_ranks.hpp"

namespace raya {

TEST_CASE("clocks that are hours apart are aligned within the reported uncertainty", "[ranks]") {
    // [rank]: time by which the rank's clock is ahead of rank 0's clock
    const std::int64_t lead_ns[] = {0, 5'000'000'000'000, -7'000'000'000'000, 12'345};
    std::mutex mutex;
    std::vector<std::pair<std::uint32_t, RankClock>> clocks;
    on_ranks(4, [&](Ranks& ranks) {
        const auto now = [&] {
            const auto since_epoch = std::chrono::steady_clock::now().time_since_epoch();
            return static_cast<std::uint64_t>(std::chrono::nanoseconds(since_epoch).count() + 100'000'000'000'000 +
                                              lead_ns[ranks.rank()]);
        };
        const RankClock clock = rank_clock(ranks, now);
        const std::lock_guard lock(mutex);
        clocks.emplace_back(ranks.rank(), clock);
    });
    REQUIRE(clocks.size() == 4);
    for (const auto& [rank, clock] : clocks) {
        CAPTURE(rank, clock.offset_ns, clock.uncertainty_ns);
        CHECK(std::abs(clock.offset_ns + lead_ns[rank]) <= static_cast<std::int64_t>(clock.uncertainty_ns) + 1);
        CHECK(clock.uncertainty_ns < 1'000'000'000);
    }
}

}  // namespace raya
