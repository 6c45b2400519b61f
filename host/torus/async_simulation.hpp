// The events of the asynchronous torus: what async_machine.hpp describes, as one class in two files:
// async_machine.cpp has the time, async_simulation.cpp the processors, the links and their threads.
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

/// One run. History and machine have been checked, and outlive it.
class AsyncSimulation {
  public:
    AsyncSimulation(const raya_torus& torus, const History& history, const AsyncMachine& machine);
    AsyncResult run();

  private:
    static constexpr std::uint32_t kNone = UINT32_MAX, kClasses = 2;  // returns, rays
    static constexpr double kMsPerNs = 1e-6;

    enum class What : std::uint8_t { kMessageDone, kMainDone, kCarried };

    struct Event {
        double time = 0;           // ns
        std::uint64_t number = 0;  // of equal times the event that was foreseen first comes first
        What what{};
        std::uint32_t place = 0;  // a node or a link
        std::uint32_t version = 0;
        bool operator>(const Event& other) const {
            return time != other.time ? time > other.time : number > other.number;
        }
    };

    // Who waits for room in an output thread: the message in an input thread, `link` being the way by which it came, or
    // the node's main task.
    struct Waiting {
        std::uint32_t link = kNone, message = 0, needs = 1;
    };

    // One way of a link: the output thread at its start, the wire, and the input thread at its end.
    struct Way {
        std::uint32_t start = 0, end = 0, back = 0;  // nodes; the other way of the same wire
        std::array<std::deque<std::uint32_t>, kClasses> out{};
        std::array<std::vector<Waiting>, kClasses> waiting{};
        std::array<bool, kClasses> taken{};      // the input thread's room
        std::optional<std::uint32_t> sending{};  // from the processor's part on until it is carried
        std::uint32_t sent_class = 0, version = 0;
        bool carries = false;
        double words_left = 0, rate = 0, since = 0, began = 0;  // words, words/ns, ns
    };

    struct MessageJob {  // of the communication task
        std::uint32_t link = 0, message = 0;
        bool arrives = false;
    };

    struct Node {
        std::deque<MessageJob> jobs{};
        bool in_job = false;
        std::deque<std::uint32_t> queue{};  // messages whose tasks wait
        std::deque<std::uint32_t> own{};    // tasks that the node begins by itself
        std::uint32_t task = kNone;         // the main task's
        std::uint32_t sent = 0;             // how many of its messages are; kNone while it is computed
        bool computes = false;
        double left = 0, since = 0;  // ns that it needs yet, from then on
        double port_since = 0;       // when it began to wait for a port
        std::uint32_t version = 0;
    };

    void foresee(double after, What what, std::uint32_t place, std::uint32_t version);
    void happen(const Event& event);

    // The processors.
    void add_job(std::uint32_t node, const MessageJob& job);
    void work(std::uint32_t node);
    void stop_main(Node& n);
    void finish_job(std::uint32_t node);
    void finish_task(std::uint32_t node);
    void next_task(std::uint32_t node);
    void send_made(std::uint32_t node);
    void deliver(std::uint32_t message);

    // The links.
    std::uint32_t class_of(std::uint32_t message) const {
        return history_.messages[message].kind == RAYA_KIND_RETURN ? 0 : 1;
    }
    std::uint32_t way_on(std::uint32_t node, std::uint32_t message) const;
    bool put(std::uint32_t link, const Waiting& from);
    void let_in(std::uint32_t link, std::uint32_t cls);
    void start(std::uint32_t link);
    void begin_to_carry(std::uint32_t link);
    void set_rate(std::uint32_t link);
    void end_carrying(std::uint32_t link);
    void arrive(std::uint32_t link, std::uint32_t message);
    void free_input(std::uint32_t link, std::uint32_t cls);

    const raya_torus& torus_;
    const History& history_;
    const AsyncMachine& machine_;
    std::vector<std::uint32_t> caused_;
    std::vector<bool> arrived_;
    std::vector<Node> nodes_;
    std::vector<Way> ways_;
    std::priority_queue<Event, std::vector<Event>, std::greater<>> events_;
    std::uint64_t foreseen_ = 0, done_ = 0;
    double now_ = 0;
    AsyncResult result_;
};

}  // namespace raya
