#include "host/torus/link_exchange.hpp"

#include <algorithm>

#include "host/scene/packer.hpp"

namespace raya {

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
      end_slots_(session.buffer<std::uint32_t>("ends of links", std::size_t{RAYA_LINKS} * nodes_)) {
    std::vector<std::uint32_t> end_slots;
    for (std::uint32_t link = 0; link < RAYA_LINKS; ++link)
        for (const std::uint32_t node : distribution_.own()) {
            const std::uint32_t end = raya_link_end(torus_, node, link);
            const bool stays_on_device = torus_.sides[link / 2] > 1 && distribution_.has(end);
            end_slots.push_back(stays_on_device ? distribution_.slot_of(end) : RAYA_NO_SLOT);
        }
    session_.write("scatter", end_slots_, end_slots);
}

void LinkExchange::clear() {
    const std::size_t outboxes = std::size_t{RAYA_LINKS} * nodes_;
    sent_flags_.assign(outboxes, 0);
    session_.fill("clear mailboxes", flag_buffer_, 0);
    // Clears only the packet counts, because mailboxes are large and most of their memory pages are never used.
    const Session::Blocks zeros{.pitch = 1}, boxes{.pitch = box_words(capacity_)};
    session_.copy_blocks("clear mailboxes", flag_buffer_, zeros, inboxes_, boxes, 1, flag_buffer_.size());
    session_.copy_blocks("clear mailboxes", flag_buffer_, zeros, outboxes_, boxes, 1, outboxes);
    visited_.assign(outboxes, 0);
    messages_.assign(std::size_t{RAYA_LINKS} * raya_nodes(torus_), 0);
    sent_packets_ = received_packets_ = 0;
}

// Returns true if the outbox of the link holds packets and the inbox at its end is empty.
bool LinkExchange::transfers(const NodeStatus& status, std::uint32_t link, std::uint32_t sender) const {
    return status.at(sender, class_.outbox_status + link) > 0 &&
           status.at(raya_link_end(torus_, sender, link), class_.inbox_status + link) == 0;
}

void LinkExchange::exchange(const NodeStatus& status, std::vector<std::uint64_t>& words) {
    std::fill(sent_flags_.begin(), sent_flags_.end(), 0);
    for (std::uint32_t link = 0; link < RAYA_LINKS; ++link)
        for (std::uint32_t node = 0; node < raya_nodes(torus_); ++node) {
            if (torus_.sides[link / 2] == 1 || !transfers(status, link, node)) continue;
            const std::uint32_t packets = status.at(node, class_.outbox_status + link);
            const std::uint64_t messages = class_.charged_status ? status.at(node, *class_.charged_status) : packets;
            const std::size_t i = std::size_t{node} * RAYA_LINKS + link;
            words[i] += messages * class_.charged_words;
            messages_[i] += messages;
            if (distribution_.has(raya_link_end(torus_, node, link))) received_packets_ += packets;
            if (!distribution_.has(node)) continue;
            sent_packets_ += packets;
            sent_flags_[std::size_t{link} * nodes_ + distribution_.slot_of(node)] = 1;
        }
    // The kernel sets the flags of the transfers within this rank.
    if (distribution_.ranks().has_several()) session_.write(class_.label, flag_buffer_, sent_flags_);
    session_.launch(class_.label, kernel_, std::size_t{RAYA_LINKS} * nodes_, group_size_, end_slots_,
                    Uint<"nodes">{nodes_}, Uint<"inboxes_of_link">{distribution_.inboxes()},
                    Uint<"capacity">{capacity_}, Uint<"packet_words">{class_.packet_words},
                    Uint<"outbox_status">{class_.outbox_status}, Uint<"inbox_status">{class_.inbox_status}, outboxes_,
                    inboxes_, flag_buffer_, status_);
}

// Sender and receiver of a message read the number of packets in each mailbox from the status, so both know the length.
void LinkExchange::begin_transfers(const NodeStatus& status, std::vector<OutgoingMessage>& out,
                                   std::vector<IncomingMessage>& in) {
    outgoing_.clear();
    incoming_.clear();
    std::size_t words_out = 0, words_in = 0;
    for (std::uint32_t link = 0; link < RAYA_LINKS; ++link)
        for (std::uint32_t sender = 0; sender < raya_nodes(torus_); ++sender) {
            const std::uint32_t end = raya_link_end(torus_, sender, link);
            const bool sends = distribution_.has(sender);
            if (sends == distribution_.has(end) || !transfers(status, link, sender)) continue;
            const std::uint32_t packets = status.at(sender, class_.outbox_status + link);
            LinkMessage& m = (sends ? outgoing_ : incoming_)[{distribution_.rank_of(sends ? end : sender), link}];
            m.boxes.emplace_back(sender, packets);
            m.words += box_words(packets);
            (sends ? words_out : words_in) += box_words(packets);
        }
    const auto tag = [&](std::uint32_t link) {
        return class_.tag * static_cast<int>(RAYA_LINKS) + static_cast<int>(link);
    };
    const std::string label = class_.label + " outgoing";
    if (words_out > (outgoing_words_ ? outgoing_words_->size() : 0)) outgoing_words_.emplace(words_out);
    std::size_t at = 0;
    for (const auto& [key, m] : outgoing_) {
        const auto [rank, link] = key;
        for (const auto& [sender, packets] : m.boxes) {
            session_.read(label, outboxes_, outbox_at(link, distribution_.slot_of(sender)), *outgoing_words_, at,
                          box_words(packets));
            at += box_words(packets);
        }
        out.push_back({rank, tag(link), std::as_bytes(outgoing_words_->first(at).last(m.words))});
    }
    if (at > 0) session_.wait(label, *outgoing_words_);
    incoming_words_.resize(words_in);
    std::span<std::uint32_t> unused = incoming_words_;
    for (const auto& [key, m] : incoming_) {
        in.push_back({key.first, tag(key.second), std::as_writable_bytes(unused.first(m.words))});
        unused = unused.subspan(m.words);
    }
}

void LinkExchange::write_incoming() {
    std::span<const std::uint32_t> unwritten = incoming_words_;
    for (const auto& [key, m] : incoming_)
        for (const auto& [sender, packets] : m.boxes) {
            session_.write(class_.label + " incoming", inboxes_, unwritten.first(box_words(packets)),
                           inbox_at(key.second, distribution_.inbox_from(sender, key.second)));
            unwritten = unwritten.subspan(box_words(packets));
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
            std::vector<std::uint32_t> words(std::size_t{packets - first} * class_.packet_words);
            session_.read("record", outboxes_, words, outbox_at(link, slot) + box_words(first));
            for (std::size_t i = 0; i < words.size(); i += class_.packet_words)
                visit(node, record_at<raya_head>(words, i));
        }
    }
}

void LinkExchange::visit_state(RenderState& state, const NodeStatus& status) {
    state.vector(messages_);
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

}  // namespace raya
