#include <fmt/format.h>

#include <iterator>
#include <set>
#include <utility>

#include "host/torus/async_machine.hpp"
#include "host/torus/link_exchange.hpp"

namespace raya {
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
