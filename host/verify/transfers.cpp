#include "host/verify/transfers.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <bit>
#include <numeric>
#include <optional>

#include "host/ring/bus_and_ring.hpp"
#include "host/torus/link_exchange.hpp"
#include "host/torus/topology.hpp"
#include "host/verify/verdict.hpp"

namespace raya {
namespace {

using Words = std::vector<std::uint32_t>;

// Distinct words, so that no word can be mistaken for another; as fp32 numbers they are normal.
Words numbered(std::size_t count, std::uint32_t first = 0) {
    Words words(count);
    std::iota(words.begin(), words.end(), 0x3f000000u + first);
    return words;
}
std::vector<float> as_floats(const Words& words) {
    std::vector<float> floats;
    for (const std::uint32_t word : words) floats.push_back(std::bit_cast<float>(word));
    return floats;
}
Words as_words(const std::vector<float>& floats) {
    Words words;
    for (const float number : floats) words.push_back(std::bit_cast<std::uint32_t>(number));
    return words;
}

// Compares words. Returns nullopt if they are equal, else a failure with the first difference. `unit`: name of a group
// of `words_per_unit` words, such as "PE".
std::optional<Verdict> difference(const Words& expected, const Words& got, const std::string& what,
                                  std::size_t words_per_unit, const char* unit) {
    const auto differ = std::mismatch(expected.begin(), expected.end(), got.begin());
    if (differ.first == expected.end()) return {};
    const auto at = static_cast<std::size_t>(differ.first - expected.begin());
    return failed(what + ": words at wrong places",
                  {.where = fmt::format("{}, {} {}, word {}", what, unit, at / words_per_unit, at % words_per_unit),
                   .expected = fmt::format("0x{:08x}", expected[at]),
                   .got = fmt::format("0x{:08x}", got[at])});
}

// Packets for check_links(). Each outbox has a different number of packets; each word contains its outbox and position.
struct LinkTraffic {
    LinkTraffic(const raya_torus& torus, std::uint32_t every, std::size_t words)
        : status(raya_nodes(torus)), out(words), in(words), expected(words) {
        const std::uint32_t nodes = raya_nodes(torus);
        expected_sent.resize(std::size_t{nodes} * RAYA_LINKS);
        for (std::uint32_t link = 0; link < RAYA_LINKS; ++link)
            for (std::uint32_t node = 0; node < nodes && torus.sides[link / 2] > 1; ++node)
                fill(link, node, nodes, every);
        for (std::size_t at = 0; at < words; ++at)
            in[at] = at % kMailboxWords ? kPoison : 0;  // empty, independent of clear()
    }

    static constexpr std::uint32_t kCapacity = 5, kWords = RAYA_PACKET_WORDS, kMailboxWords = (1 + kCapacity) * kWords;
    NodeStatus status;
    Words out, in, expected, expected_sent;
    std::uint32_t packets_sent = 0;

  private:
    void fill(std::uint32_t link, std::uint32_t node, std::uint32_t nodes, std::uint32_t every) {
        const std::uint32_t number = link * nodes + node, packets = number % every ? 0 : 1 + number % kCapacity;
        status.words[std::size_t{node} * RAYA_STATUS_WORDS + RAYA_STATUS_OUTBOX + link] = packets;
        const std::size_t at = std::size_t{number} * kMailboxWords;
        out[at] = expected[at] = packets;
        expected_sent[number] = packets > 0;
        for (std::uint32_t w = 0; w < packets * kWords; ++w)
            out[at + kWords + w] = expected[at + kWords + w] = number << 12 | (w + 1);
        packets_sent += packets;
    }
};

}  // namespace

Verdict check_bus(Session& session) {
    Communication counted;
    Bus bus(session, counted, 1);
    const Words words = numbered(100'003);
    auto everywhere = session.buffer<std::uint32_t>("broadcast words", words.size());
    session.fill("broadcast words", everywhere, kPoison);
    bus.broadcast(everywhere, words);
    Words got(words.size());
    session.read("read back", everywhere, got);
    if (auto verdict = difference(words, got, "broadcast", words.size(), "broadcast")) return *verdict;
    auto blocks = session.buffer<float>("pixel blocks", words.size());
    session.write("blocks", blocks, as_floats(words));
    std::vector<float> gathered(words.size());
    bus.gather(blocks, gathered, words.size());
    if (auto verdict = difference(words, as_words(gathered), "gather", words.size(), "gather")) return *verdict;
    return passed(fmt::format("{} words in each direction", words.size()));
}

// Layout of the blocks in the memory of the PEs, [PE][kRows][pitch]: a block starts at word `offset` of each row. at(w,
// d) returns the index of word `w` of the blocks [PE][kRows][words], in the memory of the PE `d` higher.
constexpr std::size_t kRows = 3;
struct SourceLayout {
    std::size_t pes, words, pitch, offset;

    std::size_t at(std::size_t w, std::size_t distance) const {
        const std::size_t pe = w / words / kRows, row = w / words % kRows;
        return ((pe + distance) % pes * kRows + row) * pitch + offset + w % words;
    }
    std::size_t size() const { return pes * kRows * pitch; }
};

// In each round every PE's block has distinct words from the middle of its rows.
Verdict check_transfers(Session& session, std::size_t pes, std::size_t words) {
    Communication counted;
    Bus bus(session, counted, static_cast<std::uint32_t>(pes));
    const SourceLayout layout{pes, words, words + 3, 2};
    auto memory = session.buffer<float>("own words", layout.size()),
         blocks = session.buffer<float>("blocks", pes * kRows * words);
    for (std::uint32_t round = 0; round < 6; ++round) {
        const bool to_all = round == 5;  // broadcasts; the model is distance 0
        const std::size_t distance = to_all ? 0 : 1 + round * (pes - 1) / 5;
        const Words own = numbered(layout.size(), round * static_cast<std::uint32_t>(layout.size()));
        session.write("own words", memory, as_floats(own));
        for (std::size_t pe = 0; pe < pes; ++pe) {
            const PeWords from{(pe + distance) % pes, layout.pitch, layout.offset, kRows}, to{pe, words, 0, kRows};
            to_all ? bus.broadcast_from(memory, from, blocks, to, words) : bus.send(memory, from, blocks, to, words);
        }
        Words expected(blocks.size());
        for (std::size_t w = 0; w < expected.size(); ++w) expected[w] = own[layout.at(w, distance)];
        std::vector<float> got(expected.size());
        session.read("blocks", blocks, got);
        const std::string what = to_all ? "broadcast" : fmt::format("distance {}", distance);
        if (auto verdict = difference(expected, as_words(got), what, kRows * words, "PE")) return *verdict;
    }
    return passed(fmt::format("{} transfers and {} broadcasts of {} words", counted.transfers, counted.pe_broadcasts,
                              kRows * words));
}

// After a rotation PE i has the block of PE (i + turned) mod P. Every rotation has distinct words: with two PEs, stale
// words of the rotation before the last would be in the right places.
Verdict check_rotations(Session& session, std::size_t pes, std::size_t words) {
    Communication counted;
    Ring ring(session, counted, static_cast<std::uint32_t>(pes), kRows, words);
    const SourceLayout layout{pes, words, words + 3, 2};
    auto memory = session.buffer<float>("own words", layout.size());
    for (std::uint32_t i = 0; i < 12; ++i) {
        const Words own = numbered(layout.size(), i * static_cast<std::uint32_t>(layout.size()));
        session.write("own words", memory, as_floats(own));
        ring.load(memory, layout.pitch, layout.offset);
        const RingDirection direction = i % 4 == 3 ? RingDirection::kUp : RingDirection::kDown;
        const std::size_t turned = direction == RingDirection::kDown ? 1 : pes - 1;
        ring.rotate(direction);
        Words expected(pes * kRows * words);
        for (std::size_t w = 0; w < expected.size(); ++w) expected[w] = own[layout.at(w, turned)];
        std::vector<float> got(expected.size());
        session.read("ring blocks", ring.blocks(), got);
        const std::string what = fmt::format("rotation {} of {} PEs", i + 1, pes);
        if (auto verdict = difference(expected, as_words(got), what, kRows * words, "PE")) return *verdict;
    }
    return passed(fmt::format("12 rotations of {} blocks of {} words", pes, kRows * words));
}

Verdict check_links(Session& session, const raya_torus& torus, std::uint32_t every, Kernels* kernels) {
    constexpr std::uint32_t kWords = LinkTraffic::kWords, kMailboxWords = LinkTraffic::kMailboxWords;
    const std::uint32_t nodes = raya_nodes(torus);
    const NodeShare share(torus);
    LinkExchange links(session, share, LinkTraffic::kCapacity,
                       {"verify", kWords, RAYA_STATUS_OUTBOX, RAYA_STATUS_INBOX});
    links.clear();
    LinkTraffic traffic(torus, every, links.outboxes().size());
    session.write("inboxes", links.inboxes(), traffic.in);
    session.write("outboxes", links.outboxes(), traffic.out);
    auto status_buffer = session.buffer<std::uint32_t>("status", traffic.status.words.size());
    session.write("status", status_buffer, traffic.status.words);
    if (kernels) links.use_kernel(kernels->get<ExchangeKernel>(), kernels->options().group_size, status_buffer);
    std::vector<std::uint64_t> words(std::size_t{nodes} * RAYA_LINKS);
    links.exchange(traffic.status, words);
    Words in(traffic.in.size()), sent(links.sent_flags().size()), &expected = traffic.expected;
    session.read("inboxes", links.inboxes(), in);
    session.read("sent flags", links.sent_flags(), sent);
    // Words after the packets of a mailbox are undefined.
    for (std::size_t at = 0; at < in.size(); at += kMailboxWords)
        for (std::size_t w = 1; w < kMailboxWords; ++w)
            if (w < kWords || w >= (1 + expected[at]) * kWords) in[at + w] = expected[at + w] = 0;
    const std::string what =
        fmt::format("exchange on {}", sides_text({torus.sides[0], torus.sides[1], torus.sides[2]}));
    if (auto verdict = difference(expected, in, what, kMailboxWords, "inbox")) return *verdict;
    if (auto verdict = difference(traffic.expected_sent, sent, what + ", flags of sent mailboxes", nodes, "link"))
        return *verdict;
    return passed(fmt::format("{} packets over {} links", traffic.packets_sent, RAYA_LINKS * nodes));
}

Verdict check_copies(Session& session, const std::vector<BlockCopy>& copies) {
    const Words source = numbered(kCopiedWords);
    std::size_t copied = 0;
    for (const BlockCopy& copy : copies) {
        auto from = session.buffer<std::uint32_t>("from", kCopiedWords);
        auto to = session.buffer<std::uint32_t>("to", kCopiedWords);
        session.write("from", from, source);
        session.fill("to", to, kPoison);
        session.copy_blocks("blocks", from, copy.from, to, copy.to, copy.count, copy.blocks);
        Words expected(kCopiedWords, kPoison), got(kCopiedWords);
        const auto at = [&](const Session::Blocks& b, std::size_t block, std::size_t w) {
            return b.first + block * b.pitch + b.offset + w;
        };
        for (std::size_t block = 0; block < copy.blocks; ++block)
            for (std::size_t w = 0; w < copy.count; ++w, ++copied)
                expected[at(copy.to, block, w)] = source[at(copy.from, block, w)];
        session.read("to", to, got);
        const std::string what = fmt::format("{} blocks of {} words", copy.blocks, copy.count);
        if (auto verdict = difference(expected, got, what, kCopiedWords, "buffer")) return *verdict;
    }
    return passed(fmt::format("{} words in {} shapes", copied, copies.size()));
}

}  // namespace raya
