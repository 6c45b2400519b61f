// The queue that is named to a machine that stands still: long enough, and one that can be asked for.
#include <catch2/catch.hpp>
#include <vector>

#include "host/error.hpp"
#include "host/torus/queue_search.hpp"

namespace raya {
namespace {

// A machine that ends with queues of `enough` packets or more; a packet has 10 bytes. Notes what was tried.
struct Machine {
    std::uint32_t enough;
    std::uint64_t limit = UINT64_MAX;
    std::uint32_t device = UINT32_MAX;  // longer ones do not fit into the device
    std::vector<std::uint32_t> tried{};

    std::string remedy(std::uint32_t queue) {
        return longer_queue(queue, {[](const NodeBuffers& b) { return std::uint64_t{10} * b.queue; }, limit,
                                    [this](const NodeBuffers& b) {
                                        tried.push_back(b.queue);
                                        if (b.queue > device) throw DeviceError("too long");
                                        return b.queue >= enough;
                                    }});
    }
};

using Queues = std::vector<std::uint32_t>;

}  // namespace

TEST_CASE("queues are doubled until the machine ends", "[torus]") {
    Machine machine{.enough = 100};
    CHECK(machine.remedy(20) == "--queue 160 is long enough (tried)");
    CHECK(machine.tried == Queues{40, 80, 160});
}

TEST_CASE("of queues that fit a node's memory the longest is tried before longer ones", "[torus]") {
    Machine machine{.enough = 65, .limit = 10 * 67 + 9};
    CHECK(machine.remedy(37) == "--queue 67 is long enough (tried)");
    CHECK(machine.tried == Queues{67});
}

TEST_CASE("where no queue that fits will do, the memory is named too", "[torus]") {
    Machine machine{.enough = 500, .limit = 10 * 100};
    CHECK(machine.remedy(30) ==
          "no queue that fits a node's memory is long enough, --queue 800 --pe-memory 8192 is (tried)");
    CHECK(machine.tried == Queues{60, 100, 200, 400, 800});
}

TEST_CASE("a queue that is the longest that fits already is not tried again", "[torus]") {
    Machine machine{.enough = 101, .limit = 10 * 100};
    CHECK(machine.remedy(100) ==
          "no queue that fits a node's memory is long enough, --queue 200 --pe-memory 2048 is (tried)");
    CHECK(machine.tried == Queues{200});
}

TEST_CASE("the search ends where the device cannot hold more", "[torus]") {
    Machine machine{.enough = 5000, .device = 300};
    CHECK(machine.remedy(50) ==
          "no queue up to 200 packets is long enough, and the device cannot hold longer ones; use fewer nodes");
    Machine endless{.enough = UINT32_MAX};
    CHECK(endless.remedy(1).find("no queue up to 1073741824 packets") == 0);
}

}  // namespace raya
