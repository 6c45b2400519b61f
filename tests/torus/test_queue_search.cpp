// The search for a queue that is long enough to avoid a deadlock. The limits of the search are the memory of a node,
// the memory of the device and a maximum length.
#include <catch2/catch.hpp>
#include <vector>

#include "host/error.hpp"
#include "host/torus/buffer_plan.hpp"

namespace raya {
namespace {

// A machine that finishes if its queues hold at least `sufficient_queue` packets of 10 bytes. It records the lengths
// that the search tries.
struct SimulatedMachine {
    std::uint32_t sufficient_queue;
    std::uint64_t node_memory = UINT64_MAX;
    std::uint32_t device_limit = UINT32_MAX;  // longest queue that fits the device, packets
    std::uint32_t driver_limit = UINT32_MAX;  // longest queue that the driver allocates, packets
    std::uint32_t max_queue = kMaxQueue;
    std::vector<std::uint32_t> tried{};

    std::string remedy(std::uint32_t queue) { return queue_remedy(search(queue)); }

    QueueSearchResult search(std::uint32_t queue) {
        const auto bytes = [](const NodeBuffers& b) { return std::uint64_t{10} * b.queue; };
        const auto fits = [this](const NodeBuffers& b) { return b.queue <= device_limit; };
        const auto completes = [this](const NodeBuffers& b) {
            tried.push_back(b.queue);
            if (b.queue > driver_limit) throw DeviceError("the driver cannot allocate the queues");
            return b.queue >= sufficient_queue;
        };
        return find_longer_queue(queue, {.node_bytes = bytes,
                                         .node_memory = node_memory,
                                         .max_queue = max_queue,
                                         .fits_device = fits,
                                         .completes = completes});
    }
};

using Queues = std::vector<std::uint32_t>;

}  // namespace

TEST_CASE("the queue length is doubled until the machine finishes", "[torus]") {
    SimulatedMachine machine{.sufficient_queue = 100};
    CHECK(machine.remedy(20) == "--queue 160 is long enough (tried)");
    CHECK(machine.tried == Queues{40, 80, 160});
}

TEST_CASE("the longest queue that fits a node's memory is tried before longer ones", "[torus]") {
    SimulatedMachine machine{.sufficient_queue = 65, .node_memory = 10 * 67 + 9};
    CHECK(machine.remedy(37) == "--queue 67 is long enough (tried)");
    CHECK(machine.tried == Queues{67});
}

TEST_CASE("if no queue that fits is long enough, the remedy also names the memory", "[torus]") {
    SimulatedMachine machine{.sufficient_queue = 500, .node_memory = 10 * 100};
    CHECK(machine.remedy(30) ==
          "no queue that fits a node's memory is long enough; use --queue 800 --pe-memory 8192 (tried)");
    CHECK(machine.tried == Queues{60, 100, 200, 400, 800});
}

TEST_CASE("if the queue that deadlocked is the longest that fits, it is not tried again", "[torus]") {
    SimulatedMachine machine{.sufficient_queue = 101, .node_memory = 10 * 100};
    CHECK(machine.remedy(100) ==
          "no queue that fits a node's memory is long enough; use --queue 200 --pe-memory 2048 (tried)");
    CHECK(machine.tried == Queues{200});
}

TEST_CASE("the search ends at the longest queue that the device holds", "[torus]") {
    SimulatedMachine machine{.sufficient_queue = 5000, .device_limit = 300};
    CHECK(machine.remedy(50) ==
          "no queue up to 200 packets is long enough, and the device cannot hold longer ones; use fewer nodes");
    CHECK(machine.tried == Queues{100, 200});
    SimulatedMachine limited_by_driver{.sufficient_queue = 5000, .driver_limit = 300};
    CHECK(limited_by_driver.remedy(50) == machine.remedy(50));
    CHECK(limited_by_driver.tried == Queues{100, 200, 400});
    SimulatedMachine endless{.sufficient_queue = UINT32_MAX};
    CHECK(endless.remedy(1).find("no queue up to 1073741824 packets") == 0);
}

TEST_CASE("a search with a maximum length tries the maximum last", "[torus]") {
    SimulatedMachine machine{.sufficient_queue = 90, .max_queue = 100};
    const QueueSearchResult found = machine.search(30);
    CHECK(machine.tried == Queues{60, 100});
    CHECK((found.completes && found.fits));
    CHECK(found.queue == 100);
    CHECK(found.bytes == 1000);
    machine.sufficient_queue = 101;
    CHECK_FALSE(machine.search(30).completes);
}

TEST_CASE("bisection finds the last number that satisfies the predicate, in at most 32 calls", "[torus]") {
    for (const std::uint64_t above : {6ull, 7ull, 1000ull, 1ull << 32})
        for (const std::uint64_t last : {5ull, 6ull, 999ull, (1ull << 32) - 1}) {
            if (last >= above) continue;
            int calls = 0;
            const auto holds = [&](std::uint32_t number) {
                ++calls;
                return number <= last;
            };
            CAPTURE(above, last);
            CHECK(largest_where(5, above, holds) == last);
            CHECK(calls <= 32);
        }
}

}  // namespace raya
