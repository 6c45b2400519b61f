#include "host/torus/torus_result.hpp"

#include <fmt/core.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <numeric>
#include <stdexcept>
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

double stepwise_ms(const std::vector<Superstep>& supersteps) {
    double total_ms = 0;
    for (const Superstep& step : supersteps)
        total_ms += t805_ms(step.max_node_cycles) + t805_link_ms(step.max_link_words, step.max_link_words);
    return total_ms;
}

}  // namespace

TorusDeadlock::TorusDeadlock(const DeadlockFigures& state)
    : UserError(fmt::format("{}: deadlock in superstep {}: {} packets wait for each other, {} of {} queues are full at "
                            "{} packets; use a longer queue",
                            state.scene, state.superstep, state.live, state.full, state.nodes, state.queue)),
      figures(state) {}

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
    KernelWork route, accept, compose;
    route.label = "route";
    route.bytes =
        copied_bytes("route") +
        2 * kWordBytes * (r.sent_rays * RAYA_PACKET_WORDS + r.rank_made[RAYA_KIND_RETURN] * RAYA_RETURN_WORDS);
    accept.label = "accept";
    accept.bytes = 2 * kWordBytes * (r.received_rays * RAYA_PACKET_WORDS + r.received_returns * RAYA_RETURN_WORDS);
    compose.label = "compose";  // three multiply-adds for each contribution
    compose.operations = 3 * r.contributions;
    compose.bytes = r.contributions * 4 * sizeof(float) + kWordBytes * (pixels + 1) + 3 * sizeof(float) * pixels;
    return {inject, trace, route, accept, compose};
}

TorusTime torus_time(const raya_torus& torus, const TorusResult& result) {
    const std::size_t nodes = raya_nodes(torus), links = nodes * RAYA_LINKS;
    if (result.load.per_pe.size() != nodes || result.link_words.size() != links || result.link_packets.size() != links)
        throw std::invalid_argument("torus_time: the result is of a torus with another number of nodes");
    const std::vector<std::uint64_t> messages = message_cycles(torus, result);
    std::uint64_t processor_cycles = 0;
    for (std::size_t node = 0; node < nodes; ++node)
        processor_cycles = std::max(processor_cycles, result.load.per_pe[node] + messages[node]);
    TorusTime time;
    time.compute_ms = t805_ms(result.load.max);
    time.messages_ms = t805_ms(*std::max_element(messages.begin(), messages.end()));
    time.processor_ms = t805_ms(processor_cycles);
    time.links_ms = busiest_link_ms(torus, result);
    time.overlapped_ms = std::max(time.processor_ms, time.links_ms);
    time.stepwise_ms = stepwise_ms(result.supersteps);
    return time;
}

namespace {

struct Kind {
    std::uint32_t number;
    const char* name;
};
constexpr std::array<Kind, RAYA_KINDS - 1> kKinds = {{{RAYA_KIND_PRIMARY, "primary"},
                                                      {RAYA_KIND_REFLECTED, "reflected"},
                                                      {RAYA_KIND_REFRACTED, "refracted"},
                                                      {RAYA_KIND_SHADOW, "shadow"},
                                                      {RAYA_KIND_RETURN, "return"}}};

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

Json torus_json(const TorusSettings& settings, const TorusResult& result, const LinkBytes& bytes) {
    Json packets = Json::object();
    for (const Kind& kind : kKinds)
        packets[kind.name] = {{"made", result.made[kind.number]}, {"ended", result.ended[kind.number]}};
    std::uint64_t live_max = 0;
    for (const Superstep& step : result.supersteps) live_max = std::max(live_max, step.live);
    return {{"nodes", settings.torus.nodes},
            {"voxels", settings.voxels},
            {"links", links_name(settings.links)},
            {"inject", settings.inject == Injection::kRoot ? "root" : "all"},
            {"discarded", result.events[RAYA_DISCARDED]},
            {"returns", {{"of", returns_name(settings.packets)}, {"messages", result.returns}}},
            {"message_words", {{"ray", settings.packets.ray_words}, {"return", settings.packets.return_words()}}},
            {"supersteps", result.supersteps.size()},
            {"packets", packets},
            {"live_max", live_max},
            {"hops", result.hops},
            {"bytes_per_link",
             {{"links", bytes.links},
              {"max", bytes.max},
              {"mean", bytes.mean()},
              {"total", bytes.total},
              {"by_direction", bytes.by_direction},
              {"sent_by_node", bytes.sent}}},
            {"queue", result.buffers.queue},
            {"queue_max", result.queue_max},
            {"box", result.buffers.box},
            {"copies", result.copies}};
}

Json time_json(const TorusTime& time) {
    Json json = {{"compute", time.compute_ms}, {"messages", time.messages_ms},     {"processor", time.processor_ms},
                 {"links", time.links_ms},     {"overlapped", time.overlapped_ms}, {"stepwise", time.stepwise_ms}};
    if (const auto& async = time.asynchronous)
        json["asynchronous"] = {{"finish", async->finish_ms},    {"processor", async->processor_ms},
                                {"links", async->links_ms},      {"port", async->port_ms},
                                {"delivered", async->delivered}, {"queue_max", async->queue_max}};
    return json;
}

std::string lines(const TorusSettings& settings, const TorusResult& result, const LinkBytes& bytes,
                  const TorusTime& time) {
    const auto made = std::accumulate(result.made.begin(), result.made.end(), std::uint64_t{0});
    std::string kinds;
    for (const Kind& kind : kKinds)
        kinds += fmt::format("{}{} {}", kinds.empty() ? "" : " + ", result.made[kind.number], kind.name);
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

Json t805_budget_json(const EventCounts& events, const PacketCharge& packets) {
    const Operations operations = operations_of(events);
    std::uint64_t additions = 0, multiplications = 0, words = 0;
    for (std::size_t event = 0; event < events.size(); ++event) {
        const Budget& work = budgets()[event];
        additions += events[event] * work.additions;
        multiplications += events[event] * work.multiplications;
        words += events[event] * packets.words_of(work.creates);
    }
    return {{"additions", additions},         {"multiplications", multiplications}, {"divisions", operations.divisions},
            {"roots", operations.roots},      {"moves", operations.moves},          {"packet_words", words},
            {"branches", operations.branches}};
}

MachineReport torus_report(const TorusSettings& settings, const TorusResult& result,
                           const std::optional<AsynchronousTime>& asynchronous) {
    const LinkBytes bytes(settings.torus, result.link_words);
    TorusTime time = torus_time(settings.torus, result);
    time.asynchronous = asynchronous;
    return {
        .json = {{"torus", torus_json(settings, result, bytes)},
                 {"budget", t805_budget_json(result.events, settings.packets)},
                 {"modelled_ms", time_json(time)}},
        .title = fmt::format("{} nodes, {}, {} voxels", fmt::join(settings.torus.nodes, "x"),
                             links_name(settings.links), fmt::join(settings.voxels, "x")),
        .lines = lines(settings, result, bytes, time),
        .memory = fmt::format("; queues of {}, at most {} used; {} of objects", counted(result.buffers.queue, "packet"),
                              result.queue_max, counted(result.copies, "copy", "copies"))};
}

}  // namespace raya
