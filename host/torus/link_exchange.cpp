#include "torus/link_exchange.hpp"

#include <algorithm>

namespace raya {
namespace {

// What a command costs beside its bytes, in bytes that could be copied in its time: some microseconds of PoCL.
constexpr std::uint64_t kCommandBytes = 100'000;

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
}

void LinkExchange::exchange(const NodeStatus& status, std::vector<std::uint64_t>& words) {
    const std::uint64_t packet_bytes = cargo_.packet_words * sizeof(std::uint32_t);
    std::fill(sent_flags_.begin(), sent_flags_.end(), 0);
    for (std::uint32_t link = 0; link < RAYA_LINKS; ++link) {
        if (torus_.sides[link / 2] == 1) continue;
        std::vector<Sender> senders;
        bool waits = false;
        std::uint32_t most = 0;
        std::uint64_t bytes = 0;
        for (std::uint32_t node = 0; node < nodes_; ++node) {
            const std::uint32_t packets = status.at(node, cargo_.outbox_status + link);
            const bool busy = status.at(raya_link_end(torus_, node, link), cargo_.inbox_status + link) > 0;
            waits |= busy;
            if (packets == 0 || busy) continue;
            senders.push_back({node, packets});
            most = std::max(most, packets);
            bytes += packets * packet_bytes + kCommandBytes;
            sent_flags_[std::size_t{link} * nodes_ + node] = 1;
            packets_[std::size_t{node} * RAYA_LINKS + link] += packets;
            words[std::size_t{node} * RAYA_LINKS + link] += std::uint64_t{packets} * cargo_.packet_words;
        }
        const std::uint64_t side_bytes = nodes_ * (most + 1) * packet_bytes + 2 * kCommandBytes;
        const std::string label = cargo_.label + " " + link_name(link);
        if (!waits && side_bytes < bytes)
            copy_side(label, link, most);
        else
            copy_each(label, link, senders);
    }
    if (sent_flags_ == flags_there_) return;
    session_.write(cargo_.label, sent_, sent_flags_);
    flags_there_ = sent_flags_;
}

void LinkExchange::visit_new(const NodeStatus& status,
                             const std::function<void(std::uint32_t, const std::uint32_t*)>& visit) {
    for (std::uint32_t node = 0; node < nodes_; ++node) {
        for (std::uint32_t link = 0; link < RAYA_LINKS; ++link) {
            const std::uint32_t packets = status.at(node, cargo_.outbox_status + link);
            const std::size_t box = std::size_t{link} * nodes_ + node;
            const std::uint32_t first = sent_flags_[box] ? 0 : visited_[box];
            visited_[box] = packets;
            if (!visit) continue;
            std::vector<std::uint32_t> words(std::size_t{packets - first} * cargo_.packet_words);
            session_.read("record", outboxes_, words, box_at(link, node) + box_words(first));
            for (std::size_t i = 0; i < words.size(); i += cargo_.packet_words) visit(node, &words[i]);
        }
    }
}

// All nodes of the torus as blocks: `stride` of them lie between neighbours along the link's side. Those that do not
// wrap round are copied in one command, those that do in another.
void LinkExchange::copy_side(const std::string& label, std::uint32_t link, std::uint32_t packets) {
    const std::size_t d = link / 2, side = torus_.sides[d];
    const std::size_t stride = (d > 0 ? torus_.sides[0] : 1) * (d > 1 ? torus_.sides[1] : 1);
    const std::size_t box = box_words(capacity_), first = box_at(link, 0);
    const std::size_t slabs = nodes_ / (stride * side), slab = stride * side * box;
    const std::size_t low = first, second = first + stride * box, last = first + stride * (side - 1) * box;
    const bool up = link % 2 == 0;
    session_.copy_blocks(label, outboxes_, {0, box, slab, up ? low : second}, inboxes_,
                         {0, box, slab, up ? second : low}, box_words(packets), stride * (side - 1), slabs);
    session_.copy_blocks(label, outboxes_, {0, box, slab, up ? last : low}, inboxes_, {0, box, slab, up ? low : last},
                         box_words(packets), stride, slabs);
}

void LinkExchange::copy_each(const std::string& label, std::uint32_t link, const std::vector<Sender>& senders) {
    for (const Sender& s : senders)
        session_.copy(label, outboxes_, box_at(link, s.node), inboxes_,
                      box_at(link, raya_link_end(torus_, s.node, link)), box_words(s.packets));
}

}  // namespace raya
