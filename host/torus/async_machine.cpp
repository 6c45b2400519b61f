#include "host/torus/async_machine.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <deque>
#include <functional>
#include <optional>
#include <queue>
#include <set>
#include <stdexcept>
#include <utility>

#include "host/error.hpp"
#include "kernels/shared/packet.h"

namespace raya {
namespace {

// Returns the link by which a message leaves a node other than its destination.
std::uint32_t link_of(const raya_torus& torus, const HistoryMessage& message, std::uint32_t node) {
    return message.kind == RAYA_KIND_RETURN ? raya_return_link(torus, node)
                                            : raya_next_link(torus, node, message.destination);
}

constexpr double kBytesPerWord = 4, kNsPerS = 1e9;

/// Runs one simulation. The constructor's arguments must be valid and outlive this object.
class AsyncSimulation {
  public:
    AsyncSimulation(const raya_torus& torus, const History& history, const AsyncMachine& machine)
        : torus_(torus),
          history_(history),
          machine_(machine),
          task_of_message_(tasks_of_messages(history)),
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

    AsyncResult run() {
        for (std::uint32_t node = 0; node < nodes_.size(); ++node) start_next_task(node);
        while (!events_.empty()) {
            const Event event = events_.top();
            events_.pop();
            now_ = event.time;
            event.action();
        }
        if (finished_tasks_ < history_.tasks.size() || result_.delivered < history_.messages.size())
            throw std::runtime_error(fmt::format("deadlock of the asynchronous torus: {} of {} messages delivered",
                                                 result_.delivered, history_.messages.size()));
        return std::move(result_);
    }

  private:
    static constexpr std::uint32_t kNone = UINT32_MAX;
    static constexpr std::uint32_t kClasses = 2;  // number of message classes: class 0 is returns, class 1 rays
    static constexpr double kMsPerNs = 1e-6;

    struct Event {
        double time = 0;           // ns
        std::uint64_t number = 0;  // index in the order of scheduling; orders events of equal time
        std::function<void()> action{};
        bool operator>(const Event& other) const {
            return time != other.time ? time > other.time : number > other.number;
        }
    };

    // A message that waits until a port has `slots_needed` free slots. The message is in the input thread of channel
    // `channel`. If `channel` is kNone, the message is in the node's main task.
    struct BlockedMessage {
        std::uint32_t channel = kNone, message = 0, slots_needed = 1;
    };

    // One direction of a link: the output thread at its start, the transfer, and the input thread at its end.
    struct Channel {
        std::uint32_t start = 0, end = 0, opposite = 0;               // nodes at both ends; the link's other channel
        std::array<std::deque<std::uint32_t>, kClasses> port{};       // [class]: messages in the port
        std::array<std::vector<BlockedMessage>, kClasses> blocked{};  // [class]: messages that wait for the port
        std::array<bool, kClasses> input_occupied{};                  // [class]: the input thread's slot is occupied
        // Message that is being sent, from the start of the sender's job to the end of the transfer.
        std::optional<std::uint32_t> sending{};
        std::uint32_t sent_class = 0, version = 0;  // class of `sending`; number of set_rate() calls, see schedule()
        bool transferring = false;
        double words_left = 0, rate = 0, rate_since = 0, transfer_start = 0;  // words, words/ns, ns, ns
    };

    // Work of the communication task for one message at one end of a channel.
    struct MessageJob {
        std::uint32_t channel = 0, message = 0;
        bool receiving = false;
    };

    struct Node {
        std::deque<MessageJob> jobs{};
        bool in_job = false;                          // the processor works on jobs.front()
        std::deque<std::uint32_t> queue{};            // tasks whose messages wait for the main task
        std::deque<std::uint32_t> injection_tasks{};  // tasks that no message causes and that have not started
        std::uint32_t task = kNone;                   // current task of the main task
        std::uint32_t sent_count = 0;  // number of messages of `task` that are sent; kNone until its computation ends
        bool computing = false;
        // Remaining computation time of `task` at time `remaining_since_ns`.
        double remaining_ns = 0, remaining_since_ns = 0;
        double blocked_since_ns = 0;  // time at which the main task began to wait for a port
        std::uint32_t version = 0;    // number of starts and preemptions of the computation, see schedule()
    };

    std::uint32_t class_of(std::uint32_t message) const {
        return history_.messages[message].kind == RAYA_KIND_RETURN ? 0 : 1;
    }

    // Adds a job of the communication task. The job preempts the main task.
    void add_job(std::uint32_t node, const MessageJob& job) {
        nodes_[node].jobs.push_back(job);
        run_processor(node);
    }

    void run_processor(std::uint32_t node) {
        Node& n = nodes_[node];
        if (n.in_job) return;
        if (!n.jobs.empty()) {
            if (n.computing) {
                n.remaining_ns -= now_ - n.remaining_since_ns;
                n.computing = false;
                ++n.version;
            }
            n.in_job = true;
            const std::uint32_t words = history_.messages[n.jobs.front().message].words;
            const double ns = machine_.cycle_ns * (machine_.message_cycles + machine_.word_cycles * words);
            result_.nodes[node].messages_ms += ns * kMsPerNs;
            return schedule(ns, [=, this] { finish_job(node); });
        }
        if (n.task == kNone || n.computing || n.sent_count != kNone) return;
        n.computing = true;
        n.remaining_since_ns = now_;
        schedule(n.remaining_ns, [=, this, version = ++n.version] {
            if (version == nodes_[node].version) finish_task(node);
        });
    }

    void finish_job(std::uint32_t node) {
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
    void start_next_task(std::uint32_t node) {
        Node& n = nodes_[node];
        std::deque<std::uint32_t>& tasks = n.queue.empty() ? n.injection_tasks : n.queue;
        if (n.task != kNone || tasks.empty()) return;
        n.task = tasks.front();
        tasks.pop_front();
        n.sent_count = kNone;
        const HistoryTask& task = history_.tasks[n.task];
        const double factor = task.cause == HistoryTask::kNoCause ? machine_.primary_factor : 1;
        n.remaining_ns = factor * machine_.cycle_ns * static_cast<double>(task.cycles);
        result_.nodes[node].compute_ms += n.remaining_ns * kMsPerNs;
        run_processor(node);
    }

    void finish_task(std::uint32_t node) {
        Node& n = nodes_[node];
        n.computing = false;
        n.sent_count = 0;
        ++finished_tasks_;
        result_.finish_ms = now_ * kMsPerNs;
        send_outputs(node);
    }

    // Sends the remaining messages of the current task until a port is full.
    void send_outputs(std::uint32_t node) {
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

    void deliver(std::uint32_t message) {
        ++result_.delivered;
        result_.finish_ms = now_ * kMsPerNs;
        if (task_of_message_[message] == HistoryTask::kNoCause) return;
        const std::uint32_t node = history_.messages[message].destination;
        auto& queue = nodes_[node].queue;
        queue.push_back(task_of_message_[message]);
        result_.nodes[node].queue_max = std::max<std::uint64_t>(result_.nodes[node].queue_max, queue.size());
        start_next_task(node);
    }

    // Returns the channel by which the message leaves the node; kNone if the node is the message's destination.
    std::uint32_t next_channel(std::uint32_t node, std::uint32_t message) const {
        const HistoryMessage& m = history_.messages[message];
        return node == m.destination ? kNone : node * RAYA_LINKS + link_of(torus_, m, node);
    }

    // Puts the message into the channel's port and returns true. If too few slots are free, adds the message to the
    // blocked messages instead and returns false.
    bool enqueue(std::uint32_t channel_index, const BlockedMessage& blocked_message) {
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

    // Called when a slot of a port has become free. Repeatedly moves a message into the port: the first blocked message
    // for which enough slots are free. So a ray that stays in its ring can overtake a ray that waits to enter the ring.
    void admit_blocked(std::uint32_t channel_index, std::uint32_t message_class) {
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
    void start_sending(std::uint32_t channel_index) {
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

    void begin_transfer(std::uint32_t channel_index) {
        Channel& channel = channels_[channel_index];
        channel.transferring = true;
        channel.words_left = history_.messages[*channel.sending].words;
        channel.rate = 0;
        channel.transfer_start = now_;
        set_rate(channel_index);
        if (channels_[channel.opposite].transferring) set_rate(channel.opposite);
    }

    // Sets the rate of the channel's transfer to the rate that is now available, and reschedules the end of the
    // transfer.
    void set_rate(std::uint32_t channel_index) {
        Channel& channel = channels_[channel_index];
        channel.words_left -= channel.rate * (now_ - channel.rate_since);
        channel.rate_since = now_;
        double ns = 0;
        if (machine_.one_way > 0) {
            channel.rate = (channels_[channel.opposite].transferring ? machine_.both_ways / 2 : machine_.one_way) /
                           (kBytesPerWord * kNsPerS);
            ns = channel.words_left / channel.rate;
        }
        schedule(ns, [=, this, version = ++channel.version] {
            if (version == channels_[channel_index].version) end_transfer(channel_index);
        });
    }

    void end_transfer(std::uint32_t channel_index) {
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
    void receive(std::uint32_t channel_index, std::uint32_t message) {
        const std::uint32_t node = channels_[channel_index].end, next = next_channel(node, message);
        if (next == kNone) {
            deliver(message);
            return free_input(channel_index, class_of(message));
        }
        const bool same_ring = next % RAYA_LINKS == channel_index % RAYA_LINKS;
        const std::uint32_t slots = class_of(message) == 0 || same_ring ? 1 : machine_.entry_slots;
        if (enqueue(next, {channel_index, message, slots})) free_input(channel_index, class_of(message));
    }

    void free_input(std::uint32_t channel_index, std::uint32_t message_class) {
        channels_[channel_index].input_occupied[message_class] = false;
        start_sending(channel_index);
    }

    // Calls action() after `delay_ns`, or at once if rounding has made it negative. The action does nothing if the
    // event is obsolete: if the version of its node or channel has changed.
    void schedule(double delay_ns, std::function<void()> action) {
        events_.push({now_ + std::max(0.0, delay_ns), event_count_++, std::move(action)});
    }

    const raya_torus& torus_;
    const History& history_;
    const AsyncMachine& machine_;
    std::vector<std::uint32_t> task_of_message_;
    std::vector<Node> nodes_;
    std::vector<Channel> channels_;
    std::priority_queue<Event, std::vector<Event>, std::greater<>> events_;
    std::uint64_t event_count_ = 0, finished_tasks_ = 0;
    double now_ = 0;  // ns
    AsyncResult result_;
};

}  // namespace

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
    return AsyncSimulation(torus, history, machine).run();
}

}  // namespace raya
