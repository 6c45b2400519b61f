// Tests of the selection of the PEs that a trace contains.
#include <algorithm>
#include <catch2/catch.hpp>

#include "host/report/trace_file.hpp"
#include "host/scene/split_mix.hpp"

namespace raya {

TEST_CASE("traced_pes: returns the given number of PEs, including the busiest and the idlest", "[report]") {
    for (std::uint64_t seed = 0; seed < 500; ++seed) {
        SplitMix random(seed);
        std::vector<std::uint64_t> loads(1 + random.next() % 70);
        for (std::uint64_t& load : loads) load = random.next() % (1 + random.next() % 100);
        const std::size_t limit = random.next() % 80;
        CAPTURE(seed, limit, loads);
        const std::vector<TracedPe> traced = traced_pes(loads, limit);
        REQUIRE(traced.size() == std::min(limit, loads.size()));
        std::vector<std::uint32_t> numbers;
        for (const TracedPe& t : traced) numbers.push_back(t.pe);
        CHECK(std::is_sorted(numbers.begin(), numbers.end()));
        CHECK(std::adjacent_find(numbers.begin(), numbers.end()) == numbers.end());
        for (const std::uint32_t pe : numbers) CHECK(pe < loads.size());
        const auto contains = [&](auto load) {
            return std::count(numbers.begin(), numbers.end(), static_cast<std::uint32_t>(load - loads.begin())) == 1;
        };
        if (limit > 0) CHECK(contains(std::max_element(loads.begin(), loads.end())));
        if (limit > 3) CHECK(contains(std::min_element(loads.begin(), loads.end())));
        const auto remarked = [&](const char* remark) { return std::ranges::count(traced, remark, &TracedPe::remark); };
        CHECK(remarked("busiest") == static_cast<std::ptrdiff_t>((traced.size() + 3) / 4));
        CHECK(remarked("idlest") <= static_cast<std::ptrdiff_t>(traced.size() / 4));
    }
}

}  // namespace raya
