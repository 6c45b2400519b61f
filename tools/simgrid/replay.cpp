// Replays the work of a render on the torus with SimGrid (https://simgrid.org), which simulates processors and links.
// The main task, the input threads and the output threads of each node are actors. The code is independent of raya's
// simulator and implements the same rules (host/torus/async_machine.hpp) with actors, semaphores and messages.
//
//   simgrid_replay PLATFORM.xml REPLAY [--cfg=...]
//
// Prints "finish_ms T", the simulated time in ms, and "delivered N", the number of delivered messages. --cfg: options
// of SimGrid. Exit codes: 0 done; 2 bad arguments, or a file that cannot be read; 4 deadlock. REPLAY is text, written
// by Python's `Result.write_replay()` (docs/architecture.md):
//   machine NODES BUFFER ENTRY_SLOTS MESSAGE_CYCLES WORD_CYCLES
//       BUFFER: number of slots of an output thread for messages of one class; ENTRY_SLOTS: number of free slots that a
//       ray needs to enter a link of another axis; MESSAGE_CYCLES + words x WORD_CYCLES: processor cycles for sending
//       or for receiving a message
//   t NODE CYCLES CAUSE             a task; CAUSE: index of the message whose arrival starts it, from 0, or -
//   m WORDS CLASS DIRECTION NODE .. a message of the preceding task; CLASS 0: return, 1: ray; then its hops
#include <array>
#include <cstdint>
#include <deque>
#include <fstream>
#include <functional>
#include <iostream>
#include <map>
#include <memory>
#include <simgrid/s4u.hpp>
#include <sstream>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace {

namespace sg = simgrid::s4u;

constexpr double kCommunicationPriority = 1e9;  // the main task has priority 1
constexpr std::size_t kNoTask = SIZE_MAX;

struct Hop {
    int direction = 0;
    std::size_t node = 0;
};

struct Message {
    double words = 0;
    int cls = 0;
    std::vector<Hop> route;
    std::size_t hop = 0;         // number of links that the message has passed
    std::size_t task = kNoTask;  // the task that the message starts when it arrives
};

struct Task {
    std::size_t node = 0;
    double cycles = 0;
    std::vector<Message*> sent_messages;
};

// One direction of a link. For each class of messages: `out`, the messages in the output thread; `is_input_busy`, true
// while the input thread has a message.
struct Port {
    std::size_t source = 0, target = 0;  // nodes
    int direction = 0;
    std::array<std::deque<Message*>, 2> out;
    std::array<bool, 2> is_input_busy{};
    std::array<sg::Mailbox*, 2> wire{};
};

struct Node {
    sg::Host* host = nullptr;
    sg::MutexPtr lock = sg::Mutex::create(), communication = sg::Mutex::create();
    sg::ConditionVariablePtr changed = sg::ConditionVariable::create();
    std::deque<std::size_t> message_tasks, own_tasks;  // tasks started by messages; tasks that the node starts itself
};

struct Machine {
    std::size_t buffer = 0, entry_slots = 0;
    double message_cycles = 0, word_cycles = 0;
    std::vector<Node> nodes;
    std::vector<Task> tasks;
    std::deque<Message> messages;
    std::map<std::pair<std::size_t, int>, std::unique_ptr<Port>> ports;
    std::size_t pending = 0, delivered = 0;  // pending: tasks and messages that are not finished
    double finished_s = 0;
    sg::SemaphorePtr done = sg::Semaphore::create(0);

    void finish_one() {
        finished_s = sg::Engine::get_clock();
        if (--pending == 0) done->release();
    }
};

Machine machine;

void wake(Node& node) { node.changed->notify_all(); }

// Takes the processor's time for sending or receiving a message. Messages have priority over the main task.
void handle(Node& node, const Message& message) {
    const double cycles = machine.message_cycles + machine.word_cycles * message.words;
    if (cycles <= 0) return;
    node.communication->lock();
    sg::this_actor::exec_init(cycles)->set_priority(kCommunicationPriority)->wait();
    node.communication->unlock();
}

void deliver(Message* message, std::size_t node_index) {
    ++machine.delivered;
    machine.finish_one();
    if (message->task == kNoTask) return;
    machine.nodes[node_index].message_tasks.push_back(message->task);
    wake(machine.nodes[node_index]);
}

// Puts a message into the output thread of its next link; waits for free slots. `arrival`: direction in which the
// message arrived; -1: from the main task.
void put(std::size_t node_index, Message* message, int arrival) {
    Node& node = machine.nodes[node_index];
    const Hop next = message->route[message->hop];
    Port& port = *machine.ports.at({node_index, next.direction});
    std::deque<Message*>& out = port.out[message->cls];
    const bool needs_one_slot = message->cls == 0 || arrival == next.direction;
    const std::size_t required_slots = needs_one_slot ? 1 : machine.entry_slots;
    std::unique_lock<sg::Mutex> lock(*node.lock);
    while (out.size() + required_slots > machine.buffer) node.changed->wait(lock);
    out.push_back(message);
    wake(node);
}

void main_task(std::size_t node_index) {
    Node& node = machine.nodes[node_index];
    for (;;) {
        std::size_t task = kNoTask;
        {
            std::unique_lock<sg::Mutex> lock(*node.lock);
            while (node.message_tasks.empty() && node.own_tasks.empty()) node.changed->wait(lock);
            auto& tasks = node.message_tasks.empty() ? node.own_tasks : node.message_tasks;
            task = tasks.front();
            tasks.pop_front();
        }
        if (machine.tasks[task].cycles > 0) sg::this_actor::execute(machine.tasks[task].cycles);
        machine.finish_one();
        for (Message* message : machine.tasks[task].sent_messages)
            if (message->route.empty())
                deliver(message, node_index);
            else
                put(node_index, message, -1);
    }
}

// Returns (class 0) have priority over rays.
void output_thread(Port* port) {
    Node& node = machine.nodes[port->source];
    for (;;) {
        int cls = -1;
        {
            std::unique_lock<sg::Mutex> lock(*node.lock);
            const auto is_sendable = [&](int c) { return !port->out[c].empty() && !port->is_input_busy[c]; };
            while (!is_sendable(0) && !is_sendable(1)) node.changed->wait(lock);
            cls = is_sendable(0) ? 0 : 1;
            port->is_input_busy[cls] = true;
        }
        Message* const message = port->out[cls].front();
        handle(node, *message);
        port->wire[cls]->put(message, static_cast<std::uint64_t>(4 * message->words));
        port->out[cls].pop_front();
        wake(node);
    }
}

void input_thread(Port* port, int cls) {
    Node& node = machine.nodes[port->target];
    for (;;) {
        Message* const message = port->wire[cls]->get<Message>();
        handle(node, *message);
        if (++message->hop == message->route.size())
            deliver(message, port->target);
        else
            put(port->target, message, port->direction);
        port->is_input_busy[cls] = false;
        wake(machine.nodes[port->source]);
    }
}

[[noreturn]] void fail(const std::string& reason) { throw std::runtime_error(reason); }

void read_message(std::istringstream& words) {
    Message message;
    if (machine.tasks.empty() || !(words >> message.words >> message.cls))
        fail("expected m WORDS CLASS ... after a task");
    if (message.cls != 0 && message.cls != 1) fail("expected message class 0 (return) or 1 (ray)");
    for (Hop hop; words >> hop.direction;) {
        if (!(words >> hop.node) || hop.node >= machine.nodes.size()) fail("a hop names an unknown node");
        message.route.push_back(hop);
    }
    if (!words.eof()) fail("expected a route DIRECTION NODE ...");
    machine.messages.push_back(message);
    machine.tasks.back().sent_messages.push_back(&machine.messages.back());
}

void read_task(std::istringstream& words) {
    Task task;
    std::string cause;
    if (!(words >> task.node >> task.cycles >> cause) || task.node >= machine.nodes.size())
        fail("expected t NODE CYCLES CAUSE");
    if (cause == "-")
        machine.nodes[task.node].own_tasks.push_back(machine.tasks.size());
    else
        machine.messages.at(std::stoul(cause)).task = machine.tasks.size();
    machine.tasks.push_back(task);
}

void read_replay(const std::string& file) {
    std::ifstream in(file);
    if (!in) fail(file + ": cannot open file");
    for (std::string line; std::getline(in, line);) {
        std::istringstream words(line);
        std::string kind;
        words >> kind;
        if (kind == "machine") {
            std::size_t nodes = 0;
            if (!(words >> nodes >> machine.buffer >> machine.entry_slots >> machine.message_cycles >>
                  machine.word_cycles))
                fail("expected machine NODES BUFFER ENTRY_SLOTS MESSAGE_CYCLES WORD_CYCLES");
            machine.nodes = std::vector<Node>(nodes);
        } else if (kind == "t") {
            read_task(words);
        } else if (kind == "m") {
            read_message(words);
        } else {
            fail("unknown line: " + line);
        }
    }
    machine.pending = machine.tasks.size() + machine.messages.size();
}

void start(const std::string& name, sg::Host* host, const std::function<void()>& code) {
    sg::Actor::create(name, host, code)->daemonize();
}

// Creates the main tasks, and the ports and threads of the links that messages use.
void start_actors() {
    for (const Task& task : machine.tasks)
        for (const Message* message : task.sent_messages) {
            std::size_t source = task.node;
            for (const Hop& hop : message->route) {
                auto& port = machine.ports[{source, hop.direction}];
                if (!port) {
                    port = std::make_unique<Port>();
                    port->source = source;
                    port->target = hop.node;
                    port->direction = hop.direction;
                }
                source = hop.node;
            }
        }
    for (auto& [key, port] : machine.ports) {
        Port* const p = port.get();
        const std::string name = std::to_string(key.first) + ":" + std::to_string(key.second);
        for (int cls = 0; cls < 2; ++cls) {
            p->wire[cls] = sg::Mailbox::by_name(name + ":" + std::to_string(cls));
            start("in " + name, machine.nodes[p->target].host, [p, cls] { input_thread(p, cls); });
        }
        start("out " + name, machine.nodes[p->source].host, [p] { output_thread(p); });
    }
    for (std::size_t node = 0; node < machine.nodes.size(); ++node)
        start("main " + std::to_string(node), machine.nodes[node].host, [node] { main_task(node); });
    if (machine.pending > 0)  // the simulation ends with this actor: all others are daemons
        sg::Actor::create("end", machine.nodes[0].host, [] { machine.done->acquire(); });
}

}  // namespace

int main(int argc, char* argv[]) {
    sg::Engine engine(&argc, argv);
    // A transfer takes bytes / rate of the link, without SimGrid's corrections for TCP.
    sg::Engine::set_config("network/model:CM02");
    sg::Engine::set_config("network/crosstraffic:0");
    sg::Engine::set_config("contexts/stack-size:128");
    if (argc != 3) {
        std::cerr << "usage: simgrid_replay PLATFORM.xml REPLAY\n";
        return 2;
    }
    try {
        engine.load_platform(argv[1]);
        read_replay(argv[2]);
        for (std::size_t node = 0; node < machine.nodes.size(); ++node)
            machine.nodes[node].host = sg::Host::by_name(std::to_string(node));
        start_actors();
    } catch (const std::exception& error) {
        std::cerr << "simgrid_replay: " << error.what() << '\n';
        return 2;
    }
    engine.run();
    if (machine.pending > 0) {
        std::cerr << "simgrid_replay: deadlock: " << machine.pending << " tasks and messages are not finished\n";
        return 4;
    }
    std::cout.precision(12);
    std::cout << "finish_ms " << 1e3 * machine.finished_s << "\ndelivered " << machine.delivered << '\n';
    return 0;
}
