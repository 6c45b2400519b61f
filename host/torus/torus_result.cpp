#include "host/torus/torus_result.hpp"

#include <fmt/core.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <numeric>
#include <utility>

#include "host/model/budget.hpp"
#include "host/model/number_format.hpp"
#include "host/torus/topology.hpp"

namespace raya {
namespace {

constexpr std::uint64_t kWordBytes = sizeof(std::uint32_t);

// Returns the total size of the packets in bytes.
std::uint64_t packet_bytes(const PacketCounts& made) {
    std::uint64_t words = 0;
    for (std::uint32_t kind = RAYA_KIND_PRIMARY; kind < RAYA_KINDS; ++kind)
        words += made[kind] * raya_packet_words(kind);
    return kWordBytes * words;
}

// torus_time() assumes that transfers take longer than the processors' work for messages. The second static_assert
// checks this for the worst case, the shortest packets.
constexpr std::uint32_t kShortestWords = PacketCharge::kRayReturnWords;
static_assert(kShortestWords < RAYA_RETURN_WORDS);
static_assert(2 * RAYA_LINKS * (kT805MessageWordCycles * kShortestWords + kT805MessageCycles) * kT805CycleNs <
              kShortestWords * 1e9 * 2 * 4 / kT805BothWaysBytesPerS);

// Returns [node]: processor cycles for the messages that the node sends and receives.
std::vector<std::uint64_t> message_cycles(const raya_torus& torus, const TorusResult& result) {
    std::vector<std::uint64_t> cycles(raya_nodes(torus));
    for (std::uint32_t node = 0; node < cycles.size(); ++node)
        for (std::uint32_t link = 0; link < RAYA_LINKS; ++link) {
            const std::size_t i = std::size_t{node} * RAYA_LINKS + link;
            const std::uint64_t end_cycles = t805_message_cycles(result.link_packets[i], result.link_words[i]);
            cycles[node] += end_cycles;
            cycles[raya_link_end(torus, node, link)] += end_cycles;
        }
    return cycles;
}

// Returns the milliseconds that the busiest link takes for its transfers in both directions. Link 2 d of a node and
// link 2 d + 1 of the node at the end of link 2 d are the two directions of one link.
double busiest_link_ms(const raya_torus& torus, const TorusResult& result) {
    double max_ms = 0;
    for (std::uint32_t node = 0; node < raya_nodes(torus); ++node)
        for (std::uint32_t up = 0; up < RAYA_LINKS; up += 2) {
            const std::size_t back = std::size_t{raya_link_end(torus, node, up)} * RAYA_LINKS + up + 1;
            max_ms = std::max(
                max_ms, t805_link_ms(result.link_words[std::size_t{node} * RAYA_LINKS + up], result.link_words[back]));
        }
    return max_ms;
}

}  // namespace

std::vector<KernelWork> torus_kernel_work(const TorusSettings& settings, const TorusResult& r) {
    const std::uint64_t pixels = std::uint64_t{settings.width} * settings.height;
    EventCounts inject_events{}, trace_events = r.rank_events;
    for (const std::size_t event : {RAYA_PRIMARY, RAYA_DISCARDED})
        inject_events[event] = std::exchange(trace_events[event], 0);
    PacketCounts primary_packets{}, other_packets = r.rank_made;
    primary_packets[RAYA_KIND_PRIMARY] = std::exchange(other_packets[RAYA_KIND_PRIMARY], 0);
    const auto copied_bytes = [&](const char* label) { return r.launches(label) * kWordBytes * r.copied_words; };

    KernelWork inject = work_of("inject", inject_events), trace = work_of("trace_voxel", trace_events);
    inject.bytes = copied_bytes("inject") + packet_bytes(primary_packets);
    trace.bytes = copied_bytes("trace_voxel") + kWordBytes * RAYA_PACKET_WORDS * r.rank_events[RAYA_STEPS] +
                  packet_bytes(other_packets);
    trace.rays += inject_events[RAYA_PRIMARY];  // trace_voxel also traces the primary rays
    const std::uint64_t routed = r.sent_rays * RAYA_PACKET_WORDS + r.rank_made[RAYA_KIND_RETURN] * RAYA_RETURN_WORDS;
    const std::uint64_t accepted = r.received_rays * RAYA_PACKET_WORDS + r.received_returns * RAYA_RETURN_WORDS;
    const std::uint64_t composed =
        r.contributions * 4 * sizeof(float) + kWordBytes * (pixels + 1) + 3 * sizeof(float) * pixels;
    return {inject,
            trace,
            {.label = "route", .bytes = copied_bytes("route") + 2 * kWordBytes * routed},
            {.label = "accept", .bytes = 2 * kWordBytes * accepted},
            // Three multiply-adds for each contribution.
            {.label = "compose", .operations = 3 * r.contributions, .bytes = composed}};
}

TorusTime torus_time(const raya_torus& torus, const TorusResult& result) {
    const std::vector<std::uint64_t> messages = message_cycles(torus, result);
    std::uint64_t processor_cycles = 0;
    for (std::size_t node = 0; node < messages.size(); ++node)
        processor_cycles = std::max(processor_cycles, result.load.per_pe[node] + messages[node]);
    TorusTime time;
    time.compute_ms = t805_ms(result.load.max);
    time.messages_ms = t805_ms(std::ranges::max(messages));
    time.processor_ms = t805_ms(processor_cycles);
    time.links_ms = busiest_link_ms(torus, result);
    time.overlapped_ms = std::max(time.processor_ms, time.links_ms);
    for (const Superstep& step : result.supersteps)
        time.stepwise_ms += t805_ms(step.max_node_cycles) + t805_link_ms(step.max_link_words, step.max_link_words);
    return time;
}

namespace {

const char* returns_name(const PacketCharge& packets) { return packets.one_return_per_ray ? "rays" : "terms"; }

struct LinkBytes {
    std::uint64_t links = 0;  // number of unidirectional links between different nodes
    std::uint64_t max = 0, total = 0;
    std::array<std::uint64_t, RAYA_LINKS> by_direction{};  // over +x, -x, +y, -y, +z, -z links
    std::vector<std::uint64_t> sent;                       // [node]: number of bytes that the node sent

    LinkBytes(const raya_torus& torus, const std::vector<std::uint64_t>& words)
        : links(std::uint64_t{raya_nodes(torus)} * links_of_node(torus)), sent(words.size() / RAYA_LINKS) {
        for (std::size_t i = 0; i < words.size(); ++i) {
            const std::uint64_t bytes = 4 * words[i];
            max = std::max(max, bytes);
            total += bytes;
            by_direction[i % RAYA_LINKS] += bytes;
            sent[i / RAYA_LINKS] += bytes;
        }
    }
    double mean() const { return links > 0 ? static_cast<double>(total) / static_cast<double>(links) : 0; }
};

void packet_members(Members& m, const TorusResult& result) {
    for (std::size_t kind = 1; kind < RAYA_KINDS; ++kind)
        m(kPacketKinds[kind], "Numbers of packets of this kind.", [&](Members& packets) {
            packets("made", result.made[kind], "Number of packets that nodes created.");
            packets("ended", result.ended[kind], "Number of packets that ended; equal to `made`.");
        });
}

void link_members(Members& m, const LinkBytes& bytes) {
    m("links", bytes.links, "Number of links between different nodes.");
    m("max", bytes.max, "Traffic of the busiest link, bytes.");
    m("mean", bytes.mean(), "Mean traffic of a link, bytes.");
    m("total", bytes.total, "Traffic of all links, bytes.");
    m("by_direction", bytes.by_direction, "Numbers of bytes over the +x, -x, +y, -y, +z and -z links of all nodes.");
    m("sent_by_node", bytes.sent, "Number of bytes that each node sent.");
}

void torus_part_members(Members& m, const TorusSettings& settings, const TorusResult& result, const LinkBytes& bytes) {
    std::uint64_t live_max = 0;
    for (const Superstep& step : result.supersteps) live_max = std::max(live_max, step.live);
    m("nodes", std::to_array(settings.torus.nodes), "Numbers of nodes along x, y and z.");
    m("voxels", settings.voxels, "Numbers of voxels of the scene's bounding box along x, y and z.");
    m("links", links_name(settings.links), "`torus3d`: six links per node. `torus2d`: four links per node.");
    m("inject", settings.inject == Injection::kRoot ? "root" : "all", "Nodes that make primary rays: `root` or `all`.");
    m("discarded", result.events[RAYA_DISCARDED], "Primary rays that nodes made for other nodes and discarded.");
    m("returns", "Modelled messages that carry contributions to the root (--returns).", [&](Members& returns) {
        returns("of", returns_name(settings.packets),
                "`terms`: each contribution of a ray is a message. `rays`: all of a ray are one.");
        returns("messages", result.returns, "Number of return messages.");
    });
    m("message_words", "Modelled size of messages in 32-bit words (--packet-words).", [&](Members& words) {
        words("ray", settings.packets.ray_words, "Number of words of a ray.");
        words("return", settings.packets.return_words(), "Number of words of a return.");
    });
    m("supersteps", result.supersteps.size(), "Number of supersteps until no packet was left.");
    m("packets", "Numbers of packets by kind.", [&](Members& packets) { packet_members(packets, result); });
    m("live_max", live_max, "Maximum number of packets in all queues and mailboxes at the end of a superstep.");
    m("hops", result.hops, "Number of messages over links, once for each link that a message crosses.");
    m("bytes_per_link", "Modelled traffic of the links. Each direction of a connection counts as one link.",
      [&](Members& links) { link_members(links, bytes); });
    m("queue", result.buffers.queue, "Capacity of a node's queue, packets.");
    m("queue_max", result.queue_max, "Maximum number of packets in a node's queue.");
    m("box", result.buffers.box, "Capacity of each outbox and inbox, packets.");
    m("copies", result.copies, "Number of additional copies of objects that lie in several voxels.");
}

void asynchronous_members(Members& m, const AsynchronousTime& time) {
    m("finish", time.finish_ms, "Time at which all tasks and all deliveries have ended, ms.");
    m("processor", time.processor_ms, "Busy time of the busiest node, ms.");
    m("links", time.links_ms, "Busy time of the busiest direction of a link, ms.");
    m("port", time.port_ms, "Longest time for which full buffers blocked a node's main task, ms.");
    m("delivered", time.delivered, "Number of delivered messages, including messages from a node to itself.");
    m("queue_max", time.queue_max, "Maximum number of rays in the queue of a node's main task.");
}

void time_members(Members& m, const TorusTime& time) {
    m("compute", time.compute_ms, "Processor time for computation, maximum over the nodes, ms.");
    m("messages", time.messages_ms, "Processor time for sending and receiving messages, maximum over the nodes, ms.");
    m("processor", time.processor_ms, "Processor time for computation and messages, maximum over the nodes, ms.");
    m("links", time.links_ms, "Transfer time in both directions, maximum over the links, ms.");
    m("overlapped", time.overlapped_ms, "Lower bound: no processor and no link ever waits, ms.");
    m("stepwise", time.stepwise_ms,
      "Upper bound: each superstep waits for its busiest node, then for its busiest link, ms.");
    m.when(time.asynchronous.has_value(), "asynchronous",
           "With --async: times of the machine without supersteps, simulated packet by packet "
           "(host/torus/async_machine.hpp).",
           [&](Members& ms) { asynchronous_members(ms, time.asynchronous.value_or(AsynchronousTime{})); });
}

std::string lines(const TorusSettings& settings, const TorusResult& result, const LinkBytes& bytes,
                  const TorusTime& time) {
    const auto made = std::accumulate(result.made.begin(), result.made.end(), std::uint64_t{0});
    std::string kinds;
    for (std::size_t kind = 1; kind < RAYA_KINDS; ++kind)
        kinds += fmt::format("{}{} {}", kinds.empty() ? "" : " + ", result.made[kind], kPacketKinds[kind]);
    std::string text =
        fmt::format("packets {} = {}; {}\n", made, kinds, counted(result.supersteps.size(), "superstep"));
    text += fmt::format("charged {} of {}, {} words a ray and {} a return; {} primary rays discarded\n",
                        counted(result.returns, "return"), returns_name(settings.packets), settings.packets.ray_words,
                        settings.packets.return_words(), result.events[RAYA_DISCARDED]);
    text += fmt::format("links   {} over {}, {} in all; mean {}, maximum {} over one link\n",
                        counted(result.hops, "message"), counted(bytes.links, "link"),
                        data_text(static_cast<double>(bytes.total)), data_text(bytes.mean()),
                        data_text(static_cast<double>(bytes.max)));
    text += fmt::format(
        "model   {} if nothing waits (processors {}: compute {}, messages {}; links {}), {} step by step (modelled "
        "time of T805s)\n",
        time_text(time.overlapped_ms), time_text(time.processor_ms), time_text(time.compute_ms),
        time_text(time.messages_ms), time_text(time.links_ms), time_text(time.stepwise_ms));
    if (const auto& async = time.asynchronous)
        text += fmt::format(
            "async   {} without supersteps (busiest processor {}, link {}; longest wait of a main task for links {}; "
            "{} messages)\n",
            time_text(async->finish_ms), time_text(async->processor_ms), time_text(async->links_ms),
            time_text(async->port_ms), async->delivered);
    return text;
}

}  // namespace

void t805_members(Members& m, const EventCounts& events, const PacketCharge& packets) {
    const Operations operations = operations_of(events);
    std::uint64_t additions = 0, multiplications = 0, words = 0;
    for (std::size_t event = 0; event < events.size(); ++event) {
        const Budget& work = budgets()[event];
        additions += events[event] * work.additions;
        multiplications += events[event] * work.multiplications;
        words += events[event] * packets.words_of(work.creates);
    }
    m("additions", additions, "Number of additions, subtractions and comparisons.");
    m("multiplications", multiplications, "Number of multiplications.");
    m("divisions", operations.divisions, "Number of divisions.");
    m("roots", operations.roots, "Number of square roots.");
    m("moves", operations.moves, "Number of moves. A move is a load and a store.");
    m("packet_words", words, "Number of words stored to create packets.");
    m("branches", operations.branches, "Number of branches.");
}

void torus_members(Members& m, const TorusSettings& settings, const TorusResult& result, const TorusTime& time) {
    const LinkBytes bytes(settings.torus, result.link_words);
    m("torus", "Torus: nodes, packets and links (Yoshitani & Yamazaki, about 1995).",
      [&](Members& torus) { torus_part_members(torus, settings, result, bytes); });
    m("budget", "", [&](Members& budget) { t805_members(budget, result.events, settings.packets); });
    m("modelled_ms", "", [&](Members& ms) { time_members(ms, time); });
}

MachineReport torus_report(const TorusSettings& settings, const TorusResult& result,
                           const std::optional<AsynchronousTime>& asynchronous) {
    const LinkBytes bytes(settings.torus, result.link_words);
    TorusTime time = torus_time(settings.torus, result);
    time.asynchronous = asynchronous;
    Members members(Members::Mode::kWrite);
    torus_members(members, settings, result, time);
    return {
        .json = members.json(),
        .title = fmt::format("{} nodes, {}, {} voxels", fmt::join(settings.torus.nodes, "x"),
                             links_name(settings.links), fmt::join(settings.voxels, "x")),
        .lines = lines(settings, result, bytes, time),
        .memory = fmt::format("; queues of {}, at most {} used; {} of objects", counted(result.buffers.queue, "packet"),
                              result.queue_max, counted(result.copies, "copy", "copies"))};
}

}  // namespace raya
