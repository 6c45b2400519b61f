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
#include "host/verify/verify.hpp"

namespace raya {
namespace {

using Words = std::vector<std::uint32_t>;

// Returns `count` distinct words, so that a word at a wrong place is detected. Read as fp32 numbers, they are normal.
Words distinct_words(std::size_t count, std::uint32_t first = 0) {
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

// Compares `expected` with `got`. Returns nullopt if they are equal, else a failure with the first difference. `unit`:
// name of a group of `words_per_unit` words, such as "PE".
std::optional<Verdict> difference(const Words& expected, const Words& got, const std::string& transfer,
                                  std::size_t words_per_unit, const char* unit) {
    const auto differ = std::mismatch(expected.begin(), expected.end(), got.begin());
    if (differ.first == expected.end()) return {};
    const auto first_wrong = static_cast<std::size_t>(differ.first - expected.begin());
    return failed(transfer + ": words at wrong places",
                  {.where = fmt::format("{}, {} {}, word {}", transfer, unit, first_wrong / words_per_unit,
                                        first_wrong % words_per_unit),
                   .expected = fmt::format("0x{:08x}", expected[first_wrong]),
                   .got = fmt::format("0x{:08x}", got[first_wrong])});
}

// Packets for check_links(). Every `stride`-th outbox has 1 to kCapacity packets, the others none. Each word of a
// packet contains the number of its outbox and its position in the outbox.
struct LinkTraffic {
    LinkTraffic(const raya_torus& torus, std::uint32_t stride, std::size_t words)
        : status(raya_nodes(torus)), outboxes(words), inboxes(words), expected_inboxes(words) {
        const std::uint32_t nodes = raya_nodes(torus);
        expected_sent.resize(std::size_t{nodes} * RAYA_LINKS);
        for (std::uint32_t link = 0; link < RAYA_LINKS; ++link)
            for (std::uint32_t node = 0; node < nodes && torus.sides[link / 2] > 1; ++node)
                fill(link, node, nodes, stride);
        for (std::size_t at = 0; at < words; ++at)
            inboxes[at] = at % kMailboxWords ? kPoison : 0;  // 0 packets, even if LinkExchange::clear() is wrong
    }

    static constexpr std::uint32_t kCapacity = 5, kPacketWords = RAYA_PACKET_WORDS,
                                   kMailboxWords = (1 + kCapacity) * kPacketWords;
    NodeStatus status;
    Words outboxes, inboxes, expected_inboxes, expected_sent;
    std::uint32_t packets_sent = 0;

  private:
    void fill(std::uint32_t link, std::uint32_t node, std::uint32_t nodes, std::uint32_t stride) {
        const std::uint32_t outbox = link * nodes + node, packets = outbox % stride ? 0 : 1 + outbox % kCapacity;
        status.words[std::size_t{node} * RAYA_STATUS_WORDS + RAYA_STATUS_OUTBOX + link] = packets;
        const std::size_t at = std::size_t{outbox} * kMailboxWords;
        outboxes[at] = expected_inboxes[at] = packets;
        expected_sent[outbox] = packets > 0;
        for (std::uint32_t w = 0; w < packets * kPacketWords; ++w)
            outboxes[at + kPacketWords + w] = expected_inboxes[at + kPacketWords + w] = outbox << 12 | (w + 1);
        packets_sent += packets;
    }
};

std::vector<std::string> copy_remedies() {
    return {"a newer driver: copies between buffers on the device are wrong, or do not run in order",
            "another OpenCL implementation for this device (raya devices)"};
}

}  // namespace

Verdict check_bus(Session& session) {
    Communication counted;
    Bus bus(session, counted, Distribution(1));
    const Words words = distinct_words(100'003);
    auto received = session.buffer<std::uint32_t>("broadcast words", words.size());
    session.fill("broadcast words", received, kPoison);
    bus.broadcast(received, words);
    Words got(words.size());
    session.read("read back", received, got);
    if (auto verdict = difference(words, got, "broadcast", words.size(), "broadcast")) return *verdict;
    auto blocks = session.buffer<float>("pixel blocks", words.size());
    session.write("blocks", blocks, as_floats(words));
    std::vector<float> gathered(words.size());
    bus.gather(blocks, gathered, words.size());
    if (auto verdict = difference(words, as_words(gathered), "gather", words.size(), "gather")) return *verdict;
    return passed(fmt::format("{} words in each direction", words.size()));
}

// Layout of the PEs' memory, [PE][kRows][pitch]. A PE's block consists of `words` words of each row, from word `offset`
// of the row on.
constexpr std::size_t kRows = 3;
struct SourceLayout {
    std::size_t pes, words, pitch, offset;

    // PE i receives the block of PE (i + distance) mod P. Returns the index in the memory of the word that becomes word
    // w of the received blocks, [PE][kRows][words].
    std::size_t source_index(std::size_t w, std::size_t distance) const {
        const std::size_t pe = w / words / kRows, row = w / words % kRows;
        return ((pe + distance) % pes * kRows + row) * pitch + offset + w % words;
    }
    std::size_t size() const { return pes * kRows * pitch; }
};

// Each round transfers new words, so that the check detects words of an earlier round.
Verdict check_transfers(Session& session, std::size_t pes, std::size_t words) {
    Communication counted;
    Bus bus(session, counted, Distribution(static_cast<std::uint32_t>(pes)));
    const SourceLayout layout{pes, words, words + 3, 2};
    auto memory = session.buffer<float>("memory words", layout.size()),
         blocks = session.buffer<float>("blocks", pes * kRows * words);
    for (std::uint32_t round = 0; round < 6; ++round) {
        const bool to_all = round == 5;  // every PE broadcasts; the expected words are those of distance 0
        const std::size_t distance = to_all ? 0 : 1 + round * (pes - 1) / 5;
        const Words memory_words = distinct_words(layout.size(), round * static_cast<std::uint32_t>(layout.size()));
        session.write("memory words", memory, as_floats(memory_words));
        for (std::size_t pe = 0; pe < pes; ++pe) {
            const PeWords from{(pe + distance) % pes, layout.pitch, layout.offset, kRows}, to{pe, words, 0, kRows};
            to_all ? bus.broadcast_from(memory, from, blocks, to, words) : bus.send(memory, from, blocks, to, words);
        }
        Words expected(blocks.size());
        for (std::size_t w = 0; w < expected.size(); ++w) expected[w] = memory_words[layout.source_index(w, distance)];
        std::vector<float> got(expected.size());
        session.read("blocks", blocks, got);
        const std::string transfer = to_all ? "broadcast" : fmt::format("distance {}", distance);
        if (auto verdict = difference(expected, as_words(got), transfer, kRows * words, "PE")) return *verdict;
    }
    return passed(fmt::format("{} transfers and {} broadcasts of {} words", counted.transfers, counted.pe_broadcasts,
                              kRows * words));
}

// After a rotation PE i has the block of PE (i + distance) mod P. Each rotation transfers new words. If all rotations
// transferred the same words, two PEs would have the same blocks after every second rotation, and a rotation that does
// nothing could pass.
Verdict check_rotations(Session& session, std::size_t pes, std::size_t words) {
    Communication counted;
    Ring ring(session, counted, Distribution(static_cast<std::uint32_t>(pes)), kRows, words);
    const SourceLayout layout{pes, words, words + 3, 2};
    auto memory = session.buffer<float>("memory words", layout.size());
    for (std::uint32_t i = 0; i < 12; ++i) {
        const Words memory_words = distinct_words(layout.size(), i * static_cast<std::uint32_t>(layout.size()));
        session.write("memory words", memory, as_floats(memory_words));
        ring.load(memory, layout.pitch, layout.offset);
        const RingDirection direction = i % 4 == 3 ? RingDirection::kUp : RingDirection::kDown;
        const std::size_t distance = direction == RingDirection::kDown ? 1 : pes - 1;
        ring.rotate(direction);
        Words expected(pes * kRows * words);
        for (std::size_t w = 0; w < expected.size(); ++w) expected[w] = memory_words[layout.source_index(w, distance)];
        std::vector<float> got(expected.size());
        session.read("ring blocks", ring.blocks(), got);
        const std::string transfer = fmt::format("rotation {} of {} PEs", i + 1, pes);
        if (auto verdict = difference(expected, as_words(got), transfer, kRows * words, "PE")) return *verdict;
    }
    return passed(fmt::format("12 rotations of {} blocks of {} words", pes, kRows * words));
}

Verdict check_links(Session& session, const raya_torus& torus, std::uint32_t stride, Kernels& kernels) {
    constexpr std::uint32_t kPacketWords = LinkTraffic::kPacketWords, kMailboxWords = LinkTraffic::kMailboxWords;
    const std::uint32_t nodes = raya_nodes(torus);
    const NodeDistribution distribution(torus);
    auto status_buffer = session.buffer<std::uint32_t>("status", std::size_t{nodes} * RAYA_STATUS_WORDS);
    LinkExchange links(session, distribution, LinkTraffic::kCapacity,
                       {"verify", kPacketWords, RAYA_STATUS_OUTBOX, RAYA_STATUS_INBOX}, kernels.get<ExchangeKernel>(),
                       kernels.options().group_size, status_buffer);
    links.clear();
    LinkTraffic traffic(torus, stride, links.outboxes().size());
    session.write("inboxes", links.inboxes(), traffic.inboxes);
    session.write("outboxes", links.outboxes(), traffic.outboxes);
    session.write("status", status_buffer, traffic.status.words);
    std::vector<std::uint64_t> words(std::size_t{nodes} * RAYA_LINKS);
    links.exchange(traffic.status, words);
    Words inboxes(traffic.inboxes.size()), sent(links.sent_flags().size()), &expected = traffic.expected_inboxes;
    session.read("inboxes", links.inboxes(), inboxes);
    session.read("sent flags", links.sent_flags(), sent);
    // Words of a mailbox that belong to no packet are undefined, except word 0, the number of packets.
    for (std::size_t at = 0; at < inboxes.size(); at += kMailboxWords)
        for (std::size_t w = 1; w < kMailboxWords; ++w)
            if (w < kPacketWords || w >= (1 + expected[at]) * kPacketWords) inboxes[at + w] = expected[at + w] = 0;
    const std::string transfer =
        fmt::format("exchange on {}", sides_text({torus.sides[0], torus.sides[1], torus.sides[2]}));
    if (auto verdict = difference(expected, inboxes, transfer, kMailboxWords, "inbox")) return *verdict;
    if (auto verdict = difference(traffic.expected_sent, sent, transfer + ", flags of sent mailboxes", nodes, "link"))
        return *verdict;
    return passed(fmt::format("{} packets over {} links", traffic.packets_sent, RAYA_LINKS * nodes));
}

Verdict check_copies(Session& session, const std::vector<BlockCopy>& copies) {
    const Words source = distinct_words(kCopiedWords);
    std::size_t copied = 0;
    for (const BlockCopy& copy : copies) {
        auto source_buffer = session.buffer<std::uint32_t>("from", kCopiedWords);
        auto destination = session.buffer<std::uint32_t>("to", kCopiedWords);
        session.write("from", source_buffer, source);
        session.fill("to", destination, kPoison);
        session.copy_blocks("blocks", source_buffer, copy.from, destination, copy.to, copy.block_words, copy.blocks);
        Words expected(kCopiedWords, kPoison), got(kCopiedWords);
        const auto index = [&](const Session::Blocks& layout, std::size_t block, std::size_t w) {
            return layout.first + block * layout.pitch + layout.offset + w;
        };
        for (std::size_t block = 0; block < copy.blocks; ++block)
            for (std::size_t w = 0; w < copy.block_words; ++w, ++copied)
                expected[index(copy.to, block, w)] = source[index(copy.from, block, w)];
        session.read("to", destination, got);
        const std::string transfer = fmt::format("{} blocks of {} words", copy.blocks, copy.block_words);
        if (auto verdict = difference(expected, got, transfer, kCopiedWords, "buffer")) return *verdict;
    }
    return passed(fmt::format("{} words in {} layouts", copied, copies.size()));
}

std::vector<std::string> integer_remedies() {
    return {
        "the compiler makes errors with integers or barriers, not with fp32: look for an option of the driver that\n"
        "disables its optimiser, and report the error to its vendor",
        "a newer driver, or another OpenCL implementation for this device (raya devices)"};
}

void verify_transfers(Verification& v) {
    const auto check = [&](const std::string& name, const std::function<Verdict(Session&)>& body) {
        v.check("machine", name, [&](Session& session) { return with_remedies(body(session), "", copy_remedies()); });
    };
    const std::vector<BlockCopy> copies = {{{3, 17, 0}, {0, 5, 2}, 5, 40},
                                           {{0, 8, 1}, {4, 31, 0}, 8, 33},
                                           {{2, 9, 5}, {1, 7, 3}, 4, 300},
                                           {{0, 64, 0}, {0, 64, 64}, 64, 63}};
    check("copies of blocks", [&](Session& s) { return check_copies(s, copies); });
    check("bus: broadcast and gather", [](Session& s) { return check_bus(s); });
    check("bus: transfers between 31 PEs", [](Session& s) { return check_transfers(s, 31, 100); });
    using Sizes = std::pair<std::size_t, std::size_t>;
    for (const auto& [pes, words] : {Sizes{2, 1}, {7, 100}, {256, 768}})
        check(fmt::format("ring: rotations of {} PEs", pes),
              [p = pes, w = words](Session& s) { return check_rotations(s, p, w); });
    for (const Links links : {Links::kTorus3d, Links::kTorus2d})
        for (const std::uint32_t stride : {1u, 50u}) {
            const std::string name =
                fmt::format("{}: exchange of {}", links_name(links), stride == 1 ? "all mailboxes" : "few mailboxes");
            const raya_torus torus = make_torus({3, 2, 4}, links);
            v.check("machine", name, [&](Session& s) {
                // A mailbox takes 4 to 12 units of 8 words. So some of the 8 work-items copy two units, some one unit,
                // and some none.
                Kernels kernels(s, {.group_size = std::min(8u, max_group_size_of(v.device()))}, v.sources());
                return with_remedies(check_links(s, torus, stride, kernels), "", integer_remedies());
            });
        }
}

}  // namespace raya
