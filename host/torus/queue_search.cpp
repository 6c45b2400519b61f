#include "host/torus/queue_search.hpp"

#include <fmt/core.h>

#include <algorithm>

#include "host/error.hpp"
#include "host/torus/bisection.hpp"

namespace raya {
namespace {

// Twice as long; the longest that fits, where twice as long does not.
std::uint32_t next_queue(std::uint32_t tried, const QueueTrial& trial) {
    const auto fits = [&](std::uint32_t queue) { return trial.bytes(buffers_for(queue)) <= trial.limit; };
    const std::uint32_t next = std::min(2 * tried, trial.most);
    if (!fits(tried) || fits(next)) return next;
    const std::uint32_t longest = last_that_holds(tried, next, fits);
    return longest > tried ? longest : next;
}

}  // namespace

QueueFound longer_queue(std::uint32_t queue, const QueueTrial& trial) {
    QueueFound found{.queue = queue};
    try {
        while (!found.ends && found.queue < trial.most) {
            const std::uint32_t next = next_queue(found.queue, trial);
            const NodeBuffers buffers = buffers_for(next);
            if (!trial.device_holds(buffers)) break;
            found.ends = trial.ends(buffers);
            found.queue = next;
        }
    } catch (const DeviceError&) {  // a machine with that queue does not fit into the device
    }
    found.bytes = trial.bytes(buffers_for(found.queue));
    found.fits = found.bytes <= trial.limit;
    return found;
}

std::string queue_remedy(const QueueFound& found) {
    if (!found.ends)
        return fmt::format(
            "no queue up to {} packets is long enough, and the device cannot hold longer ones; use fewer nodes",
            found.queue);
    if (found.fits) return fmt::format("--queue {} is long enough (tried)", found.queue);
    return fmt::format("no queue that fits a node's memory is long enough, --queue {} --pe-memory {} is (tried)",
                       found.queue, (found.bytes + 1023) / 1024 * 1024);
}

}  // namespace raya
