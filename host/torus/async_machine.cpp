#include "host/torus/async_machine.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <stdexcept>

#include "host/error.hpp"
#include "host/torus/async_simulation.hpp"

namespace raya {

AsyncSimulation::AsyncSimulation(const raya_torus& torus, const History& history, const AsyncMachine& machine)
    : torus_(torus),
      history_(history),
      machine_(machine),
      task_of_message_(tasks_of_messages(history)),
      delivered_(history.messages.size()),
      nodes_(raya_nodes(torus)),
      channels_(nodes_.size() * RAYA_LINKS) {
    for (std::uint32_t i = 0; i < channels_.size(); ++i) {
        Channel& channel = channels_[i];
        channel.start = i / RAYA_LINKS;
        channel.end = raya_link_end(torus, channel.start, i % RAYA_LINKS);
        channel.opposite = channel.end * RAYA_LINKS + (i % RAYA_LINKS ^ 1u);
    }
    for (std::uint32_t task = 0; task < history.tasks.size(); ++task)
        if (history.tasks[task].cause == HistoryTask::kNoCause)
            nodes_[history.tasks[task].node].injection_tasks.push_back(task);
    result_.nodes.resize(nodes_.size());
    result_.links.resize(channels_.size());
}

void AsyncSimulation::schedule(double delay_ns, EventKind kind, std::uint32_t location, std::uint32_t version) {
    events_.push({now_ + delay_ns, event_count_++, kind, location, version});
}

AsyncResult AsyncSimulation::run() {
    for (std::uint32_t node = 0; node < nodes_.size(); ++node) start_next_task(node);
    while (!events_.empty()) {
        const Event event = events_.top();
        events_.pop();
        handle(event);
    }
    if (finished_tasks_ < history_.tasks.size() || result_.delivered < history_.messages.size())
        throw std::runtime_error(fmt::format("deadlock of the asynchronous torus: {} of {} messages delivered",
                                             result_.delivered, history_.messages.size()));
    return std::move(result_);
}

void AsyncSimulation::handle(const Event& event) {
    const bool valid = event.kind == EventKind::kJobDone ||
                       event.version == (event.kind == EventKind::kTaskDone ? nodes_[event.location].version
                                                                            : channels_[event.location].version);
    if (!valid) return;  // the event is obsolete
    now_ = event.time;
    result_.finish_ms = now_ * kMsPerNs;
    if (event.kind == EventKind::kJobDone) finish_job(event.location);
    if (event.kind == EventKind::kTaskDone) finish_task(event.location);
    if (event.kind == EventKind::kTransferDone) end_transfer(event.location);
}

AsynchronousTime AsyncResult::time() const {
    AsynchronousTime time{.finish_ms = finish_ms, .delivered = delivered};
    for (const AsyncNode& node : nodes) {
        time.processor_ms = std::max(time.processor_ms, node.compute_ms + node.messages_ms);
        time.port_ms = std::max(time.port_ms, node.port_ms);
        time.queue_max = std::max(time.queue_max, node.queue_max);
    }
    for (const AsyncLink& link : links) time.links_ms = std::max(time.links_ms, link.busy_ms);
    return time;
}

AsyncResult simulate(const raya_torus& torus, const History& history, const AsyncMachine& machine) {
    if (machine.entry_slots < 1 || machine.buffer < machine.entry_slots)
        throw UserError(
            fmt::format("ports of {} slots (buffer), of which {} must be free for a ray to enter a ring (entry_slots): "
                        "entry_slots must be at least 1 and at most buffer",
                        machine.buffer, machine.entry_slots));
    check_history(history, raya_nodes(torus));
    return AsyncSimulation(torus, history, machine).run();
}

}  // namespace raya
