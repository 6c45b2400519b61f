#include "host/torus/torus_result.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "host/model/t805.hpp"
#include "kernels/shared/traffic.h"

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

}  // namespace raya
