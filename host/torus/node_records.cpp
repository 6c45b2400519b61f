// The messages that nodes put into their outboxes, as a trace of the traffic has them.
#include <algorithm>

#include "host/torus/node_array.hpp"

namespace raya {
namespace {

bool is_return(const raya_head& packet) { return raya_state_kind(packet.state) == RAYA_KIND_RETURN; }

// Whether a packet in an outbox is a message that its node has made.
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

void NodeArray::record(const NodeStatus& status, std::uint32_t superstep, const PacketSink& sink) {
    if (!sink) {
        rays_.visit_new(status, {});
        return homeward_.visit_new(status, {});
    }
    std::vector<PacketRecord> own;
    const auto take = [&](std::uint32_t node, const raya_head& packet) {
        if (is_new_message(packet)) own.push_back(record_of(settings_, superstep, node, packet));
    };
    rays_.visit_new(status, take);
    homeward_.visit_new(status, take);
    std::vector<PacketRecord> records = ranks_.many() ? records_of_all(own) : std::move(own);
    std::stable_sort(records.begin(), records.end(),
                     [](const PacketRecord& a, const PacketRecord& b) { return a.source < b.source; });
    for (const PacketRecord& record : records) sink(record);
}

std::vector<PacketRecord> NodeArray::records_of_all(const std::vector<PacketRecord>& own) {
    return ranks_.gather(std::span(own), ranks_.all_gather(own.size()));
}

}  // namespace raya
