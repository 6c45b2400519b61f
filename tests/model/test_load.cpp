// Loads of PEs, and the papers' measures of them.
#include <catch2/catch.hpp>
#include <cstdint>
#include <vector>

#include "host/model/t805.hpp"

using namespace raya;

TEST_CASE("load_of() computes mean, imbalance, speed-up and efficiency", "[report]") {
    const Load load = load_of({1, 4, 2, 3});
    CHECK(load.per_pe == std::vector<std::uint64_t>{1, 4, 2, 3});
    CHECK(load.min == 1);
    CHECK(load.max == 4);
    CHECK(load.mean == 2.5);
    CHECK(load.imbalance == Approx(0.6));  // (4 - 2.5) / 2.5
    CHECK(load.speedup == 2.5);            // 10 / 4
    CHECK(load.efficiency == 0.625);       // 2.5 / 4
}

TEST_CASE("equal loads, a single PE and zero loads are balanced", "[report]") {
    for (const auto& per_pe :
         {std::vector<std::uint64_t>(7, 12), std::vector<std::uint64_t>{5}, std::vector<std::uint64_t>(3, 0)}) {
        const Load load = load_of(per_pe);
        CAPTURE(per_pe);
        CHECK(load.imbalance == 0);
        CHECK(load.speedup == static_cast<double>(per_pe.size()));
        CHECK(load.efficiency == 1);
    }
}

// Kohata & Ito 1993, Tables 2 and 3: 64,800 ms on one PE; 653 ms (p = 0) and 283 ms (p = 16) on 256 PEs.
TEST_CASE("the loads of the paper's tables give the paper's imbalance and speed-up", "[report]") {
    const auto with_busiest = [](std::uint64_t busiest_us) {  // time of the busiest PE, microseconds
        constexpr std::uint64_t kSum = 64'800'000;            // time on one PE, microseconds
        std::vector<std::uint64_t> per_pe(256, (kSum - busiest_us) / 255);
        per_pe[100] = busiest_us;
        return load_of(per_pe);
    };
    CHECK(with_busiest(653'000).imbalance == Approx(1.580).margin(0.0005));
    CHECK(with_busiest(653'000).speedup == Approx(99.2).margin(0.05));
    CHECK(with_busiest(283'000).imbalance == Approx(0.118).margin(0.0005));
    CHECK(with_busiest(283'000).speedup == Approx(229.0).margin(0.05));
    CHECK(with_busiest(283'000).efficiency == Approx(0.894).margin(0.0005));
}

TEST_CASE("loads beyond 32 bits are summed exactly", "[report]") {
    const Load load = load_of({std::uint64_t{1} << 40, std::uint64_t{3} << 40});
    CHECK(load.mean == 0x1p41);
    CHECK(load.max == std::uint64_t{3} << 40);
    CHECK(load.imbalance == 0.5);
}
