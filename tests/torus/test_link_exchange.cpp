// Links transfer each packet exactly once, from a node's outbox to an inbox of the node at the end of the link.
#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <map>
#include <vector>

#include "host/torus/link_exchange.hpp"
#include "tests/torus/random_torus.hpp"

namespace raya {
namespace {

constexpr std::uint32_t kUnsent = 0xdead0000;  // value of the words in outboxes that belong to no packet

// Fills and empties the mailboxes of all nodes, as the nodes' kernels would between two exchanges.
class Mailboxes {
  public:
    Mailboxes(Kernels& kernels, const raya_torus& torus, std::uint32_t capacity, std::uint32_t words)
        : session_(kernels.session()),
          torus_(torus),
          nodes_(raya_nodes(torus)),
          capacity_(capacity),
          words_(words),
          distribution_(torus),
          status_(nodes_),
          device_status_(session_.buffer<std::uint32_t>("status", status_.words.size())),
          links_(session_, distribution_, capacity, {"test", words, RAYA_STATUS_OUTBOX, RAYA_STATUS_INBOX},
                 kernels.get<ExchangeKernel>(), kernels.options().group_size, device_status_),
          out_(links_.outboxes().size(), kUnsent),
          in_(out_.size()) {
        links_.clear();
        for (std::uint32_t box = 0; box < RAYA_LINKS * nodes_; ++box) out_[at(box)] = 0;
    }

    /// For each outbox, with probability 1 / `rareness`: adds a random number of packets, at most `max_packets` and at
    /// most as many as fit.
    void add_packets(SplitMix& random, std::uint32_t rareness, std::uint32_t max_packets) {
        for (std::uint32_t link = 0; link < RAYA_LINKS; ++link)
            for (std::uint32_t node = 0; node < nodes_ && torus_.sides[link / 2] > 1; ++node) {
                std::uint32_t& packets = outbox(link, node);
                if (random_below(random, rareness) > 0) continue;
                const std::uint32_t new_packets = std::min(capacity_ - packets, random_below(random, max_packets + 1));
                for (std::uint32_t i = 0; i < new_packets; ++i) put_packet(link, node, packets++);
                out_[at(link * nodes_ + node)] = packets;
            }
    }

    /// Exchanges once, and checks the sent flags, the words per link, the inboxes and the counters. If `record`, also
    /// visits the new packets before the exchange.
    void exchange(bool record) {
        session_.write("test", links_.outboxes(), out_);
        if (record)
            links_.visit_new_packets(status_, [&](std::uint32_t node, const raya_head& packet) {
                ++visits_[packet.pixel];
                CHECK(sources_[packet.pixel] == node);
            });
        const std::vector<std::uint32_t> inboxes_before = in_;
        std::vector<std::uint64_t> words(std::size_t{nodes_} * RAYA_LINKS, 5), expected = words;
        session_.write("test", device_status_, status_.words);
        links_.exchange(status_, words);
        session_.read("test", links_.inboxes(), in_);
        std::vector<std::uint32_t> sent(links_.sent_flags().size());
        session_.read("test", links_.sent_flags(), sent);
        std::size_t wrong_flags = 0, changed_inboxes = 0;
        for (std::uint32_t link = 0; link < RAYA_LINKS; ++link)
            for (std::uint32_t node = 0; node < nodes_; ++node) {
                const std::uint32_t end = raya_link_end(torus_, node, link), packets = outbox(link, node);
                const bool occupied = inbox(link, end) > 0, sends = packets > 0 && !occupied;
                wrong_flags += sent[link * nodes_ + node] != sends;
                const std::size_t box = at(link * nodes_ + node);
                if (occupied)
                    changed_inboxes +=
                        !std::equal(&in_[box], &in_[box] + (1 + capacity_) * words_, &inboxes_before[box]);
                if (!occupied && !sends)
                    changed_inboxes += in_[box] != 0;  // an empty inbox stays empty; only its header counts
                if (!sends) continue;
                expected[node * RAYA_LINKS + link] += std::uint64_t{packets} * words_;
                check_arrival(link, node, end);
            }
        CHECK(wrong_flags == 0);
        CHECK(changed_inboxes == 0);
        CHECK(words == expected);
    }

    /// Removes packets from the inboxes, as the nodes would: all packets of about half of the inboxes, and some packets
    /// of the other inboxes with probability 1 / `rareness`.
    void remove_packets(SplitMix& random, std::uint32_t rareness) {
        for (std::uint32_t box = 0; box < RAYA_LINKS * nodes_; ++box) {
            std::uint32_t& packets = inbox(box / nodes_, raya_link_end(torus_, box % nodes_, box / nodes_));
            packets = random_below(random, rareness) == 0 ? random_below(random, packets + 1) : packets;
            if (random_below(random, 2)) packets = 0;
            in_[at(box)] = packets;
        }
        session_.write("test", links_.inboxes(), in_);
    }

    /// Checks that every packet has arrived once, except packets that wait in outboxes. If `record`, also checks that
    /// every packet has been visited once.
    void check_totals(bool record) const {
        std::uint64_t waiting = 0, counted = 0;
        for (std::uint32_t box = 0; box < RAYA_LINKS * nodes_; ++box)
            waiting += status_.at(box % nodes_, RAYA_STATUS_OUTBOX + box / nodes_);
        for (const std::uint64_t packets : links_.counts().messages) counted += packets;
        CHECK(arrivals_.size() + waiting == sources_.size());
        CHECK(counted == arrivals_.size());
        CHECK(std::all_of(arrivals_.begin(), arrivals_.end(), [](const auto& a) { return a.second == 1; }));
        if (!record) return;
        CHECK(visits_.size() == sources_.size());
        CHECK(std::all_of(visits_.begin(), visits_.end(), [](const auto& a) { return a.second == 1; }));
    }

    /// Returns the number of packets that have arrived.
    std::uint64_t arrived_packets() const { return arrivals_.size(); }

  private:
    std::uint32_t& outbox(std::uint32_t link, std::uint32_t node) {
        return status_.words[std::size_t{node} * RAYA_STATUS_WORDS + RAYA_STATUS_OUTBOX + link];
    }
    std::uint32_t& inbox(std::uint32_t link, std::uint32_t node) {
        return status_.words[std::size_t{node} * RAYA_STATUS_WORDS + RAYA_STATUS_INBOX + link];
    }
    std::size_t at(std::uint32_t box) const { return std::size_t{box} * (1 + capacity_) * words_; }

    // Writes a packet. Its first word is its number; the remaining words are computed from the number.
    void put_packet(std::uint32_t link, std::uint32_t node, std::uint32_t slot) {
        const auto number = static_cast<std::uint32_t>(sources_.size());
        sources_.push_back(node);
        for (std::uint32_t w = 0; w < words_; ++w)
            out_[at(link * nodes_ + node) + (1 + slot) * words_ + w] = number + (w << 24);
    }

    void check_arrival(std::uint32_t link, std::uint32_t node, std::uint32_t end) {
        const std::uint32_t packets = outbox(link, node);
        const std::size_t box = at(link * nodes_ + node);
        CHECK(in_[box] == packets);
        CHECK(std::equal(&in_[box] + words_, &in_[box] + (1 + packets) * words_, &out_[box] + words_));
        for (std::uint32_t i = 1; i <= packets; ++i) ++arrivals_[in_[box + i * words_]];
        inbox(link, end) = packets;
        outbox(link, node) = 0;
        out_[box] = 0;
        std::fill_n(&out_[box] + words_, capacity_ * words_, kUnsent);
    }

    Session& session_;
    raya_torus torus_;
    std::uint32_t nodes_, capacity_, words_;
    NodeDistribution distribution_;
    NodeStatus status_;
    Buffer<std::uint32_t> device_status_;
    LinkExchange links_;
    std::vector<std::uint32_t> out_, in_;
    std::vector<std::uint32_t> sources_;              // by packet number: its source node
    std::map<std::uint32_t, int> arrivals_, visits_;  // by packet number: number of arrivals, of visits
};

}  // namespace

TEST_CASE("random toruses: links carry every packet to the neighbour once", "[torus]") {
    const std::uint64_t seed = 8472;
    SplitMix random(seed);
    Session session(choose_device(""));
    Kernels one_item_kernels(session, {}), group_kernels(session, {.group_size = 4});
    std::uint64_t arrived_packets = 0;
    for (int i = 0; i < 150; ++i) {
        const raya_torus torus = random_torus(random, 5);
        const std::uint32_t capacity = 1 + random_below(random, 12);
        const bool record = i % 2;
        CAPTURE(seed, i, torus_text(torus), capacity, record);
        Mailboxes boxes(i % 4 >= 2 ? one_item_kernels : group_kernels, torus, capacity,
                        i % 3 ? RAYA_PACKET_WORDS : RAYA_RETURN_WORDS);
        const std::uint32_t rareness = i % 5 == 0 ? 20 : 1 + random_below(random, 3);
        for (int round = 0; round < 6; ++round) {
            CAPTURE(round);
            boxes.add_packets(random, rareness, capacity);
            boxes.exchange(record);
            boxes.remove_packets(random, 1 + random_below(random, 3));
        }
        boxes.check_totals(record);
        arrived_packets += boxes.arrived_packets();
    }
    CHECK(arrived_packets > 10'000);
}

TEST_CASE("the words of a link include only the returns that the model charges as messages", "[torus]") {
    Session session(choose_device(""));
    const raya_torus torus = make_torus({2, 1, 1}, Links::kTorus3d);
    const NodeDistribution distribution(torus);
    Kernels kernels(session, {});
    auto device_status = session.buffer<std::uint32_t>("status", std::size_t{2} * RAYA_STATUS_WORDS);
    session.fill("test", device_status, 0);
    LinkExchange links(
        session, distribution, 8,
        {"test", RAYA_RETURN_WORDS, RAYA_STATUS_RETURN_OUTBOX, RAYA_STATUS_RETURN_INBOX, 6, RAYA_STATUS_RETURN_CHARGED},
        kernels.get<ExchangeKernel>(), 1, device_status);
    links.clear();
    NodeStatus status(2);
    status.words[RAYA_STATUS_WORDS + RAYA_STATUS_RETURN_OUTBOX + 1] = 5;
    status.words[RAYA_STATUS_WORDS + RAYA_STATUS_RETURN_CHARGED] = 3;
    std::vector<std::uint64_t> words(std::size_t{2} * RAYA_LINKS), expected = words;
    expected[RAYA_LINKS + 1] = 3 * 6;
    links.exchange(status, words);
    CHECK(words == expected);
    CHECK(links.counts().messages[RAYA_LINKS + 1] == 3);
    CHECK(links.sent_packets() == 5);
    CHECK(links.received_packets() == 5);
    links.clear();
    CHECK(links.sent_packets() == 0);
}

TEST_CASE("links are named by direction and axis", "[torus]") {
    const char* const names[] = {"+x", "-x", "+y", "-y", "+z", "-z"};
    for (std::uint32_t link = 0; link < RAYA_LINKS; ++link) CHECK(link_name(link) == names[link]);
}

}  // namespace raya
