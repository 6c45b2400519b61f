// The measured offset of each rank's clock from rank 0's is correct within its stated uncertainty.
#include <catch2/catch.hpp>
#include <chrono>

#include "host/ranks/ranks.hpp"
#include "tests/ranks/thread_ranks.hpp"

namespace raya {

TEST_CASE("clocks that are hours apart are aligned within the stated uncertainty", "[ranks]") {
    const std::int64_t ahead[] = {0, 5'000'000'000'000, -7'000'000'000'000, 12'345};  // of each rank, ns
    std::mutex mutex;
    std::vector<std::pair<std::uint32_t, RankClock>> found;
    on_ranks(4, [&](Ranks& ranks) {
        const auto now = [&] {
            const auto since = std::chrono::steady_clock::now().time_since_epoch();
            return static_cast<std::uint64_t>(std::chrono::nanoseconds(since).count() + 100'000'000'000'000 +
                                              ahead[ranks.rank()]);
        };
        const RankClock clock = rank_clock(ranks, now);
        const std::lock_guard lock(mutex);
        found.emplace_back(ranks.rank(), clock);
    });
    REQUIRE(found.size() == 4);
    for (const auto& [rank, clock] : found) {
        CAPTURE(rank, clock.offset_ns, clock.uncertainty_ns);
        CHECK(std::abs(clock.offset_ns + ahead[rank]) <= static_cast<std::int64_t>(clock.uncertainty_ns) + 1);
        CHECK(clock.uncertainty_ns < 1'000'000'000);
    }
}

}  // namespace raya
