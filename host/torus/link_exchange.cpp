#include "host/torus/link_exchange.hpp"

#include <algorithm>
#include <cstring>

namespace raya {
namespace {

// What a command costs beside its bytes, in bytes that could be copied in its time: some microseconds of PoCL.
constexpr std::uint64_t kCommandBytes = 100'000;

raya_head head_at(const std::uint32_t* packet) {
    raya_head head;
    std::memcpy(&head, packet, sizeof head);
    return head;
}

}  // namespace

std::string link_name(std::uint32_t link) { return std::string(link % 2 == 0 ? "+" : "-") + "xyz"[link / 2]; }

LinkExchange::LinkExchange(Session& session, const raya_torus& torus, std::uint32_t capacity, const Cargo& cargo)
    : session_(session),
      torus_(torus),
      nodes_(raya_nodes(torus)),
      capacity_(capacity),
      cargo_(cargo),
      outboxes_(session.buffer<std::uint32_t>("outboxes", box_at(RAYA_LINKS, 0))),
      inboxes_(session.buffer<std::uint32_t>("inboxes", outboxes_.size())),
      sent_(session.buffer<std::uint32_t>("sent boxes", std::size_t{RAYA_LINKS} * nodes_)) {}

void LinkExchange::clear() {
    sent_flags_.assign(sent_.size(), 0);
    flags_there_ = sent_flags_;
    session_.fill("clear boxes", sent_, 0);
    // Only the word that says how many packets a box holds: boxes are large, and most of their pages are never touched.
    for (Buffer<std::uint32_t>* boxes : {&inboxes_, &outboxes_})
        session_.copy_blocks("clear boxes", sent_, {.pitch = 1}, *boxes, {.pitch = box_words(capacity_)}, 1,
                             sent_.size());
    visited_.assign(sent_.size(), 0);
    packets_.assign(sent_.size(), 0);
    moved_ = 0;
}

void LinkExchange::exchange(const NodeStatus& status, std::vector<std::uint64_t>& words) {
    std::fill(sent_flags_.begin(), sent_flags_.end(), 0);
    for (std::uint32_t link = 0; link < RAYA_LINKS; ++link) {
        if (torus_.sides[link / 2] == 1) continue;
        for (std::uint32_t node = 0; node < nodes_; ++node) {
            const std::uint32_t packets = status.at(node, cargo_.outbox_status + link);
            if (packets == 0 || waits(status, link, node)) continue;
            sent_flags_[std::size_t{link} * nodes_ + node] = 1;
            const std::uint64_t messages = cargo_.charged_status ? status.at(node, *cargo_.charged_status) : packets;
            packets_[std::size_t{node} * RAYA_LINKS + link] += messages;
            words[std::size_t{node} * RAYA_LINKS + link] += messages * cargo_.charged_words;
            moved_ += packets;
        }
        const Session::Blocks boxes{.pitch = box_words(capacity_)};
        for (const Span& span : spans(status, link)) {
            Session::Blocks at = boxes;
            at.first = box_at(link, span.first);
            session_.copy_blocks(cargo_.label + " " + link_name(link), outboxes_, at, inboxes_, at,
                                 box_words(span.packets), span.end - span.first);
        }
    }
    if (sent_flags_ == flags_there_) return;
    session_.write(cargo_.label, sent_, sent_flags_);
    flags_there_ = sent_flags_;
}

bool LinkExchange::waits(const NodeStatus& status, std::uint32_t link, std::uint32_t node) const {
    return status.at(raya_link_end(torus_, node, link), cargo_.inbox_status + link) > 0;
}

std::uint64_t LinkExchange::cost(const Span& span) const {
    return kCommandBytes + (span.end - span.first) * box_words(span.packets) * sizeof(std::uint32_t);
}

// A span grows as long as that costs less than another command. An empty box on the way is copied onto an empty one.
std::vector<LinkExchange::Span> LinkExchange::spans(const NodeStatus& status, std::uint32_t link) const {
    std::vector<Span> found;
    bool closed = true;
    for (std::uint32_t node = 0; node < nodes_; ++node) {
        if (waits(status, link, node)) {
            closed = true;
            continue;
        }
        const std::uint32_t packets = status.at(node, cargo_.outbox_status + link);
        if (packets == 0) continue;
        const Span alone{node, node + 1, packets};
        if (!closed) {
            const Span longer{found.back().first, node + 1, std::max(found.back().packets, packets)};
            if (cost(longer) <= cost(found.back()) + cost(alone)) {
                found.back() = longer;
                continue;
            }
        }
        found.push_back(alone);
        closed = false;
    }
    return found;
}

void LinkExchange::visit_new(const NodeStatus& status,
                             const std::function<void(std::uint32_t, const raya_head&)>& visit) {
    for (std::uint32_t node = 0; node < nodes_; ++node) {
        for (std::uint32_t link = 0; link < RAYA_LINKS; ++link) {
            const std::uint32_t packets = status.at(node, cargo_.outbox_status + link);
            const std::size_t box = std::size_t{link} * nodes_ + node;
            const std::uint32_t first = sent_flags_[box] ? 0 : visited_[box];
            visited_[box] = packets;
            if (!visit) continue;
            std::vector<std::uint32_t> words(std::size_t{packets - first} * cargo_.packet_words);
            session_.read("record", outboxes_, words, box_at(link, node) + box_words(first));
            for (std::size_t i = 0; i < words.size(); i += cargo_.packet_words) visit(node, head_at(&words[i]));
        }
    }
}

}  // namespace raya
