// Random histories for tests, and the link traffic of a history's messages.
#pragma once
#include <cstdint>
#include <deque>
#include <vector>

#include "host/torus/history.hpp"
#include "host/torus/torus_result.hpp"
#include "tests/torus/random_torus.hpp"

namespace raya {

/// Builds a history task by task.
class HistoryBuilder {
  public:
    /// Adds a task of the node, started by the message `cause` or by injection; returns the task's number.
    std::uint32_t add_task(std::uint32_t node, std::uint64_t cycles, std::uint32_t cause = HistoryTask::kNoCause) {
        history.tasks.push_back({.node = node,
                                 .cause = cause,
                                 .cycles = cycles,
                                 .first_message = static_cast<std::uint32_t>(history.messages.size())});
        return static_cast<std::uint32_t>(history.tasks.size()) - 1;
    }
    /// add_ray() adds a ray from the most recently added task to node `destination`; add_return() adds a return from
    /// this task to the root. Both functions return the message's number.
    std::uint32_t add_ray(std::uint32_t destination) { return send(destination, RAYA_PACKET_WORDS, RAYA_KIND_PRIMARY); }
    std::uint32_t add_return() { return send(RAYA_ROOT, RAYA_RETURN_WORDS, RAYA_KIND_RETURN); }

    History history;

  private:
    std::uint32_t send(std::uint32_t destination, std::uint16_t words, std::uint16_t kind) {
        history.messages.push_back({static_cast<std::uint32_t>(history.tasks.size()) - 1, destination, words, kind});
        return static_cast<std::uint32_t>(history.messages.size()) - 1;
    }
};

/// Returns a history of about `max_tasks` tasks, each of fewer than 4,000 cycles. Either all injected tasks start at
/// the root, or each starts at a random node. Rays have 8, 16 or 24 words and any destination, including their sender.
inline History random_history(SplitMix& random, const raya_torus& torus, std::uint32_t max_tasks) {
    struct PendingTask {
        std::uint32_t node, cause;
    };
    const std::uint32_t nodes = raya_nodes(torus), injected_tasks = 1 + random_below(random, max_tasks / 4);
    const bool starts_at_root = random.next() % 3 == 0;
    const std::uint32_t max_cycles = 1 + random_below(random, 4000);
    std::deque<PendingTask> pending;
    for (std::uint32_t i = 0; i < injected_tasks; ++i)
        pending.push_back({starts_at_root ? RAYA_ROOT : random_below(random, nodes), HistoryTask::kNoCause});
    HistoryBuilder builder;
    while (!pending.empty()) {
        const PendingTask next = pending.front();
        pending.pop_front();
        builder.add_task(next.node, random_below(random, max_cycles), next.cause);
        const bool adds_rays = builder.history.tasks.size() + pending.size() < max_tasks;
        const std::uint32_t rays = adds_rays ? random_below(random, 4) : 0;
        for (std::uint32_t i = 0; i < rays; ++i) {
            const std::uint32_t destination = random.next() % 4 == 0 ? next.node : random_below(random, nodes);
            pending.push_back({destination, builder.add_ray(destination)});
            builder.history.messages.back().words = static_cast<std::uint16_t>(8 + 8 * random_below(random, 3));
        }
        for (std::uint32_t i = random_below(random, 3); i > 0; --i) builder.add_return();
    }
    return builder.history;
}

/// Returns a TorusResult with the members that torus_time() reads: the load of each node in cycles, and the numbers of
/// words and messages on each link according to the routing rules.
inline TorusResult traffic_of(const raya_torus& torus, const History& history) {
    TorusResult result;
    std::vector<std::uint64_t> loads(raya_nodes(torus));
    result.link_words.resize(loads.size() * RAYA_LINKS);
    result.link_packets.resize(loads.size() * RAYA_LINKS);
    for (const HistoryTask& task : history.tasks) loads[task.node] += task.cycles;
    for (const HistoryMessage& message : history.messages)
        for (std::uint32_t node = history.tasks[message.task].node; node != message.destination;) {
            const bool is_return = message.kind == RAYA_KIND_RETURN;
            const std::uint32_t link =
                is_return ? raya_return_link(torus, node) : raya_next_link(torus, node, message.destination);
            result.link_words[node * RAYA_LINKS + link] += message.words;
            ++result.link_packets[node * RAYA_LINKS + link];
            node = raya_link_end(torus, node, link);
        }
    result.load = load_of(std::move(loads));
    return result;
}

}  // namespace raya
