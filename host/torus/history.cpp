#include "host/torus/history.hpp"

#include <fmt/core.h>

#include <stdexcept>

#include "kernels/shared/packet.h"

namespace raya {
namespace {

void require(bool right, std::size_t number, const char* what) {
    if (!right) throw std::logic_error(fmt::format("history: {} {}", what, number));
}

}  // namespace

std::span<const HistoryMessage> History::sent_by(std::size_t task) const {
    const std::size_t end = task + 1 < tasks.size() ? tasks[task + 1].first : messages.size();
    return std::span(messages).subspan(tasks[task].first, end - tasks[task].first);
}

std::vector<std::uint32_t> tasks_of_messages(const History& history) {
    std::vector<std::uint32_t> caused(history.messages.size(), HistoryTask::kInjection);
    for (std::size_t t = 0; t < history.tasks.size(); ++t) {
        const std::uint32_t cause = history.tasks[t].cause;
        if (cause == HistoryTask::kInjection) continue;
        require(cause < caused.size() && caused[cause] == HistoryTask::kInjection, t,
                "no message of its own causes task");
        caused[cause] = static_cast<std::uint32_t>(t);
    }
    return caused;
}

void check_history(const History& history, std::uint32_t nodes) {
    const auto& [tasks, messages] = history;
    require(tasks.empty() ? messages.empty() : tasks.front().first == 0, 0, "messages before task");
    for (std::size_t t = 0; t < tasks.size(); ++t) {
        const std::size_t end = t + 1 < tasks.size() ? tasks[t + 1].first : messages.size();
        require(tasks[t].node < nodes, t, "no node for task");
        require(tasks[t].first <= end && end <= messages.size(), t, "messages in disorder of task");
        for (std::size_t m = tasks[t].first; m < end; ++m)
            require(messages[m].task == t, m, "another task has message");
        require(tasks[t].cause == HistoryTask::kInjection || tasks[t].cause < tasks[t].first, t,
                "no cause before task");
    }
    const std::vector<std::uint32_t> caused = tasks_of_messages(history);
    for (std::size_t m = 0; m < messages.size(); ++m) {
        const bool returns = messages[m].kind == RAYA_KIND_RETURN, causes = caused[m] != HistoryTask::kInjection;
        require(messages[m].to < nodes && messages[m].words > 0, m, "no node or no word for message");
        require(causes != returns, m, returns ? "a task is caused by return" : "no task is caused by ray");
        require(returns ? messages[m].to == RAYA_ROOT : messages[m].to == tasks[caused[m]].node, m,
                "another node has the task of message");
    }
}

}  // namespace raya
