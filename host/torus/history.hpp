// The history of a render on the torus: what nodes computed, and the messages by which one thing led to another,
// without supersteps. What is computed and sent does not depend on when it is: so a history holds for any order in
// time.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

namespace raya {

/// Computing of one node without a pause: one packet's treatment, or the making of one primary ray.
struct HistoryTask {
    static constexpr std::uint32_t kInjection = UINT32_MAX;  // as a cause: the node begins it by itself

    std::uint32_t node = 0;
    std::uint32_t cause = kInjection;  // the message whose arrival starts it
    std::uint64_t cycles = 0;          // modelled
    std::uint32_t first = 0;           // of its messages, which lie one after another
};

/// A packet that a task has made or changed: a ray for the node that treats it next, which may be the task's own, or a
/// return for the root.
struct HistoryMessage {
    std::uint32_t task = 0;  // that sends it, at its end
    std::uint32_t to = 0;    // node
    std::uint16_t words = 0;
    std::uint16_t kind = 0;  // RAYA_KIND_* of kernels/shared/packet.h
};

/// A task comes behind the message that causes it, messages lie in the order of their tasks; the tasks that a node
/// begins by itself are in the order in which it does.
struct History {
    std::vector<HistoryTask> tasks;
    std::vector<HistoryMessage> messages;

    std::span<const HistoryMessage> sent_by(std::size_t task) const;
};

/// std::logic_error unless all that is said above holds, every ray causes one task, at the node where it goes, and
/// every return none, and goes to the root.
void check_history(const History& history, std::uint32_t nodes);

/// Of each message the task that it causes; HistoryTask::kInjection for a return.
std::vector<std::uint32_t> tasks_of_messages(const History& history);

}  // namespace raya
