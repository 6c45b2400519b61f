// The functions of node_array.hpp and link_exchange.hpp that save and restore the state of the nodes, for checkpoints.
#include <algorithm>
#include <cstring>
#include <utility>

#include "host/torus/node_array.hpp"

namespace raya {
namespace {

// Returns [nodes + 1]: index of each node's first word in NodesState::packets.
std::vector<std::size_t> packet_starts(const NodeStatus& status, std::uint32_t nodes) {
    std::vector<std::size_t> starts = {0};
    for (std::uint32_t node = 0; node < nodes; ++node) starts.push_back(starts.back() + packet_words(status, node));
    return starts;
}

// Returns the elements of `nodes` of [node][per_node].
template <class T>
std::vector<T> elements_of(const std::vector<std::uint32_t>& nodes, const std::vector<T>& elements,
                           std::size_t per_node) {
    std::vector<T> selected;
    for (const std::uint32_t node : nodes) {
        const auto first = elements.begin() + static_cast<std::ptrdiff_t>(per_node * node);
        selected.insert(selected.end(), first, first + static_cast<std::ptrdiff_t>(per_node));
    }
    return selected;
}

}  // namespace

// Calls visit(buffer, index of the mailbox's first word, number of packets) for the mailboxes of a node that hold
// packets.
template <class Visit>
void LinkExchange::for_each_box(const NodeStatus& status, std::uint32_t node, Visit&& visit) {
    for (std::uint32_t link = 0; link < RAYA_LINKS; ++link) {
        const std::uint32_t sender = raya_link_end(torus_, node, link ^ 1u);
        if (const std::uint32_t packets = status.at(node, class_.outbox_status + link); packets > 0)
            visit(outboxes_, outbox_at(link, distribution_.slot_of(node)), packets);
        if (const std::uint32_t packets = status.at(node, class_.inbox_status + link); packets > 0)
            visit(inboxes_, inbox_at(link, distribution_.inbox_from(sender, link)), packets);
    }
}

void LinkExchange::read_boxes(const NodeStatus& status, std::uint32_t node, std::vector<std::uint32_t>& words) {
    for_each_box(status, node, [&](const Buffer<std::uint32_t>& boxes, std::size_t at, std::uint32_t packets) {
        const std::size_t first = words.size();
        words.resize(first + std::size_t{packets} * class_.packet_words);
        session_.read("save", boxes, std::span(words).subspan(first), at + box_words(0));
    });
}

std::span<const std::uint32_t> LinkExchange::write_boxes(const NodeStatus& status, std::uint32_t node,
                                                         std::span<const std::uint32_t> words) {
    for_each_box(status, node, [&](Buffer<std::uint32_t>& boxes, std::size_t at, std::uint32_t packets) {
        std::vector<std::uint32_t> box(box_words(packets));
        box[0] = packets;
        const std::size_t count = box.size() - box_words(0);
        std::copy_n(words.begin(), count, box.begin() + static_cast<std::ptrdiff_t>(box_words(0)));
        session_.write("resume", boxes, box, at);
        words = words.subspan(count);
    });
    return words;
}

NodesState NodeArray::save(const NodeStatus& status) {
    NodesState state{.status = status.words,
                     .events = gather_counters(events_),
                     .made = gather_counters(made_),
                     .ended = gather_counters(ended_),
                     .rays = ray_links_.counts(),
                     .returns = return_links_.counts(),
                     .packets = {}};
    std::vector<std::uint32_t> own_words;
    for (std::uint32_t slot = 0; slot < nodes_; ++slot) {
        const std::uint32_t node = distribution_.own_nodes()[slot];
        std::vector<raya_packet> queue(status.at(node, RAYA_STATUS_QUEUE));
        if (!queue.empty()) session_.read("save", queues_, queue, std::size_t{slot} * buffers_.queue);
        const auto* const words = reinterpret_cast<const std::uint32_t*>(queue.data());
        own_words.insert(own_words.end(), words, words + queue.size() * RAYA_PACKET_WORDS);
        ray_links_.read_boxes(status, node, own_words);
        return_links_.read_boxes(status, node, own_words);
    }
    const std::vector<std::size_t> sizes = ranks_.all_gather(own_words.size());
    const std::vector<std::uint32_t> by_rank = ranks_.gather(std::span<const std::uint32_t>(own_words), sizes);
    const std::vector<std::size_t> starts = packet_starts(status, raya_nodes(settings_.torus));
    state.packets.resize(by_rank.size());
    auto source = by_rank.begin();
    for (std::uint32_t rank = 0; rank < (ranks_.is_first() ? ranks_.count() : 0); ++rank)
        for (const std::uint32_t node : distribution_.nodes_of(rank)) {
            const auto end = source + static_cast<std::ptrdiff_t>(starts[node + 1] - starts[node]);
            std::copy(source, end, state.packets.begin() + static_cast<std::ptrdiff_t>(starts[node]));
            source = end;
        }
    return state;
}

void NodeArray::restore(NodesState state) {
    clear();
    ranks_.broadcast(state.status);
    const NodeStatus status(state.status);
    session_.write("resume", status_, elements_of(distribution_.own_nodes(), state.status, RAYA_STATUS_WORDS));
    for (const auto& [counters, all] :
         {std::pair(&events_, &state.events), {&made_, &state.made}, {&ended_, &state.ended}}) {
        ranks_.broadcast(*all);
        session_.write("resume", *counters, elements_of(distribution_.own_nodes(), *all, counters->size() / nodes_));
    }
    for (const auto& [links, counts] : {std::pair(&ray_links_, &state.rays), {&return_links_, &state.returns}}) {
        ranks_.broadcast(counts->messages);
        ranks_.broadcast(counts->packets);
        links->set_counts(std::move(*counts));
    }
    write_packets(status, scatter_packets(status, state.packets));
}

// Sends each rank the words of its nodes' packets. Returns those of this rank, node after node. Only rank 0 has `all`.
std::vector<std::uint32_t> NodeArray::scatter_packets(const NodeStatus& status, const std::vector<std::uint32_t>& all) {
    if (!ranks_.is_first()) {
        std::size_t own_words = 0;
        for (const std::uint32_t node : distribution_.own_nodes()) own_words += packet_words(status, node);
        std::vector<std::uint32_t> words(own_words);
        ranks_.receive(0, std::span(words));
        return words;
    }
    const std::vector<std::size_t> starts = packet_starts(status, raya_nodes(settings_.torus));
    const auto words_of = [&](std::uint32_t rank) {
        std::vector<std::uint32_t> words;
        for (const std::uint32_t node : distribution_.nodes_of(rank))
            words.insert(words.end(), all.begin() + static_cast<std::ptrdiff_t>(starts[node]),
                         all.begin() + static_cast<std::ptrdiff_t>(starts[node + 1]));
        return words;
    };
    for (std::uint32_t rank = 1; rank < ranks_.count(); ++rank)
        ranks_.send(rank, std::span<const std::uint32_t>(words_of(rank)));
    return words_of(0);
}

void NodeArray::write_packets(const NodeStatus& status, std::span<const std::uint32_t> words) {
    for (std::uint32_t slot = 0; slot < nodes_; ++slot) {
        const std::uint32_t node = distribution_.own_nodes()[slot];
        std::vector<raya_packet> queue(status.at(node, RAYA_STATUS_QUEUE));
        if (!queue.empty()) {
            std::memcpy(queue.data(), words.data(), queue.size() * sizeof queue[0]);
            session_.write("resume", queues_, queue, std::size_t{slot} * buffers_.queue);
        }
        words = words.subspan(queue.size() * RAYA_PACKET_WORDS);
        words = ray_links_.write_boxes(status, node, words);
        words = return_links_.write_boxes(status, node, words);
    }
}

}  // namespace raya
