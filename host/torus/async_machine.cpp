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
      caused_(tasks_of_messages(history)),
      arrived_(history.messages.size()),
      nodes_(raya_nodes(torus)),
      ways_(nodes_.size() * RAYA_LINKS) {
    for (std::uint32_t link = 0; link < ways_.size(); ++link) {
        Way& way = ways_[link];
        way.start = link / RAYA_LINKS;
        way.end = raya_link_end(torus, way.start, link % RAYA_LINKS);
        way.back = way.end * RAYA_LINKS + (link % RAYA_LINKS ^ 1u);
    }
    for (std::uint32_t task = 0; task < history.tasks.size(); ++task)
        if (history.tasks[task].cause == HistoryTask::kInjection) nodes_[history.tasks[task].node].own.push_back(task);
    result_.nodes.resize(nodes_.size());
    result_.links.resize(ways_.size());
}

void AsyncSimulation::foresee(double after, What what, std::uint32_t place, std::uint32_t version) {
    events_.push({now_ + after, foreseen_++, what, place, version});
}

AsyncResult AsyncSimulation::run() {
    for (std::uint32_t node = 0; node < nodes_.size(); ++node) next_task(node);
    while (!events_.empty()) {
        const Event event = events_.top();
        events_.pop();
        happen(event);
    }
    if (done_ < history_.tasks.size() || result_.delivered < history_.messages.size())
        throw std::runtime_error(fmt::format("the asynchronous torus stands still: {} of {} messages delivered",
                                             result_.delivered, history_.messages.size()));
    return std::move(result_);
}

void AsyncSimulation::happen(const Event& event) {
    const bool holds =
        event.what == What::kMessageDone ||
        event.version == (event.what == What::kMainDone ? nodes_[event.place].version : ways_[event.place].version);
    if (!holds) return;  // it was put off, and foreseen anew
    now_ = event.time;
    result_.finish_ms = now_ * kMsPerNs;
    if (event.what == What::kMessageDone) finish_job(event.place);
    if (event.what == What::kMainDone) finish_task(event.place);
    if (event.what == What::kCarried) end_carrying(event.place);
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
    if (machine.entering < 1 || machine.buffer < machine.entering)
        throw UserError(fmt::format("a port with room for {} messages, of which {} must be free for a ray to enter",
                                    machine.buffer, machine.entering));
    check_history(history, raya_nodes(torus));
    return AsyncSimulation(torus, history, machine).run();
}

}  // namespace raya
