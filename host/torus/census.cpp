#include "host/torus/census.hpp"

#include <algorithm>

namespace raya {
namespace {

std::uint64_t cycles_of(const NodeStatus& status, std::uint32_t node) {
    return status.at(node, RAYA_STATUS_CYCLES) | std::uint64_t{status.at(node, RAYA_STATUS_CYCLES + 1)} << 32;
}

}  // namespace

std::vector<std::uint64_t> cycles_of_nodes(const NodeStatus& status, std::uint32_t nodes) {
    std::vector<std::uint64_t> cycles;
    for (std::uint32_t node = 0; node < nodes; ++node) cycles.push_back(cycles_of(status, node));
    return cycles;
}

Census census_of(const NodeStatus& status, std::uint32_t nodes, std::uint32_t capacity) {
    Census c;
    std::uint64_t rows = 0, done = 0;
    for (std::uint32_t node = 0; node < nodes; ++node) {
        const auto at = [&](std::uint32_t word) { return status.at(node, word); };
        c.live += at(RAYA_STATUS_QUEUE) + at(RAYA_STATUS_HOST);
        for (std::uint32_t link = 0; link < RAYA_LINKS; ++link)
            c.live += at(RAYA_STATUS_OUTBOX + link) + at(RAYA_STATUS_INBOX + link) +
                      at(RAYA_STATUS_RETURN_OUTBOX + link) + at(RAYA_STATUS_RETURN_INBOX + link);
        c.fullest = std::max(c.fullest, at(RAYA_STATUS_QUEUE));
        c.full += at(RAYA_STATUS_QUEUE) >= capacity;
        c.progress += at(RAYA_STATUS_PROGRESS);
        c.cycles = std::max(c.cycles, cycles_of(status, node));
        c.all_made &= at(RAYA_STATUS_NEXT_ROW) >= at(RAYA_STATUS_ROWS);
        rows += at(RAYA_STATUS_ROWS);
        done += at(RAYA_STATUS_NEXT_ROW);
    }
    c.looked = rows ? static_cast<double>(done) / static_cast<double>(rows) : 1;
    return c;
}

}  // namespace raya
