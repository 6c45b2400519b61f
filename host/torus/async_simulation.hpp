// Discrete-event simulator of the machine that async_machine.hpp describes. async_machine.cpp contains the event loop;
// async_simulation.cpp contains the processors, links and threads. Channel RAYA_LINKS * n + l is link l of node n, in
// the direction away from the node.
#pragma once
#include <array>
#include <cstdint>
#include <deque>
#include <functional>
#include <optional>
#include <queue>
#include <vector>

#include "host/torus/async_machine.hpp"
#include "kernels/shared/packet.h"

namespace raya {

/// Runs one simulation. The constructor's arguments must be valid and outlive this object.
class AsyncSimulation {
  public:
    AsyncSimulation(const raya_torus& torus, const History& history, const AsyncMachine& machine);
    AsyncResult run();

  private:
    static constexpr std::uint32_t kNone = UINT32_MAX;
    static constexpr std::uint32_t kClasses = 2;  // number of message classes: class 0 is returns, class 1 rays
    static constexpr double kMsPerNs = 1e-6;

    enum class EventKind : std::uint8_t { kJobDone, kTaskDone, kTransferDone };
    struct Event {
        double time = 0;           // ns
        std::uint64_t number = 0;  // index in the order of scheduling; orders events of equal time
        EventKind kind{};
        std::uint32_t location = 0;  // node (kJobDone, kTaskDone) or channel
        // Version of the node or channel at the time of scheduling. After a later change the event is obsolete.
        std::uint32_t version = 0;
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
        std::uint32_t sent_class = 0, version = 0;  // class of `sending`; number of set_rate() calls
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
        std::deque<std::uint32_t> queue{};            // messages that wait for the main task
        std::deque<std::uint32_t> injection_tasks{};  // tasks that no message causes and that have not started
        std::uint32_t task = kNone;                   // current task of the main task
        std::uint32_t sent_count = 0;  // number of messages of `task` that are sent; kNone until its computation ends
        bool computing = false;
        // Remaining computation time of `task` at time `remaining_since_ns`.
        double remaining_ns = 0, remaining_since_ns = 0;
        double blocked_since_ns = 0;  // time at which the main task began to wait for a port
        std::uint32_t version = 0;    // number of starts and preemptions of the computation
    };

    void schedule(double delay_ns, EventKind kind, std::uint32_t location, std::uint32_t version);
    void handle(const Event& event);

    // The processors.
    void add_job(std::uint32_t node, const MessageJob& job);
    void run_processor(std::uint32_t node);
    void preempt_main(Node& n);
    void finish_job(std::uint32_t node);
    void finish_task(std::uint32_t node);
    void start_next_task(std::uint32_t node);
    void send_outputs(std::uint32_t node);
    void deliver(std::uint32_t message);

    // The links.
    std::uint32_t class_of(std::uint32_t message) const {
        return history_.messages[message].kind == RAYA_KIND_RETURN ? 0 : 1;
    }
    std::uint32_t next_channel(std::uint32_t node, std::uint32_t message) const;
    bool enqueue(std::uint32_t channel_index, const BlockedMessage& blocked_message);
    void admit_blocked(std::uint32_t channel_index, std::uint32_t message_class);
    void start_sending(std::uint32_t channel_index);
    void begin_transfer(std::uint32_t channel_index);
    void set_rate(std::uint32_t channel_index);
    void end_transfer(std::uint32_t channel_index);
    void receive(std::uint32_t channel_index, std::uint32_t message);
    void free_input(std::uint32_t channel_index, std::uint32_t message_class);

    const raya_torus& torus_;
    const History& history_;
    const AsyncMachine& machine_;
    std::vector<std::uint32_t> task_of_message_;
    std::vector<bool> delivered_;
    std::vector<Node> nodes_;
    std::vector<Channel> channels_;
    std::priority_queue<Event, std::vector<Event>, std::greater<>> events_;
    std::uint64_t event_count_ = 0, finished_tasks_ = 0;
    double now_ = 0;  // ns
    AsyncResult result_;
};

}  // namespace raya
