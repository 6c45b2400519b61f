#include "host/torus/queue_search.hpp"

#include <fmt/format.h>

#include "host/error.hpp"

namespace raya {
namespace {

constexpr std::uint32_t kLongest = 1u << 30;  // packets

bool fits(std::uint32_t queue, const QueueTrial& trial) { return trial.bytes(buffers_for(queue)) <= trial.limit; }

// The longest that fits, of `fitting`, which does, and those below `above`, which does not.
std::uint32_t longest_fitting(std::uint32_t fitting, std::uint32_t above, const QueueTrial& trial) {
    while (above - fitting > 1) {
        const std::uint32_t middle = fitting + (above - fitting) / 2;
        (fits(middle, trial) ? fitting : above) = middle;
    }
    return fitting;
}

}  // namespace

std::string longer_queue(std::uint32_t queue, const QueueTrial& trial) {
    std::uint32_t tried = queue;
    try {
        while (tried < kLongest) {
            std::uint32_t next = 2 * tried;
            if (fits(tried, trial) && !fits(next, trial)) {
                const std::uint32_t longest = longest_fitting(tried, next, trial);
                if (longest > tried) next = longest;
            }
            if (trial.ends(buffers_for(next))) {
                if (fits(next, trial)) return fmt::format("--queue {} is long enough (tried)", next);
                return fmt::format(
                    "no queue that fits a node's memory is long enough, --queue {} --pe-memory {} is (tried)", next,
                    (trial.bytes(buffers_for(next)) + 1023) / 1024 * 1024);
            }
            tried = next;
        }
    } catch (const DeviceError&) {  // a machine with that queue does not fit into the device
    } catch (const UserError&) {    // the same, known beforehand
    }
    return fmt::format(
        "no queue up to {} packets is long enough, and the device cannot hold longer ones; use fewer nodes", tried);
}

}  // namespace raya
