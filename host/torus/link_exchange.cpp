#include "host/torus/link_exchange.hpp"

#include <algorithm>
#include <cstring>
#include <numeric>

namespace raya {
namespace {

raya_head head_at(const std::uint32_t* packet) {
    raya_head head;
    std::memcpy(&head, packet, sizeof head);
    return head;
}

}  // namespace

std::string link_name(std::uint32_t link) { return std::string(link % 2 == 0 ? "+" : "-") + "xyz"[link / 2]; }

LinkExchange::LinkExchange(Session& session, const NodeDistribution& distribution, std::uint32_t capacity,
                           const PacketClass& packet_class, const ExchangeKernel& kernel, std::uint32_t group_size,
                           Buffer<std::uint32_t>& status)
    : session_(session),
      distribution_(distribution),
      torus_(distribution.torus()),
      nodes_(distribution.count()),
      capacity_(capacity),
      class_(packet_class),
      outboxes_(session.buffer<std::uint32_t>("outboxes", outbox_at(RAYA_LINKS, 0))),
      inboxes_(session.buffer<std::uint32_t>("inboxes", inbox_at(RAYA_LINKS, 0))),
      flag_buffer_(session.buffer<std::uint32_t>("sent flags", std::size_t{RAYA_LINKS} * distribution.inboxes())),
      kernel_(kernel),
      group_size_(group_size),
      status_(status),
      end_slots_(session.buffer<std::uint32_t>("ends of links", std::size_t{RAYA_LINKS} * nodes_)),
      rank_links_(find_rank_links()) {
    std::vector<std::uint32_t> end_slots;
    for (std::uint32_t link = 0; link < RAYA_LINKS; ++link)
        for (const std::uint32_t node : distribution_.own()) {
            const bool stays_on_device = torus_.sides[link / 2] > 1 && !crosses_ranks(link, node);
            end_slots.push_back(stays_on_device ? distribution_.slot_of(raya_link_end(torus_, node, link))
                                                : RAYA_NO_SLOT);
        }
    session_.write("scatter", end_slots_, end_slots);
}

void LinkExchange::clear() {
    const std::size_t outboxes = std::size_t{RAYA_LINKS} * nodes_;
    sent_flags_.assign(outboxes, 0);
    device_flags_ = sent_flags_;
    session_.fill("clear mailboxes", flag_buffer_, 0);
    // Clears only the packet counts, because mailboxes are large and most of their memory pages are never used.
    const Session::Blocks zeros{.pitch = 1}, boxes{.pitch = box_words(capacity_)};
    session_.copy_blocks("clear mailboxes", flag_buffer_, zeros, inboxes_, boxes, 1, flag_buffer_.size());
    session_.copy_blocks("clear mailboxes", flag_buffer_, zeros, outboxes_, boxes, 1, outboxes);
    visited_.assign(outboxes, 0);
    counts_.messages.assign(std::size_t{RAYA_LINKS} * raya_nodes(torus_), 0);
    counts_.packets = counts_.messages;
}

void LinkExchange::exchange(const NodeStatus& status, std::vector<std::uint64_t>& words) {
    std::fill(sent_flags_.begin(), sent_flags_.end(), 0);
    for (std::uint32_t link = 0; link < RAYA_LINKS; ++link) {
        if (torus_.sides[link / 2] == 1) continue;
        count_transfers(status, link, words);
    }
    // The kernel sets the flags of the transfers within this rank. Other transfers exist only if links cross ranks.
    if (!rank_links_.empty()) write_sent_flags();
    launch_kernel();
}

// Counts the transfers over the links of one direction (`link`), and sets their flags in sent_flags_.
void LinkExchange::count_transfers(const NodeStatus& status, std::uint32_t link, std::vector<std::uint64_t>& words) {
    for (std::uint32_t node = 0; node < raya_nodes(torus_); ++node) {
        const std::uint32_t packets = status.at(node, class_.outbox_status + link);
        if (packets == 0 || inbox_occupied(status, link, node)) continue;
        if (distribution_.has(node)) sent_flags_[std::size_t{link} * nodes_ + distribution_.slot_of(node)] = 1;
        const std::uint64_t messages = class_.charged_status ? status.at(node, *class_.charged_status) : packets;
        const std::size_t i = std::size_t{node} * RAYA_LINKS + link;
        words[i] += messages * class_.charged_words;
        counts_.messages[i] += messages;
        counts_.packets[i] += packets;
    }
}

void LinkExchange::launch_kernel() {
    if (std::find(sent_flags_.begin(), sent_flags_.end(), 1u) == sent_flags_.end() && sent_flags_ == device_flags_)
        return;
    session_.launch(class_.label, kernel_, std::size_t{RAYA_LINKS} * nodes_, group_size_, end_slots_,
                    Uint<"nodes">{nodes_}, Uint<"inboxes_of_link">{distribution_.inboxes()},
                    Uint<"capacity">{capacity_}, Uint<"packet_words">{class_.packet_words},
                    Uint<"outbox_status">{class_.outbox_status}, Uint<"inbox_status">{class_.inbox_status}, outboxes_,
                    inboxes_, flag_buffer_, status_);
    device_flags_ = sent_flags_;
}

void LinkExchange::write_sent_flags() {
    if (sent_flags_ == device_flags_) return;
    session_.write(class_.label, flag_buffer_, sent_flags_);
    device_flags_ = sent_flags_;
}

bool LinkExchange::inbox_occupied(const NodeStatus& status, std::uint32_t link, std::uint32_t sender) const {
    return status.at(raya_link_end(torus_, sender, link), class_.inbox_status + link) > 0;
}

bool LinkExchange::crosses_ranks(std::uint32_t link, std::uint32_t sender) const {
    return distribution_.rank_of(raya_link_end(torus_, sender, link)) != distribution_.rank_of(sender);
}

LinkExchange::LinkMessage& LinkExchange::message_for(std::vector<LinkMessage>& messages, std::uint32_t rank,
                                                     std::uint32_t link) const {
    for (LinkMessage& m : messages)
        if (m.rank == rank && m.link == link) return m;
    return messages.emplace_back(LinkMessage{rank, link, {}, {}});
}

std::vector<LinkExchange::RankLink> LinkExchange::find_rank_links() const {
    std::vector<RankLink> rank_links;
    for (std::uint32_t link = 0; link < RAYA_LINKS; ++link)
        for (std::uint32_t node = 0; node < raya_nodes(torus_); ++node) {
            const std::uint32_t end = raya_link_end(torus_, node, link);
            if (distribution_.has(node) != distribution_.has(end))
                rank_links.push_back({link, node, distribution_.rank_of(distribution_.has(node) ? end : node)});
        }
    return rank_links;
}

// Sender and receiver of a message read the number of packets in each mailbox from the status, so both know the length.
void LinkExchange::begin_transfers(const NodeStatus& status, std::vector<OutgoingMessage>& out,
                                   std::vector<IncomingMessage>& in) {
    outgoing_.clear();
    incoming_.clear();
    for (const auto& [link, sender, rank] : rank_links_) {
        const std::uint32_t packets = status.at(sender, class_.outbox_status + link);
        if (packets == 0 || inbox_occupied(status, link, sender)) continue;
        LinkMessage& m = message_for(distribution_.has(sender) ? outgoing_ : incoming_, rank, link);
        m.senders.push_back(sender);
        m.packets.push_back(packets);
        m.words += box_words(packets);
    }
    const auto words_of = [](const std::vector<LinkMessage>& messages) {
        return std::accumulate(messages.begin(), messages.end(), std::size_t{0},
                               [](std::size_t words, const LinkMessage& m) { return words + m.words; });
    };
    const auto tag = [&](const LinkMessage& m) {
        return class_.tag * static_cast<int>(RAYA_LINKS) + static_cast<int>(m.link);
    };
    if (const std::size_t words = words_of(outgoing_);
        words > 0 && (!outgoing_words_ || outgoing_words_->size() < words))
        outgoing_words_.emplace(session_.readback<std::uint32_t>(class_.label + " outgoing", words));
    std::size_t at = 0;
    for (const LinkMessage& m : outgoing_) {
        read_message(m, at);
        at += m.words;
        out.push_back({m.rank, tag(m), std::as_bytes(outgoing_words_->first(at).last(m.words))});
    }
    incoming_words_.resize(words_of(incoming_));
    std::span<std::uint32_t> unused = incoming_words_;
    for (const LinkMessage& m : incoming_) {
        in.push_back({m.rank, tag(m), std::as_writable_bytes(unused.first(m.words))});
        unused = unused.subspan(m.words);
    }
}

// Starts to read the packets of a message from the outboxes into outgoing_words_, from `first_word` on.
void LinkExchange::read_message(const LinkMessage& m, std::size_t first_word) {
    for (std::size_t i = 0; i < m.senders.size(); ++i) {
        const std::size_t words = box_words(m.packets[i]);
        session_.read(class_.label + " outgoing", outboxes_, outbox_at(m.link, distribution_.slot_of(m.senders[i])),
                      *outgoing_words_, first_word, words);
        first_word += words;
    }
}

void LinkExchange::wait_for_outgoing() {
    if (outgoing_words_) session_.wait(class_.label + " outgoing", *outgoing_words_);
}

void LinkExchange::write_incoming() {
    std::span<const std::uint32_t> unwritten = incoming_words_;
    for (const LinkMessage& m : incoming_)
        for (std::size_t i = 0; i < m.senders.size(); ++i) {
            const std::size_t words = box_words(m.packets[i]);
            session_.write(class_.label + " incoming", inboxes_, unwritten.first(words),
                           inbox_at(m.link, distribution_.inbox_from(m.senders[i], m.link)));
            unwritten = unwritten.subspan(words);
        }
}

void LinkExchange::visit_new_packets(const NodeStatus& status,
                                     const std::function<void(std::uint32_t, const raya_head&)>& visit) {
    for (std::uint32_t slot = 0; slot < nodes_; ++slot) {
        const std::uint32_t node = distribution_.own()[slot];
        for (std::uint32_t link = 0; link < RAYA_LINKS; ++link) {
            const std::uint32_t packets = status.at(node, class_.outbox_status + link);
            const std::size_t box = std::size_t{link} * nodes_ + slot;
            const std::uint32_t first = sent_flags_[box] ? 0 : visited_[box];
            visited_[box] = packets;
            if (!visit) continue;
            std::vector<std::uint32_t> words(std::size_t{packets - first} * class_.packet_words);
            session_.read("record", outboxes_, words, outbox_at(link, slot) + box_words(first));
            for (std::size_t i = 0; i < words.size(); i += class_.packet_words) visit(node, head_at(&words[i]));
        }
    }
}

void LinkExchange::visit_state(RenderState& state, const NodeStatus& status) {
    state.vector(counts_.messages);
    state.vector(counts_.packets);
    for (const bool out : {true, false}) {
        Buffer<std::uint32_t>& boxes = out ? outboxes_ : inboxes_;
        const auto packets_in = [&](std::uint32_t node, std::uint32_t link) {
            return status.at(node, (out ? class_.outbox_status : class_.inbox_status) + link);
        };
        const auto box_at = [&](std::uint32_t node, std::uint32_t link) {
            return out ? outbox_at(link, distribution_.slot_of(node))
                       : inbox_at(link, distribution_.inbox_from(raya_link_end(torus_, node, link ^ 1u), link));
        };
        state.parts(boxes, [&](std::uint32_t node) {
            std::vector<RenderState::Part> parts;
            for (std::uint32_t link = 0; link < RAYA_LINKS; ++link)
                if (const std::size_t packets = packets_in(node, link); packets > 0)
                    parts.push_back({box_at(node, link) + box_words(0), packets * class_.packet_words});
            return parts;
        });
        for (std::uint32_t slot = 0; slot < (state.restores() ? nodes_ : 0); ++slot)
            for (std::uint32_t node = distribution_.own()[slot], link = 0; link < RAYA_LINKS; ++link)
                if (const std::uint32_t packets = packets_in(node, link); packets > 0)
                    session_.write("resume", boxes, {&packets, 1}, box_at(node, link));
    }
}

std::uint64_t LinkExchange::sent_packets() const {
    std::uint64_t packets = 0;
    for (const std::uint32_t node : distribution_.own())
        for (std::uint32_t link = 0; link < RAYA_LINKS; ++link)
            packets += counts_.packets[std::size_t{node} * RAYA_LINKS + link];
    return packets;
}

std::uint64_t LinkExchange::received_packets() const {
    std::uint64_t packets = 0;
    for (const std::uint32_t node : distribution_.own())
        for (std::uint32_t link = 0; link < RAYA_LINKS; ++link)
            packets += counts_.packets[std::size_t{raya_link_end(torus_, node, link ^ 1u)} * RAYA_LINKS + link];
    return packets;
}

}  // namespace raya
