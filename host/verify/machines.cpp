// Checks of layer "machine": integer arithmetic, local memory, barriers and atomics with kernels/checks/machine.cl, and
// transfers. All results are exact integers. The host computes the expected results with the headers that the kernels
// use.
#include "host/verify/machines.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <bit>
#include <numeric>
#include <optional>
#include <utility>
#include <vector>

#include "host/cl/kernel_options.hpp"
#include "host/model/mapping_rule.hpp"
#include "host/model/number_format.hpp"
#include "host/ring/bus_and_ring.hpp"
#include "host/ring/mapping.hpp"
#include "host/scene/split_mix.hpp"
#include "host/torus/link_exchange.hpp"
#include "host/torus/topology.hpp"
#include "host/verify/verdict.hpp"
#include "host/verify/verify.hpp"
#include "kernels/shared/neighbours.h"
#include "kernels/shared/node_counts.h"
#include "kernels/shared/share_pixels.h"
#include "kernels/shared/traffic.h"

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

/// Checks one broadcast and one gather over the bus.
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

}  // namespace

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

namespace {

using Words = std::vector<std::uint32_t>;

// Returns a pseudo-random number in 0..end - 1.
std::uint32_t random_below(SplitMix& random, std::uint32_t end) {
    return static_cast<std::uint32_t>(random.next() % end);
}

// Returns a random divisor of `side`.
std::uint32_t random_divisor(SplitMix& random, std::uint32_t side) {
    std::uint32_t divisor = 1 + random_below(random, side);
    while (side % divisor) --divisor;
    return divisor;
}

// Returns a random side of an image in pixels, with equal probability from 1..40, from 1..kMaxSide, or kMaxSide.
std::uint32_t random_side(SplitMix& random) {
    const std::uint32_t sides[] = {1 + random_below(random, 40), 1 + random_below(random, kMaxSide), kMaxSide};
    return sides[random_below(random, 3)];
}

// Returns a random valid mapping of `kind` (RAYA_FOLD_CYCLIC..RAYA_RANDOM).
raya_mapping random_mapping_of_kind(SplitMix& random, std::uint32_t kind) {
    raya_mapping m{random_side(random), random_side(random), 1, 0, kind};
    const std::uint32_t pixels = m.width * m.height;
    const std::uint32_t pes[] = {1 + random_below(random, m.width), 1 + random_below(random, pixels), m.width, pixels};
    m.pes = pes[random_below(random, 4)];
    if (raya_has_slots(m)) m.parameter = random_below(random, m.width);
    if (kind == RAYA_TILES) m.parameter = raya_pair(random_divisor(random, m.width), random_divisor(random, m.height));
    if (kind == RAYA_RANDOM) m.parameter = static_cast<std::uint32_t>(random.next());
    if (kind == RAYA_GRID) {
        const std::uint32_t rows = 1 + random_below(random, m.height), columns = 1 + random_below(random, m.width);
        m.parameter = raya_pair(rows, columns);
        m.pes = rows * columns;
    }
    return m;
}

// Returns `count` random mappings of `kind`, and one pixel of the image of each mapping.
std::pair<std::vector<raya_mapping>, std::vector<raya_pixel>> mapping_cases(std::uint32_t kind, std::size_t count) {
    constexpr std::uint64_t kSeed = 1993;
    SplitMix random(kSeed + kind);
    std::vector<raya_mapping> mappings;
    std::vector<raya_pixel> pixels;
    for (std::size_t i = 0; i < count; ++i) {
        const raya_mapping m = random_mapping_of_kind(random, kind);
        mappings.push_back(m);
        pixels.push_back({i % 8 ? random_below(random, m.height) : m.height - 1,
                          i % 4 ? random_below(random, m.width) : m.width - 1});
    }
    return {mappings, pixels};
}

// Returns `count` random toruses, alternately 3-D and 2-D, and two nodes of each: [torus][2].
std::pair<std::vector<raya_torus>, std::vector<std::uint32_t>> torus_cases(std::size_t count) {
    constexpr std::uint64_t kSeed = 805;
    SplitMix random(kSeed);
    std::vector<raya_torus> toruses;
    std::vector<std::uint32_t> nodes;
    for (std::size_t i = 0; i < count; ++i) {
        const auto side = [&] { return 1 + random_below(random, i % 5 ? 7 : 40); };
        const raya_torus torus = make_torus({side(), side(), side()}, i % 2 ? Links::kTorus2d : Links::kTorus3d);
        toruses.push_back(torus);
        for (int k = 0; k < 2; ++k) nodes.push_back(random_below(random, raya_nodes(torus)));
    }
    return {toruses, nodes};
}

// Compares the buffer `results`, which has several words per case, with `expected`. `names`: names of the words of a
// case. `describe(i)` returns the description of case i.
template <class Describe>
Verdict compare_cases(const Words& expected, CheckRunner& runner, const Buffer<std::uint32_t>& results,
                      const std::vector<std::string>& names, const Describe& describe, const std::string& pass_text) {
    const Words got = runner.read(results);
    const std::size_t stride = names.size();
    const auto differ = std::mismatch(expected.begin(), expected.end(), got.begin());
    if (differ.first == expected.end()) return passed(pass_text);
    report_expected(results.name(), KnownWords(expected));
    const auto first_wrong = static_cast<std::size_t>(differ.first - expected.begin());
    std::size_t wrong_cases = 0;
    for (std::size_t i = 0; i < expected.size(); i += stride)
        wrong_cases += !std::equal(&expected[i], &expected[i] + stride, &got[i]);
    return failed(fmt::format("{} of {} cases wrong", wrong_cases, expected.size() / stride),
                  {.where = fmt::format("{} of {}", names[first_wrong % stride], describe(first_wrong / stride)),
                   .expected = fmt::format("{0} = 0x{0:08x}", expected[first_wrong]),
                   .got = fmt::format("{0} = 0x{0:08x}", got[first_wrong])});
}

// Appends the expected results of kernel find_owners (kernels/checks/machine.cl) for a pixel. `other_pe`: a PE, whose
// share may be empty.
void add_owner(Words& results, const raya_mapping& m, const raya_pixel& pixel, std::uint32_t other_pe) {
    const std::uint32_t owner = raya_owner(m, pixel.row, pixel.column);
    const raya_share share = raya_share_of(m, owner);
    const std::uint32_t number = raya_index_of(m, share, pixel);
    const raya_pixel found_pixel = raya_pixel_of(m, share, number);
    std::uint32_t sides = 0;
    for (std::uint32_t side = 0; side < RAYA_SIDES; ++side)
        sides |= std::uint32_t{raya_has_neighbour(m, pixel, side) != 0} << side;
    results.insert(results.end(), {owner, raya_share_size(share), number, found_pixel.row, found_pixel.column, sides,
                                   raya_share_size(raya_share_of(m, other_pe))});
}

// `group_size`: work-group size of kernel reverse_words, 1..1024.
CheckRunner machine_runner(Session& session, const KernelSources& sources, std::uint32_t group_size = 1) {
    return {session, Kernels(session, {.group_size = group_size}, sources).program("checks/machine.cl")};
}

// Checks mappings of `kind` (RAYA_FOLD_CYCLIC..RAYA_RANDOM): the owner of a pixel, the pixel's number in the owner's
// share, and flags of the neighbours that are in the image.
Verdict check_owners(CheckRunner& runner, std::uint32_t kind, std::size_t cases) {
    const auto [mappings, pixels] = mapping_cases(kind, cases);
    Words expected;
    for (std::uint32_t i = 0; i < cases; ++i) add_owner(expected, mappings[i], pixels[i], i % mappings[i].pes);
    const auto mapping_buffer = runner.filled("mappings", mappings);
    const auto pixel_buffer = runner.filled("pixels", pixels);
    auto owners = runner.poisoned("owners", expected.size());
    runner.run<const Buffer<raya_mapping>&, const Buffer<raya_pixel>&, cl_uint, Buffer<std::uint32_t>&>(
        "find_owners", cases, 1, mapping_buffer, pixel_buffer, static_cast<cl_uint>(cases), owners);
    const auto describe = [&, &m = mappings, &p = pixels](std::size_t i) {
        return fmt::format("pixel (row {}, column {}) of {}x{} on {} PEs, {}", p[i].row, p[i].column, m[i].width,
                           m[i].height, m[i].pes, mapping_text(m[i]));
    };
    return compare_cases(expected, runner, owners,
                         {"owner", "size of the share", "number in the share", "row", "column", "neighbours",
                          "size of another PE's share"},
                         describe, fmt::format("{} pixels", cases));
}

// Checks, for random nodes a and b, the first link on the route of a ray from a to b, the return link of a, and the
// nodes at the other ends of a's links.
Verdict check_torus_routes(CheckRunner& runner, std::size_t cases) {
    const auto [toruses, nodes] = torus_cases(cases);
    Words expected;
    for (std::size_t i = 0; i < cases; ++i) {
        expected.push_back(raya_next_link(toruses[i], nodes[2 * i], nodes[2 * i + 1]));
        expected.push_back(raya_return_link(toruses[i], nodes[2 * i]));
        expected.push_back(raya_nodes(toruses[i]));
        expected.push_back(nodes[2 * i]);
        for (std::uint32_t link = 0; link < RAYA_LINKS; ++link)
            expected.push_back(raya_link_end(toruses[i], nodes[2 * i], link));
    }
    const auto torus_buffer = runner.filled("toruses", toruses);
    const auto node_buffer = runner.filled("nodes", nodes);
    auto routes = runner.poisoned("routes", expected.size());
    runner.run<const Buffer<raya_torus>&, const Buffer<std::uint32_t>&, cl_uint, Buffer<std::uint32_t>&>(
        "find_routes", cases, 1, torus_buffer, node_buffer, static_cast<cl_uint>(cases), routes);
    const auto describe = [&, &t = toruses, &n = nodes](std::size_t i) {
        return fmt::format("node {} to {} on {}", n[2 * i], n[2 * i + 1],
                           sides_text({t[i].sides[0], t[i].sides[1], t[i].sides[2]}));
    };
    return compare_cases(expected, runner, routes,
                         {"next link", "return link", "number of nodes", "node at the place", "end of +x", "end of -x",
                          "end of +y", "end of -y", "end of +z", "end of -z"},
                         describe, fmt::format("{} pairs of nodes", cases));
}

// Checks functions of packets, and sizes of queues and local memory, for random places, states, lights and bounces.
Verdict check_packet_words(CheckRunner& runner, std::size_t cases) {
    constexpr std::uint64_t kSeed = 22;
    SplitMix random(kSeed);
    Words inputs, expected;
    for (std::size_t i = 0; i < cases; ++i) {
        const std::uint32_t x = random_below(random, 1024), y = random_below(random, 1024),
                            z = random_below(random, 1024), lights = random_below(random, 1u << i % 17),
                            level = random_below(random, 32), bounces = level + random_below(random, 32 - level),
                            kind = RAYA_KIND_PRIMARY + random_below(random, RAYA_KINDS - RAYA_KIND_PRIMARY),
                            state = raya_state(kind, level, lights), new_packets = raya_max_new_packets(lights);
        inputs.insert(inputs.end(), {x, y, z, state, lights, bounces});
        expected.insert(
            expected.end(),
            {raya_pack_place(x, y, z), level, lights, lights + 2, raya_slots_for_packet(new_packets, bounces, state),
             RAYA_WORK_OF_PROCESSING(lights), RAYA_INJECT_WORDS(1 + x, 1 + y % 16), RAYA_ROUTE_WORDS(1 + x)});
    }
    const auto input_buffer = runner.filled("inputs", inputs);
    auto words = runner.poisoned("words", expected.size());
    runner.run<const Buffer<std::uint32_t>&, cl_uint, Buffer<std::uint32_t>&>(
        "find_packet_words", cases, 1, input_buffer, static_cast<cl_uint>(cases), words);
    const auto describe = [&](std::size_t i) {
        return fmt::format("place ({}, {}, {}), state 0x{:08x}, {}, {} bounces", inputs[6 * i], inputs[6 * i + 1],
                           inputs[6 * i + 2], inputs[6 * i + 3], counted(inputs[6 * i + 4], "light"),
                           inputs[6 * i + 5]);
    };
    return compare_cases(expected, runner, words,
                         {"packed place", "level", "light", "maximum number of new packets", "queue slots",
                          "work of processing", "local memory of inject", "local memory of route"},
                         describe, fmt::format("{} packets", cases));
}

// Checks barriers and atomics. Each work-group reverses the order of words in local memory kReversals times and adds 1
// to each word every time. Its work-items take numbers from an atomic counter; each number must be taken once.
Verdict check_local_memory(CheckRunner& runner, std::uint32_t group_size) {
    constexpr std::uint32_t kGroups = 64, kReversals = 9;
    const std::uint32_t words = 2000;  // 2 x 2000 words of 4 bytes: half of the 32 KB that OpenCL guarantees
    Words source(std::size_t{kGroups} * words), expected(source.size());
    std::iota(source.begin(), source.end(), 0u);
    for (std::size_t i = 0; i < source.size(); ++i)  // kReversals is odd, so the result is in reverse order
        expected[i] = source[i / words * words + (words - 1 - i % words)] + kReversals;
    const auto source_buffer = runner.filled("from", source);
    auto reversed = runner.poisoned("to", source.size());
    auto times_taken = runner.constant<std::uint32_t>("times taken", source.size(), 0);
    using Local = LocalMemory<std::uint32_t>;
    runner.run<const Buffer<std::uint32_t>&, cl_uint, cl_uint, Local, Local, Buffer<std::uint32_t>&,
               Buffer<std::uint32_t>&>("reverse_words", kGroups, group_size, source_buffer, words, kReversals,
                                       Local{2 * words}, Local{1}, reversed, times_taken);
    const auto describe = [&](std::size_t i) { return fmt::format("group {}, word {}", i / words, i % words); };
    const std::string pass_text = fmt::format("{} groups of {} words", kGroups, words);
    const Verdict verdict = compare_cases(expected, runner, reversed, {"local memory"}, describe, pass_text);
    if (verdict.outcome != Outcome::kPass) return verdict;
    return compare_cases(Words(source.size(), 1), runner, times_taken,
                         {"times that a number was taken from the counter"}, describe, pass_text);
}

const char* kind_name(std::uint32_t kind) {
    constexpr std::array<const char*, RAYA_RANDOM + 1> kNames = {
        "cyclic, cyclic fold", "cyclic, block fold", "rows", "blocks", "grid", "tiles", "random"};
    return kNames[kind];
}

void verify_kernels(Verification& v) {
    const std::size_t cases = v.full() ? 50'000 : 5'000;
    const auto check = [&](const std::string& name, std::uint32_t group,
                           const std::function<Verdict(CheckRunner&)>& body) {
        v.check("machine", name, [&](Session& session) {
            if (group > v.device().max_group_size)
                return skipped(fmt::format("needs groups of {} work-items, the device allows {}", group,
                                           v.device().max_group_size));
            CheckRunner runner = machine_runner(session, v.sources(), group);
            return with_remedies(body(runner), runner.options(), integer_remedies());
        });
    };
    for (std::uint32_t kind = 0; kind <= RAYA_RANDOM; ++kind)
        check(fmt::format("mapping: {}", kind_name(kind)), 1,
              [&](CheckRunner& runner) { return check_owners(runner, kind, cases); });
    check("torus routes", 1, [&](CheckRunner& runner) { return check_torus_routes(runner, cases); });
    check("torus packets", 1, [&](CheckRunner& runner) { return check_packet_words(runner, cases); });
    for (const std::uint32_t group : v.full() ? std::vector{1u, 2u, 8u, 32u, 64u} : std::vector{1u, 32u})
        check("local memory and barriers, " + counted(group, "work-item"), group,
              [&](CheckRunner& runner) { return check_local_memory(runner, group); });
}

}  // namespace

void verify_machines(Verification& v) {
    verify_kernels(v);
    verify_transfers(v);
}

}  // namespace raya
