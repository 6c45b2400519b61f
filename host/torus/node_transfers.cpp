// The functions of node_array.hpp that evaluate the nodes' status and record packets for a
// trace.
#include <algorithm>
#include <cmath>

#include "host/torus/node_array.hpp"

namespace raya {
namespace {

std::uint64_t cycles_of(const NodeStatus& status, std::uint32_t node) {
    return status.at(node, RAYA_STATUS_CYCLES) | std::uint64_t{status.at(node, RAYA_STATUS_CYCLES + 1)} << 32;
}

bool is_return(const raya_head& packet) { return raya_state_kind(packet.state) == RAYA_KIND_RETURN; }

// Returns true if the node of the outbox created or changed the packet, and the model charges the packet as a message.
bool is_new_message(const raya_head& packet) {
    return packet.state & RAYA_STATE_FRESH && (!is_return(packet) || packet.state & RAYA_STATE_CHARGED);
}

PacketRecord record_of(const TorusSettings& settings, std::uint32_t superstep, std::uint32_t node,
                       const raya_head& packet) {
    PacketRecord record{.superstep = superstep,
                        .source = node,
                        .destination = RAYA_ROOT,
                        .head = packet,
                        .words = settings.packets.return_words()};
    if (is_return(packet)) return record;
    record.words = settings.packets.ray_words;
    const raya_torus& torus = settings.torus;
    const raya_place v = raya_unpack_place(packet.voxel);
    record.destination =
        raya_node_of(torus, v.at[0] % torus.nodes[0], v.at[1] % torus.nodes[1], v.at[2] % torus.nodes[2]);
    return record;
}

}  // namespace

std::vector<std::uint64_t> cycles_of_nodes(const NodeStatus& status, std::uint32_t nodes) {
    std::vector<std::uint64_t> cycles;
    for (std::uint32_t node = 0; node < nodes; ++node) cycles.push_back(cycles_of(status, node));
    return cycles;
}

MachineState machine_state(const NodeStatus& status, std::uint32_t nodes, std::uint32_t capacity) {
    MachineState state;
    std::uint64_t rows = 0, injected_rows = 0;
    for (std::uint32_t node = 0; node < nodes; ++node) {
        const auto at = [&](std::uint32_t word) { return status.at(node, word); };
        state.live += at(RAYA_STATUS_QUEUE) + at(RAYA_STATUS_HOST);
        for (std::uint32_t link = 0; link < RAYA_LINKS; ++link)
            state.live += at(RAYA_STATUS_OUTBOX + link) + at(RAYA_STATUS_INBOX + link) +
                          at(RAYA_STATUS_RETURN_OUTBOX + link) + at(RAYA_STATUS_RETURN_INBOX + link);
        state.longest_queue = std::max(state.longest_queue, at(RAYA_STATUS_QUEUE));
        state.full_queues += at(RAYA_STATUS_QUEUE) >= capacity;
        state.progress += at(RAYA_STATUS_PROGRESS);
        state.max_cycles = std::max(state.max_cycles, cycles_of(status, node));
        state.all_injected &= at(RAYA_STATUS_NEXT_ROW) >= at(RAYA_STATUS_ROWS);
        rows += at(RAYA_STATUS_ROWS);
        injected_rows += at(RAYA_STATUS_NEXT_ROW);
    }
    state.injected_fraction = rows ? static_cast<double>(injected_rows) / static_cast<double>(rows) : 1;
    return state;
}

double progress_of(const MachineState& state, std::size_t returns, std::uint64_t max_live) {
    const auto finished_packets = static_cast<double>(returns), live_packets = static_cast<double>(state.live);
    if (live_packets == 0) return state.injected_fraction;
    const double decrease = 1 - std::log1p(live_packets) / std::log1p(static_cast<double>(max_live));
    return state.injected_fraction * (finished_packets / (finished_packets + live_packets) + decrease) / 2;
}

void NodeArray::record_packets(const NodeStatus& status, std::uint32_t superstep, const PacketSink& sink) {
    if (!sink) {
        ray_links_.visit_new_packets(status, {});
        return return_links_.visit_new_packets(status, {});
    }
    std::vector<PacketRecord> own_records;
    const auto record_new = [&](std::uint32_t node, const raya_head& packet) {
        if (is_new_message(packet)) own_records.push_back(record_of(settings_, superstep, node, packet));
    };
    ray_links_.visit_new_packets(status, record_new);
    return_links_.visit_new_packets(status, record_new);
    std::vector<PacketRecord> records =
        ranks_.gather(std::span<const PacketRecord>(own_records), ranks_.all_gather(own_records.size()));
    std::stable_sort(records.begin(), records.end(),
                     [](const PacketRecord& a, const PacketRecord& b) { return a.source < b.source; });
    for (const PacketRecord& record : records) sink(record);
}

}  // namespace raya
