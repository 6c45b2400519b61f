// The processors: the communication task, message by message, and the main task, ray by ray.
#include <algorithm>
#include <stdexcept>

#include "host/torus/async_simulation.hpp"

namespace raya {

// The communication task goes first; the main task has what is left.
void AsyncSimulation::add_job(std::uint32_t node, const MessageJob& job) {
    nodes_[node].jobs.push_back(job);
    work(node);
}

void AsyncSimulation::stop_main(Node& n) {
    if (n.task == kNone || !n.computes) return;
    n.left -= now_ - n.since;
    n.computes = false;
    ++n.version;
}

void AsyncSimulation::work(std::uint32_t node) {
    Node& n = nodes_[node];
    if (n.in_job) return;
    if (!n.jobs.empty()) {
        stop_main(n);
        n.in_job = true;
        const std::uint32_t words = history_.messages[n.jobs.front().message].words;
        const double ns = machine_.cycle_ns * (machine_.message_cycles + machine_.word_cycles * words);
        result_.nodes[node].messages_ms += ns * kMsPerNs;
        return foresee(ns, What::kMessageDone, node, 0);
    }
    if (n.task == kNone || n.computes || n.sent != kNone) return;
    n.computes = true;
    n.since = now_;
    foresee(std::max(0.0, n.left), What::kMainDone, node, ++n.version);
}

void AsyncSimulation::finish_job(std::uint32_t node) {
    Node& n = nodes_[node];
    const MessageJob job = n.jobs.front();
    n.jobs.pop_front();
    n.in_job = false;
    if (job.arrives)
        arrive(job.link, job.message);
    else
        begin_to_carry(job.link);
    work(node);
}

// A ray that waits, or else one that is still to be made.
void AsyncSimulation::next_task(std::uint32_t node) {
    Node& n = nodes_[node];
    if (n.task != kNone || (n.queue.empty() && n.own.empty())) return;
    if (!n.queue.empty()) {
        n.task = caused_[n.queue.front()];
        n.queue.pop_front();
    } else {
        n.task = n.own.front();
        n.own.pop_front();
    }
    n.sent = kNone;
    n.left = machine_.cycle_ns * static_cast<double>(history_.tasks[n.task].cycles);
    result_.nodes[node].compute_ms += n.left * kMsPerNs;
    work(node);
}

void AsyncSimulation::finish_task(std::uint32_t node) {
    Node& n = nodes_[node];
    n.computes = false;
    n.sent = 0;
    ++done_;
    send_made(node);
}

// Goes on with what the main task has made, until it waits for a port or all is sent.
void AsyncSimulation::send_made(std::uint32_t node) {
    Node& n = nodes_[node];
    const std::span<const HistoryMessage> made = history_.sent_by(n.task);
    while (n.sent < made.size()) {
        const std::uint32_t message = history_.tasks[n.task].first + n.sent;
        const std::uint32_t link = way_on(node, message);
        if (link == kNone) {
            ++n.sent;
            deliver(message);
            continue;
        }
        const std::uint32_t needs = class_of(message) == 1 ? machine_.entering : 1;
        if (!put(link, {kNone, message, needs})) {
            n.port_since = now_;
            return;
        }
        ++n.sent;
    }
    n.task = kNone;
    next_task(node);
}

void AsyncSimulation::deliver(std::uint32_t message) {
    if (arrived_[message]) throw std::logic_error("async: a message arrives twice");
    arrived_[message] = true;
    ++result_.delivered;
    if (caused_[message] == HistoryTask::kInjection) return;
    const std::uint32_t node = history_.messages[message].to;
    auto& queue = nodes_[node].queue;
    queue.push_back(message);
    result_.nodes[node].queue_max = std::max<std::uint64_t>(result_.nodes[node].queue_max, queue.size());
    next_task(node);
}

}  // namespace raya
