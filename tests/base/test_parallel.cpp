#include <atomic>
#include <catch2/catch.hpp>
#include <stdexcept>
#include <vector>

#include "host/base/parallel.hpp"

using namespace raya;

TEST_CASE("parallel_for calls the work once for each index", "[parallel]") {
    for (const unsigned threads : {1u, 2u, 7u})
        for (const std::size_t count : {0, 1, 2, 1000}) {
            std::vector<std::atomic<int>> calls(count);
            parallel_for(count, threads, [&](std::size_t i) { ++calls.at(i); });
            for (const auto& number : calls) CHECK(number == 1);
        }
}

TEST_CASE("parallel_for throws the work's exception to the caller, and starts no further work", "[parallel]") {
    for (const unsigned threads : {1u, 3u}) {
        std::atomic<int> calls{0};
        const auto work = [&](std::size_t i) {
            ++calls;
            if (i == 5) throw std::runtime_error("five");
        };
        CHECK_THROWS_WITH(parallel_for(1'000'000, threads, work), "five");
        CHECK(calls < 1'000'000);
    }
}
