// The functions of node_array.hpp that evaluate the nodes' status, choose the method of link exchange, and record
// packets for a trace.
#include <algorithm>
#include <cmath>
#include <limits>

#include "host/base/clock.hpp"
#include "host/torus/node_array.hpp"

namespace raya {
namespace {

std::uint64_t cycles_of(const NodeStatus& status, std::uint32_t node) {
    return status.at(node, RAYA_STATUS_CYCLES) | std::uint64_t{status.at(node, RAYA_STATUS_CYCLES + 1)} << 32;
}

constexpr std::uint32_t kMeasuredPackets = 32;  // number of packets in each outbox during a measurement
constexpr int kRepetitions = 5;                 // number of timed exchanges; the measurement uses the shortest time

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

// If neither an option nor `raya tune` chose the method, measures both and chooses the faster one. CPUs are not
// measured: there the kernel is at least as fast as buffer copies (docs/tuning.md).
void NodeArray::choose_link_method(Kernels& kernels) {
    const LinkMove chosen = settings_.kernels.link_move;
    const bool cpu = session_.device().type == "cpu";
    links_origin_ = chosen != LinkMove::kAutomatic ? settings_.kernels.link_origin : cpu ? "defaults" : "measured";
    if (chosen == LinkMove::kCopies) return;
    const auto kernel = kernels.get<ExchangeKernel>();
    if (chosen == LinkMove::kKernel || cpu) return use_kernel(kernel);
    const double copies_s = measure_exchange_s();
    use_kernel(kernel);
    if (measure_exchange_s() < copies_s) return;
    ray_links_.use_copies();
    return_links_.use_copies();
    links_by_kernel_ = false;
}

void NodeArray::use_kernel(const ExchangeKernel& kernel) {
    ray_links_.use_kernel(kernel, options_.group_size, status_);
    return_links_.use_kernel(kernel, options_.group_size, status_);
    links_by_kernel_ = true;
}

// Returns the time of an exchange over all links with kMeasuredPackets packets in every outbox. The caller must call
// clear() afterwards.
double NodeArray::measure_exchange_s() {
    const std::uint32_t packets = std::min(kMeasuredPackets, buffers_.box);
    NodeStatus status(raya_nodes(settings_.torus));
    for (std::uint32_t node = 0; node < raya_nodes(settings_.torus); ++node) {
        const auto set_packets = [&](std::uint32_t word) {
            status.words[std::size_t{node} * RAYA_STATUS_WORDS + word] = packets;
        };
        for (std::uint32_t link = 0; link < RAYA_LINKS; ++link)
            if (settings_.torus.sides[link / 2] > 1) set_packets(RAYA_STATUS_OUTBOX + link);
        if (node != RAYA_ROOT) set_packets(RAYA_STATUS_RETURN_OUTBOX + raya_return_link(settings_.torus, node));
    }
    for (std::uint32_t slot = 0; slot < nodes_; ++slot) {
        const std::size_t node = distribution_.own_nodes()[slot];
        session_.write("measure links", status_,
                       std::span(status.words).subspan(node * RAYA_STATUS_WORDS, RAYA_STATUS_WORDS),
                       std::size_t{slot} * RAYA_STATUS_WORDS);
    }
    ray_links_.clear();
    return_links_.clear();
    std::vector<std::uint64_t> words(std::size_t{raya_nodes(settings_.torus)} * RAYA_LINKS);
    double min_exchange_s = std::numeric_limits<double>::max();
    for (int i = 0; i <= kRepetitions; ++i) {
        session_.finish();
        const Clock::time_point start = Clock::now();
        ray_links_.exchange(status, words);
        return_links_.exchange(status, words);
        session_.finish();
        const double seconds = seconds_since(start);
        if (i > 0) min_exchange_s = std::min(min_exchange_s, seconds);  // the first exchange may compile the kernel
    }
    return min_exchange_s;
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
    std::vector<PacketRecord> records = ranks_.has_several() ? gather_records(own_records) : std::move(own_records);
    std::stable_sort(records.begin(), records.end(),
                     [](const PacketRecord& a, const PacketRecord& b) { return a.source < b.source; });
    for (const PacketRecord& record : records) sink(record);
}

std::vector<PacketRecord> NodeArray::gather_records(const std::vector<PacketRecord>& own_records) {
    return ranks_.gather(std::span(own_records), ranks_.all_gather(own_records.size()));
}

}  // namespace raya
