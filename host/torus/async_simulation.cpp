// Parts of AsyncSimulation: first the processors and their tasks, then the links and their threads.
#include "host/torus/async_simulation.hpp"

#include <algorithm>
#include <stdexcept>

namespace raya {
namespace {

constexpr double kBytesPerWord = 4, kNsPerS = 1e9;

}  // namespace

// Adds a job of the communication task. The job preempts the main task.
void AsyncSimulation::add_job(std::uint32_t node, const MessageJob& job) {
    nodes_[node].jobs.push_back(job);
    run_processor(node);
}

void AsyncSimulation::preempt_main(Node& n) {
    if (n.task == kNone || !n.computing) return;
    n.remaining_ns -= now_ - n.remaining_since_ns;
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
        return schedule(ns, EventKind::kJobDone, node, 0);
    }
    if (n.task == kNone || n.computing || n.sent_count != kNone) return;
    n.computing = true;
    n.remaining_since_ns = now_;
    schedule(std::max(0.0, n.remaining_ns), EventKind::kTaskDone, node, ++n.version);
}

void AsyncSimulation::finish_job(std::uint32_t node) {
    Node& n = nodes_[node];
    const MessageJob job = n.jobs.front();
    n.jobs.pop_front();
    n.in_job = false;
    if (job.receiving)
        receive(job.channel, job.message);
    else
        begin_transfer(job.channel);
    run_processor(node);
}

// Starts the task of the first ray in the queue or, if the queue is empty, the node's next task without a cause.
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
    n.sent_count = kNone;
    n.remaining_ns = machine_.cycle_ns * static_cast<double>(history_.tasks[n.task].cycles);
    result_.nodes[node].compute_ms += n.remaining_ns * kMsPerNs;
    run_processor(node);
}

void AsyncSimulation::finish_task(std::uint32_t node) {
    Node& n = nodes_[node];
    n.computing = false;
    n.sent_count = 0;
    ++finished_tasks_;
    send_outputs(node);
}

// Sends the remaining messages of the current task until a port is full.
void AsyncSimulation::send_outputs(std::uint32_t node) {
    Node& n = nodes_[node];
    const std::span<const HistoryMessage> messages = history_.sent_by(n.task);
    while (n.sent_count < messages.size()) {
        const std::uint32_t message = history_.tasks[n.task].first_message + n.sent_count;
        const std::uint32_t channel_index = next_channel(node, message);
        if (channel_index == kNone) {
            ++n.sent_count;
            deliver(message);
            continue;
        }
        const std::uint32_t slots = class_of(message) == 1 ? machine_.entry_slots : 1;
        if (!enqueue(channel_index, {kNone, message, slots})) {
            n.blocked_since_ns = now_;
            return;
        }
        ++n.sent_count;
    }
    n.task = kNone;
    start_next_task(node);
}

void AsyncSimulation::deliver(std::uint32_t message) {
    if (delivered_[message]) throw std::logic_error("async: a message arrives twice");
    delivered_[message] = true;
    ++result_.delivered;
    if (task_of_message_[message] == HistoryTask::kNoCause) return;
    const std::uint32_t node = history_.messages[message].destination;
    auto& queue = nodes_[node].queue;
    queue.push_back(message);
    result_.nodes[node].queue_max = std::max<std::uint64_t>(result_.nodes[node].queue_max, queue.size());
    start_next_task(node);
}

// Returns the channel by which the message leaves the node; kNone if the node is the message's destination.
std::uint32_t AsyncSimulation::next_channel(std::uint32_t node, std::uint32_t message) const {
    const std::uint32_t destination = history_.messages[message].destination;
    if (node == destination) return kNone;
    const std::uint32_t link =
        class_of(message) == 0 ? raya_return_link(torus_, node) : raya_next_link(torus_, node, destination);
    return node * RAYA_LINKS + link;
}

// Puts the message into the channel's port and returns true. If too few slots are free, adds the message to the blocked
// messages instead and returns false.
bool AsyncSimulation::enqueue(std::uint32_t channel_index, const BlockedMessage& blocked_message) {
    const std::uint32_t message_class = class_of(blocked_message.message);
    Channel& channel = channels_[channel_index];
    if (channel.port[message_class].size() + blocked_message.slots_needed > machine_.buffer) {
        channel.blocked[message_class].push_back(blocked_message);
        return false;
    }
    channel.port[message_class].push_back(blocked_message.message);
    start_sending(channel_index);
    return true;
}

// Called when a slot of a port has become free. Repeatedly moves a message into the port: the first blocked message for
// which enough slots are free. So a ray that stays in its ring can overtake a ray that waits to enter the ring.
void AsyncSimulation::admit_blocked(std::uint32_t channel_index, std::uint32_t message_class) {
    Channel& channel = channels_[channel_index];
    for (;;) {
        auto& blocked = channel.blocked[message_class];
        const auto fits = [&](const BlockedMessage& b) {
            return channel.port[message_class].size() + b.slots_needed <= machine_.buffer;
        };
        const auto first = std::ranges::find_if(blocked, fits);
        if (first == blocked.end()) return;
        const BlockedMessage next = *first;
        blocked.erase(first);
        channel.port[message_class].push_back(next.message);
        start_sending(channel_index);
        if (next.channel != kNone) {
            free_input(next.channel, message_class);
        } else {
            Node& n = nodes_[channel.start];
            result_.nodes[channel.start].port_ms += (now_ - n.blocked_since_ns) * kMsPerNs;
            ++n.sent_count;
            send_outputs(channel.start);
        }
    }
}

// Sends the port's first message of a class for which the input thread has a free slot. Returns have priority over
// rays, because returns are short.
void AsyncSimulation::start_sending(std::uint32_t channel_index) {
    Channel& channel = channels_[channel_index];
    if (channel.sending) return;
    for (std::uint32_t message_class = 0; message_class < kClasses; ++message_class) {
        if (channel.port[message_class].empty() || channel.input_occupied[message_class]) continue;
        channel.sending = channel.port[message_class].front();
        channel.sent_class = message_class;
        channel.input_occupied[message_class] = true;
        return add_job(channel.start, {channel_index, *channel.sending, false});
    }
}

void AsyncSimulation::begin_transfer(std::uint32_t channel_index) {
    Channel& channel = channels_[channel_index];
    channel.transferring = true;
    channel.words_left = history_.messages[*channel.sending].words;
    channel.rate = 0;
    channel.transfer_start = now_;
    set_rate(channel_index);
    if (channels_[channel.opposite].transferring) set_rate(channel.opposite);
}

// Sets the rate of the channel's transfer to the rate that is now available, and reschedules the end of the transfer.
void AsyncSimulation::set_rate(std::uint32_t channel_index) {
    Channel& channel = channels_[channel_index];
    channel.words_left -= channel.rate * (now_ - channel.rate_since);
    channel.rate_since = now_;
    double ns = 0;
    if (machine_.one_way > 0) {
        channel.rate = (channels_[channel.opposite].transferring ? machine_.both_ways / 2 : machine_.one_way) /
                       (kBytesPerWord * kNsPerS);
        ns = channel.words_left / channel.rate;
    }
    schedule(std::max(0.0, ns), EventKind::kTransferDone, channel_index, ++channel.version);
}

void AsyncSimulation::end_transfer(std::uint32_t channel_index) {
    Channel& channel = channels_[channel_index];
    const std::uint32_t message = *channel.sending, message_class = channel.sent_class;
    AsyncLink& link = result_.links[channel_index];
    link.busy_ms += (now_ - channel.transfer_start) * kMsPerNs;
    ++link.messages;
    link.words += history_.messages[message].words;
    channel.transferring = false;
    channel.sending.reset();
    channel.port[message_class].pop_front();
    if (channels_[channel.opposite].transferring) set_rate(channel.opposite);
    add_job(channel.end, {channel_index, message, true});
    admit_blocked(channel_index, message_class);
    start_sending(channel_index);
}

// Called when the communication task has received a message: delivers or forwards the message.
void AsyncSimulation::receive(std::uint32_t channel_index, std::uint32_t message) {
    const std::uint32_t node = channels_[channel_index].end, next = next_channel(node, message);
    if (next == kNone) {
        deliver(message);
        return free_input(channel_index, class_of(message));
    }
    const bool same_ring = next % RAYA_LINKS == channel_index % RAYA_LINKS;
    const std::uint32_t slots = class_of(message) == 0 || same_ring ? 1 : machine_.entry_slots;
    if (enqueue(next, {channel_index, message, slots})) free_input(channel_index, class_of(message));
}

void AsyncSimulation::free_input(std::uint32_t channel_index, std::uint32_t message_class) {
    channels_[channel_index].input_occupied[message_class] = false;
    start_sending(channel_index);
}

}  // namespace raya
