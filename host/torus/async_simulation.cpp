// First the processors (communication task, main task), then the links (output threads, transfers, input threads).
#include "host/torus/async_simulation.hpp"

#include <algorithm>
#include <stdexcept>

namespace raya {
namespace {

constexpr double kBytesPerWord = 4, kNsPerS = 1e9;

}  // namespace

// Adds a job of the communication task, which preempts the main task.
void AsyncSimulation::add_job(std::uint32_t node, const MessageJob& job) {
    nodes_[node].jobs.push_back(job);
    run_processor(node);
}

void AsyncSimulation::preempt_main(Node& n) {
    if (n.task == kNone || !n.computing) return;
    n.remaining -= now_ - n.remaining_since;
    n.computing = false;
    ++n.version;
}

void AsyncSimulation::run_processor(std::uint32_t node) {
    Node& n = nodes_[node];
    if (n.in_job) return;
    if (!n.jobs.empty()) {
        preempt_main(n);
        n.in_job = true;
        const std::uint32_t words = history_.messages[n.jobs.front().message].words;
        const double ns = machine_.cycle_ns * (machine_.message_cycles + machine_.word_cycles * words);
        result_.nodes[node].messages_ms += ns * kMsPerNs;
        return schedule(ns, EventKind::kMessageDone, node, 0);
    }
    if (n.task == kNone || n.computing || n.sent != kNone) return;
    n.computing = true;
    n.remaining_since = now_;
    schedule(std::max(0.0, n.remaining), EventKind::kTaskDone, node, ++n.version);
}

void AsyncSimulation::finish_job(std::uint32_t node) {
    Node& n = nodes_[node];
    const MessageJob job = n.jobs.front();
    n.jobs.pop_front();
    n.in_job = false;
    if (job.receiving)
        receive(job.link, job.message);
    else
        begin_transfer(job.link);
    run_processor(node);
}

// Starts the task of the first waiting ray, or, if none waits, the node's next task without a cause.
void AsyncSimulation::start_next_task(std::uint32_t node) {
    Node& n = nodes_[node];
    if (n.task != kNone || (n.queue.empty() && n.injection_tasks.empty())) return;
    if (!n.queue.empty()) {
        n.task = task_of_message_[n.queue.front()];
        n.queue.pop_front();
    } else {
        n.task = n.injection_tasks.front();
        n.injection_tasks.pop_front();
    }
    n.sent = kNone;
    n.remaining = machine_.cycle_ns * static_cast<double>(history_.tasks[n.task].cycles);
    result_.nodes[node].compute_ms += n.remaining * kMsPerNs;
    run_processor(node);
}

void AsyncSimulation::finish_task(std::uint32_t node) {
    Node& n = nodes_[node];
    n.computing = false;
    n.sent = 0;
    ++finished_tasks_;
    send_outputs(node);
}

// Sends the remaining messages of the current task until a port is full.
void AsyncSimulation::send_outputs(std::uint32_t node) {
    Node& n = nodes_[node];
    const std::span<const HistoryMessage> made = history_.sent_by(n.task);
    while (n.sent < made.size()) {
        const std::uint32_t message = history_.tasks[n.task].first_message + n.sent;
        const std::uint32_t link = next_channel(node, message);
        if (link == kNone) {
            ++n.sent;
            deliver(message);
            continue;
        }
        const std::uint32_t slots = class_of(message) == 1 ? machine_.entry_slots : 1;
        if (!enqueue(link, {kNone, message, slots})) {
            n.blocked_since = now_;
            return;
        }
        ++n.sent;
    }
    n.task = kNone;
    start_next_task(node);
}

void AsyncSimulation::deliver(std::uint32_t message) {
    if (delivered_[message]) throw std::logic_error("async: a message arrives twice");
    delivered_[message] = true;
    ++result_.delivered;
    if (task_of_message_[message] == HistoryTask::kInjection) return;
    const std::uint32_t node = history_.messages[message].to;
    auto& queue = nodes_[node].queue;
    queue.push_back(message);
    result_.nodes[node].queue_max = std::max<std::uint64_t>(result_.nodes[node].queue_max, queue.size());
    start_next_task(node);
}

// Returns the channel by which the message leaves the node; kNone if the node is its destination.
std::uint32_t AsyncSimulation::next_channel(std::uint32_t node, std::uint32_t message) const {
    const std::uint32_t to = history_.messages[message].to;
    if (node == to) return kNone;
    const std::uint32_t link =
        class_of(message) == 0 ? raya_return_link(torus_, node) : raya_next_link(torus_, node, to);
    return node * RAYA_LINKS + link;
}

// Puts the message into the output thread, or, if too few slots are free, adds it to the blocked messages and returns
// false.
bool AsyncSimulation::enqueue(std::uint32_t link, const BlockedMessage& from) {
    const std::uint32_t cls = class_of(from.message);
    Channel& channel = channels_[link];
    if (channel.out[cls].size() + from.slots_needed > machine_.buffer) {
        channel.blocked[cls].push_back(from);
        return false;
    }
    channel.out[cls].push_back(from.message);
    start_sending(link);
    return true;
}

// Called when a slot of an output thread has become free: admits the first blocked message for which enough slots are
// free. So a ray that stays in its ring can overtake a ray that waits to enter the ring.
void AsyncSimulation::admit_blocked(std::uint32_t link, std::uint32_t cls) {
    Channel& channel = channels_[link];
    for (;;) {
        auto& blocked = channel.blocked[cls];
        const auto fits = [&](const BlockedMessage& b) {
            return channel.out[cls].size() + b.slots_needed <= machine_.buffer;
        };
        const auto first = std::ranges::find_if(blocked, fits);
        if (first == blocked.end()) return;
        const BlockedMessage next = *first;
        blocked.erase(first);
        channel.out[cls].push_back(next.message);
        start_sending(link);
        if (next.link != kNone) {
            free_input(next.link, cls);
        } else {
            Node& n = nodes_[channel.start];
            result_.nodes[channel.start].port_ms += (now_ - n.blocked_since) * kMsPerNs;
            ++n.sent;
            send_outputs(channel.start);
        }
    }
}

// Sends the first message of a class for which the input thread has a free slot. Returns have priority, because they
// are short.
void AsyncSimulation::start_sending(std::uint32_t link) {
    Channel& channel = channels_[link];
    if (channel.sending) return;
    for (std::uint32_t cls = 0; cls < kClasses; ++cls) {
        if (channel.out[cls].empty() || channel.input_occupied[cls]) continue;
        channel.sending = channel.out[cls].front();
        channel.sent_class = cls;
        channel.input_occupied[cls] = true;
        return add_job(channel.start, {link, *channel.sending, false});
    }
}

void AsyncSimulation::begin_transfer(std::uint32_t link) {
    Channel& channel = channels_[link];
    channel.transferring = true;
    channel.words_left = history_.messages[*channel.sending].words;
    channel.rate = 0;
    channel.transfer_start = now_;
    set_rate(link);
    if (channels_[channel.opposite].transferring) set_rate(channel.opposite);
}

// Updates the rate of the current transfer to the rate that is now available to this direction of the link.
void AsyncSimulation::set_rate(std::uint32_t link) {
    Channel& channel = channels_[link];
    channel.words_left -= channel.rate * (now_ - channel.rate_since);
    channel.rate_since = now_;
    double ns = 0;
    if (machine_.one_way > 0) {
        channel.rate = (channels_[channel.opposite].transferring ? machine_.both_ways / 2 : machine_.one_way) /
                       (kBytesPerWord * kNsPerS);
        ns = channel.words_left / channel.rate;
    }
    schedule(std::max(0.0, ns), EventKind::kTransferDone, link, ++channel.version);
}

void AsyncSimulation::end_transfer(std::uint32_t link) {
    Channel& channel = channels_[link];
    const std::uint32_t message = *channel.sending, cls = channel.sent_class;
    AsyncLink& use = result_.links[link];
    use.busy_ms += (now_ - channel.transfer_start) * kMsPerNs;
    ++use.messages;
    use.words += history_.messages[message].words;
    channel.transferring = false;
    channel.sending.reset();
    channel.out[cls].pop_front();
    if (channels_[channel.opposite].transferring) set_rate(channel.opposite);
    add_job(channel.end, {link, message, true});
    admit_blocked(link, cls);
    start_sending(link);
}

// Called when the communication task has received a message: delivers or forwards the message.
void AsyncSimulation::receive(std::uint32_t link, std::uint32_t message) {
    const std::uint32_t node = channels_[link].end, on = next_channel(node, message);
    if (on == kNone) {
        deliver(message);
        return free_input(link, class_of(message));
    }
    const bool same_ring = on % RAYA_LINKS == link % RAYA_LINKS;
    const std::uint32_t slots = class_of(message) == 0 || same_ring ? 1 : machine_.entry_slots;
    if (enqueue(on, {link, message, slots})) free_input(link, class_of(message));
}

void AsyncSimulation::free_input(std::uint32_t link, std::uint32_t cls) {
    channels_[link].input_occupied[cls] = false;
    start_sending(link);
}

}  // namespace raya
