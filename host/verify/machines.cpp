// Checks of layer "machine": integer arithmetic, local memory, barriers and atomics with kernels/checks/machine.cl, and
// transfers. All results are exact integers. The host computes the expected results with the headers that the kernels
// use.
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
template <class Word = std::uint32_t>
std::vector<Word> distinct_words(std::size_t count, std::size_t first = 0) {
    std::vector<Word> words(count);
    for (std::size_t i = 0; i < count; ++i)
        words[i] = std::bit_cast<Word>(0x3f000000u + static_cast<std::uint32_t>(first + i));
    return words;
}

// Compares `expected` with `got`. Returns nullopt if they are equal, else a failure with the first difference. `unit`:
// name of a group of `words_per_unit` words, such as "PE".
template <class Word>
std::optional<Verdict> difference(const std::vector<Word>& expected, const std::vector<Word>& got,
                                  const std::string& transfer, std::size_t words_per_unit, const char* unit) {
    const auto differ = std::mismatch(expected.begin(), expected.end(), got.begin());
    if (differ.first == expected.end()) return {};
    const auto at = static_cast<std::size_t>(differ.first - expected.begin());
    return failed(transfer + ": words at wrong places",
                  {.where = fmt::format("{}, {} {}, word {}", transfer, unit, at / words_per_unit, at % words_per_unit),
                   .expected = fmt::format("0x{:08x}", std::bit_cast<std::uint32_t>(expected[at])),
                   .got = fmt::format("0x{:08x}", std::bit_cast<std::uint32_t>(got[at]))});
}

// Packets for check_links(). Every `stride`-th outbox has 1 to kCapacity packets, the others none. Each word of a
// packet contains the number of its outbox and its position in the outbox.
struct LinkTraffic {
    LinkTraffic(const raya_torus& torus, std::uint32_t stride, std::size_t words)
        : status{std::vector<std::uint32_t>(std::size_t{raya_nodes(torus)} * RAYA_STATUS_WORDS)},
          outboxes(words),
          inboxes(words, kPoison),
          expected_inboxes(words),
          expected_sent(words / kMailboxWords) {
        const std::uint32_t nodes = raya_nodes(torus);
        for (std::uint32_t outbox = 0; outbox < expected_sent.size(); ++outbox) {
            const std::uint32_t link = outbox / nodes, node = outbox % nodes;
            const bool is_used = torus.sides[link / 2] > 1 && outbox % stride == 0;
            const std::uint32_t packets = is_used ? 1 + outbox % kCapacity : 0;
            status.words[std::size_t{node} * RAYA_STATUS_WORDS + RAYA_STATUS_OUTBOX + link] = packets;
            const std::size_t at = std::size_t{outbox} * kMailboxWords;
            inboxes[at] = 0;  // 0 packets, even if LinkExchange::clear() is wrong
            outboxes[at] = expected_inboxes[at] = packets;
            expected_sent[outbox] = packets > 0;
            for (std::uint32_t w = 0; w < packets * kPacketWords; ++w)
                outboxes[at + kPacketWords + w] = expected_inboxes[at + kPacketWords + w] = outbox << 12 | (w + 1);
            packets_sent += packets;
        }
    }

    static constexpr std::uint32_t kCapacity = 5, kPacketWords = RAYA_PACKET_WORDS,
                                   kMailboxWords = (1 + kCapacity) * kPacketWords;
    NodeStatus status;
    Words outboxes, inboxes, expected_inboxes, expected_sent;
    std::uint32_t packets_sent = 0;
};

/// Checks one broadcast and one gather over the bus.
Verdict check_bus(Session& session) {
    constexpr std::size_t kWords = 100'003;
    Communication counted;
    Bus bus(session, counted, Distribution(1));
    const Words words = distinct_words(kWords);
    auto received = session.buffer<std::uint32_t>("broadcast words", kWords);
    session.fill("broadcast words", received, kPoison);
    bus.broadcast(received, words);
    Words got(kWords);
    session.read("read back", received, got);
    if (auto verdict = difference(words, got, "broadcast", kWords, "broadcast")) return *verdict;
    const std::vector<float> pixels = distinct_words<float>(kWords);
    auto blocks = session.buffer<float>("pixel blocks", kWords);
    session.write("blocks", blocks, pixels);
    std::vector<float> gathered(kWords);
    bus.gather(blocks, gathered, kWords);
    if (auto verdict = difference(pixels, gathered, "gather", kWords, "gather")) return *verdict;
    return passed(fmt::format("{} words in each direction", kWords));
}

// Rounds of transfers of blocks between PEs. A PE has kRows rows of `pitch` words; its block consists of `words` words
// of each row, from word kOffset of the row on.
constexpr std::size_t kRows = 3, kOffset = 2;
struct Rounds {
    const char* kind;  // "rotation"
    std::size_t pes, words, rounds, pitch = words + 3;

    // Calls transfer(round, distance, memory) in each round, and checks the blocks that it returns, [PE][kRows][words]:
    // PE i must have received the block of PE (i + distance_of(round)) mod P. Each round has new words, so that words
    // of an earlier round and a transfer that does nothing are detected. Returns the first failure.
    template <class Distance, class Transfer>
    std::optional<Verdict> check(Session& session, const Distance& distance_of, const Transfer& transfer) const {
        auto memory = session.buffer<float>("memory words", pes * kRows * pitch);
        for (std::size_t round = 0; round < rounds; ++round) {
            const std::size_t distance = distance_of(round);
            const std::vector<float> source = distinct_words<float>(memory.size(), round * memory.size());
            session.write("memory words", memory, source);
            const Buffer<float>& blocks = transfer(round, distance, memory);
            std::vector<float> expected(pes * kRows * words), got(expected.size());
            for (std::size_t w = 0; w < expected.size(); ++w) {
                const std::size_t pe = (w / words / kRows + distance) % pes, row = w / words % kRows;
                expected[w] = source[(pe * kRows + row) * pitch + kOffset + w % words];
            }
            session.read("blocks", blocks, got);
            const std::string name = fmt::format("{} {} of {} PEs", kind, round + 1, pes);
            if (auto verdict = difference(expected, got, name, kRows * words, "PE")) return verdict;
        }
        return {};
    }
};

// Checks transfers of blocks over the bus; a block has kRows rows of `words` words. For each of five distances d, PE i
// receives the block of PE (i + d) mod `pes`. Then each PE in turn broadcasts its block to all PEs.
Verdict check_transfers(Session& session, std::size_t pes, std::size_t words) {
    Communication counted;
    Bus bus(session, counted, Distribution(static_cast<std::uint32_t>(pes)));
    const Rounds rounds{"transfer", pes, words, 6};
    auto blocks = session.buffer<float>("blocks", pes * kRows * words);
    const auto is_broadcast = [](std::size_t round) { return round == 5; };  // every PE sends its block to all
    const auto distance_of = [&](std::size_t round) { return is_broadcast(round) ? 0 : 1 + round * (pes - 1) / 5; };
    const auto transfer = [&](std::size_t round, std::size_t distance, Buffer<float>& memory) -> Buffer<float>& {
        for (std::size_t pe = 0; pe < pes; ++pe) {
            const PeWords from{(pe + distance) % pes, rounds.pitch, kOffset, kRows}, to{pe, words, 0, kRows};
            if (is_broadcast(round))
                bus.broadcast_from(memory, from, blocks, to, words);
            else
                bus.send(memory, from, blocks, to, words);
        }
        return blocks;
    };
    if (auto verdict = rounds.check(session, distance_of, transfer)) return *verdict;
    return passed(fmt::format("{} transfers and {} broadcasts of {} words", counted.transfers, counted.pe_broadcasts,
                              kRows * words));
}

// Checks 12 rotations (circular shifts over the ring) of `pes` blocks, in both directions.
Verdict check_rotations(Session& session, std::size_t pes, std::size_t words) {
    Communication counted;
    Ring ring(session, counted, Distribution(static_cast<std::uint32_t>(pes)), kRows, words);
    const Rounds rounds{"rotation", pes, words, 12};
    const auto is_up = [](std::size_t round) { return round % 4 == 3; };
    const auto transfer = [&](std::size_t round, std::size_t, Buffer<float>& memory) -> const Buffer<float>& {
        ring.load(memory, rounds.pitch, kOffset);
        ring.rotate(is_up(round) ? RingDirection::kUp : RingDirection::kDown);
        return ring.blocks();
    };
    if (auto verdict = rounds.check(
            session, [&](std::size_t round) { return is_up(round) ? pes - 1 : 1; }, transfer))
        return *verdict;
    return passed(fmt::format("{} rotations of {} blocks of {} words", rounds.rounds, pes, kRows * words));
}

// Fills every `stride`-th outbox with packets, exchanges packets over all links once, and checks all inboxes and the
// flags that mark the outboxes whose packets have been transferred.
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

void verify_transfers(Verification& v) {
    const std::vector<BlockCopy> copies = {{{3, 17, 0}, {0, 5, 2}, 5, 40},
                                           {{0, 8, 1}, {4, 31, 0}, 8, 33},
                                           {{2, 9, 5}, {1, 7, 3}, 4, 300},
                                           {{0, 64, 0}, {0, 64, 64}, 64, 63}};
    v.check("machine", "copies of blocks", [&](Session& s) { return check_copies(s, copies); });
    v.check("machine", "bus: broadcast and gather", check_bus);
    v.check("machine", "bus: transfers between 31 PEs", [](Session& s) { return check_transfers(s, 31, 100); });
    using Sizes = std::pair<std::size_t, std::size_t>;
    for (const auto& [pes, words] : {Sizes{2, 1}, {7, 100}, {256, 768}})
        v.check("machine", fmt::format("ring: rotations of {} PEs", pes),
                [p = pes, w = words](Session& s) { return check_rotations(s, p, w); });
    for (const Links links : {Links::kTorus3d, Links::kTorus2d})
        for (const std::uint32_t stride : {1u, 50u}) {
            const std::string name =
                fmt::format("{}: exchange of {}", links_name(links), stride == 1 ? "all mailboxes" : "few mailboxes");
            v.check("machine", name, [&](Session& s) {
                // A mailbox takes 4 to 12 units of 8 words. So some of the 8 work-items copy two units, some one unit,
                // and some none.
                Kernels kernels(s, {.group_size = std::min(8u, max_group_size_of(v.device()))}, v.settings().sources);
                return check_links(s, make_torus({3, 2, 4}, links), stride, kernels);
            });
        }
}

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

// Compares the buffer `results`, which has several words per case, with `expected`. `names`: names of the words of a
// case; `describe(i)`: description of case i.
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

// Runs a kernel that computes several words for each of its cases, one work-item per case, from buffers with the
// inputs, and compares the words with `expected`. `names`: names of the words of a case; `describe(i)`: description of
// case i; `subject`: plural of a case.
template <class Describe, class... Inputs>
Verdict check_cases(CheckRunner& runner, const std::string& kernel, const Words& expected,
                    const std::vector<std::string>& names, const std::string& subject, const Describe& describe,
                    const std::vector<Inputs>&... inputs) {
    const std::size_t cases = expected.size() / names.size();
    auto results = runner.poisoned("results", expected.size());
    runner.run<const Buffer<Inputs>&..., cl_uint, Buffer<std::uint32_t>&>(
        kernel, cases, 1, runner.filled("inputs", inputs)..., static_cast<cl_uint>(cases), results);
    return compare_cases(expected, runner, results, names, describe, fmt::format("{} {}", cases, subject));
}

// Checks random mappings of `kind` (RAYA_FOLD_CYCLIC..RAYA_RANDOM): the owner of a pixel, the pixel's number in the
// owner's share, flags of the neighbours that are in the image, and the size of another PE's share, which may be empty.
Verdict check_owners(CheckRunner& runner, std::uint32_t kind, std::size_t cases) {
    constexpr std::uint64_t kSeed = 1993;
    SplitMix random(kSeed + kind);
    std::vector<raya_mapping> mappings;
    std::vector<raya_pixel> pixels;
    Words expected;
    for (std::uint32_t i = 0; i < cases; ++i) {
        const raya_mapping m = mappings.emplace_back(random_mapping_of_kind(random, kind));
        const raya_pixel pixel = pixels.emplace_back(raya_pixel{i % 8 ? random_below(random, m.height) : m.height - 1,
                                                                i % 4 ? random_below(random, m.width) : m.width - 1});
        const std::uint32_t owner = raya_owner(m, pixel.row, pixel.column);
        const raya_share share = raya_share_of(m, owner);
        const std::uint32_t number = raya_index_of(m, share, pixel);
        const raya_pixel found_pixel = raya_pixel_of(m, share, number);
        std::uint32_t sides = 0;
        for (std::uint32_t side = 0; side < RAYA_SIDES; ++side)
            sides |= std::uint32_t{raya_has_neighbour(m, pixel, side) != 0} << side;
        expected.insert(expected.end(), {owner, raya_share_size(share), number, found_pixel.row, found_pixel.column,
                                         sides, raya_share_size(raya_share_of(m, i % m.pes))});
    }
    const auto describe = [&](std::size_t i) {
        return fmt::format("pixel (row {}, column {}) of {}x{} on {} PEs, {}", pixels[i].row, pixels[i].column,
                           mappings[i].width, mappings[i].height, mappings[i].pes, mapping_text(mappings[i]));
    };
    return check_cases(runner, "find_owners", expected,
                       {"owner", "size of the share", "number in the share", "row", "column", "neighbours",
                        "size of another PE's share"},
                       "pixels", describe, mappings, pixels);
}

// Checks, for random nodes a and b of toruses, alternately 3-D and 2-D: the first link on the route of a ray from a to
// b, the return link of a, and the nodes at the other ends of a's links.
Verdict check_torus_routes(CheckRunner& runner, std::size_t cases) {
    constexpr std::uint64_t kSeed = 805;
    SplitMix random(kSeed);
    std::vector<raya_torus> toruses;
    Words nodes, expected;  // nodes: [torus][2]
    for (std::size_t i = 0; i < cases; ++i) {
        const auto side = [&] { return 1 + random_below(random, i % 5 ? 7 : 40); };
        const raya_torus torus =
            toruses.emplace_back(make_torus({side(), side(), side()}, i % 2 ? Links::kTorus2d : Links::kTorus3d));
        const std::uint32_t a = nodes.emplace_back(random_below(random, raya_nodes(torus))),
                            b = nodes.emplace_back(random_below(random, raya_nodes(torus)));
        expected.insert(expected.end(),
                        {raya_next_link(torus, a, b), raya_return_link(torus, a), raya_nodes(torus), a});
        for (std::uint32_t link = 0; link < RAYA_LINKS; ++link) expected.push_back(raya_link_end(torus, a, link));
    }
    const auto describe = [&](std::size_t i) {
        const raya_u32* const sides = toruses[i].sides;
        return fmt::format("node {} to {} on {}", nodes[2 * i], nodes[2 * i + 1],
                           sides_text({sides[0], sides[1], sides[2]}));
    };
    return check_cases(runner, "find_routes", expected,
                       {"next link", "return link", "number of nodes", "node at the place", "end of +x", "end of -x",
                        "end of +y", "end of -y", "end of +z", "end of -z"},
                       "pairs of nodes", describe, toruses, nodes);
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
    const auto describe = [&](std::size_t i) {
        return fmt::format("place ({}, {}, {}), state 0x{:08x}, {}, {} bounces", inputs[6 * i], inputs[6 * i + 1],
                           inputs[6 * i + 2], inputs[6 * i + 3], counted(inputs[6 * i + 4], "light"),
                           inputs[6 * i + 5]);
    };
    return check_cases(runner, "find_packet_words", expected,
                       {"packed place", "level", "light", "maximum number of new packets", "queue slots",
                        "work of processing", "local memory of inject", "local memory of route"},
                       "packets", describe, inputs);
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

void verify_kernels(Verification& v) {
    const std::size_t cases = v.full() ? 50'000 : 5'000;
    const auto check = [&](const std::string& name, std::uint32_t group,
                           const std::function<Verdict(CheckRunner&)>& body) {
        const auto run = [&](Session& session) {
            CheckRunner runner(
                session, Kernels(session, {.group_size = group}, v.settings().sources).program("checks/machine.cl"));
            return with_options(body(runner), runner.options());
        };
        v.check("machine", name, run, group);
    };
    constexpr std::array<const char*, RAYA_RANDOM + 1> kKinds = {
        "cyclic, cyclic fold", "cyclic, block fold", "rows", "blocks", "grid", "tiles", "random"};
    for (std::uint32_t kind = 0; kind < kKinds.size(); ++kind)
        check(fmt::format("mapping: {}", kKinds[kind]), 1,
              [&](CheckRunner& runner) { return check_owners(runner, kind, cases); });
    check("torus routes", 1, [&](CheckRunner& runner) { return check_torus_routes(runner, cases); });
    check("torus packets", 1, [&](CheckRunner& runner) { return check_packet_words(runner, cases); });
    for (const std::uint32_t group : v.full() ? std::vector{1u, 2u, 8u, 32u, 64u} : std::vector{1u, 32u})
        check("local memory and barriers, " + counted(group, "work-item"), group,
              [&](CheckRunner& runner) { return check_local_memory(runner, group); });
}

}  // namespace

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

void verify_machines(Verification& v) {
    verify_kernels(v);
    verify_transfers(v);
}

}  // namespace raya
