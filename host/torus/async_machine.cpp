#include "host/torus/async_machine.hpp"

#include <fmt/core.h>
#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <set>
#include <stdexcept>
#include <utility>

#include "host/error.hpp"
#include "host/torus/async_simulation.hpp"
#include "host/torus/link_exchange.hpp"

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

namespace {

constexpr double kUnlimitedBytesPerS = 1e18;  // rate of links whose transfers take no time

// Text to which formatted text is appended.
struct Text {
    std::string text;
    template <class... Args>
    void add(fmt::format_string<Args...> format, Args&&... args) {
        fmt::format_to(std::back_inserter(text), format, std::forward<Args>(args)...);
    }
};

std::string channel_name(std::uint32_t node, std::uint32_t link) { return fmt::format("{}{}", node, link_name(link)); }

// Returns the name of the wire, whose bandwidth the two channels (directions) of a link share. The name contains the
// name of the channel in the direction of ascending coordinates.
std::string wire_name(const raya_torus& torus, std::uint32_t node, std::uint32_t link) {
    return "wire " +
           (link % 2 == 0 ? channel_name(node, link) : channel_name(raya_link_end(torus, node, link), link ^ 1u));
}

}  // namespace

std::string simgrid_platform(const raya_torus& torus, const AsyncMachine& machine) {
    const double one_way = machine.one_way > 0 ? machine.one_way : kUnlimitedBytesPerS;
    const double both_ways = machine.one_way > 0 ? machine.both_ways : kUnlimitedBytesPerS;
    Text hosts, links, routes;
    for (std::uint32_t node = 0; node < raya_nodes(torus); ++node) {
        hosts.add("    <host id=\"{}\" speed=\"{:.17g}f\"/>\n", node, 1e9 / machine.cycle_ns);
        // If a side of the torus has two nodes, two wires connect them; raya uses only the first.
        std::set<std::uint32_t> connected = {node};
        for (std::uint32_t link = 0; link < RAYA_LINKS; ++link) {
            const std::uint32_t end = raya_link_end(torus, node, link);
            if (!connected.insert(end).second) continue;
            const std::string direction = channel_name(node, link), wire = wire_name(torus, node, link);
            links.add("    <link id=\"{}\" bandwidth=\"{:.17g}Bps\" latency=\"0\"/>\n", direction, one_way);
            if (link % 2 == 0)
                links.add("    <link id=\"{}\" bandwidth=\"{:.17g}Bps\" latency=\"0\"/>\n", wire, both_ways);
            routes.add(
                "    <route src=\"{}\" dst=\"{}\" symmetrical=\"NO\"><link_ctn id=\"{}\"/><link_ctn id=\"{}\"/>"
                "</route>\n",
                node, end, direction, wire);
        }
    }
    return "<?xml version='1.0'?>\n<!DOCTYPE platform SYSTEM \"https://simgrid.org/simgrid.dtd\">\n"
           "<platform version=\"4.1\">\n  <zone id=\"torus\" routing=\"Full\">\n" +
           hosts.text + links.text + routes.text + "  </zone>\n</platform>\n";
}

std::string simgrid_replay(const raya_torus& torus, const History& history, const AsyncMachine& machine) {
    Text replay;
    replay.add("machine {} {} {} {} {}\n", raya_nodes(torus), machine.buffer, machine.entry_slots,
               machine.message_cycles, machine.word_cycles);
    for (std::size_t task = 0; task < history.tasks.size(); ++task) {
        const HistoryTask& t = history.tasks[task];
        replay.add("t {} {} {}\n", t.node, t.cycles, t.cause == HistoryTask::kNoCause ? "-" : std::to_string(t.cause));
        for (const HistoryMessage& message : history.sent_by(task)) {
            const bool is_return = message.kind == RAYA_KIND_RETURN;
            replay.add("m {} {}", message.words, is_return ? 0 : 1);
            for (std::uint32_t node = t.node; node != message.destination;) {
                const std::uint32_t link =
                    is_return ? raya_return_link(torus, node) : raya_next_link(torus, node, message.destination);
                node = raya_link_end(torus, node, link);
                replay.add(" {} {}", link, node);
            }
            replay.add("\n");
        }
    }
    return std::move(replay.text);
}

}  // namespace raya
