// Rotations move the block of each PE to the PE's neighbour without changing a bit. The number of copied words is
// counted.
#include <algorithm>
#include <bit>
#include <catch2/catch.hpp>
#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

#include "host/ring/bus_and_ring.hpp"
#include "host/ring/mapping.hpp"
#include "host/verify/machines.hpp"
#include "tests/ring/small_mapping.hpp"

using namespace raya;

namespace {

using Bits = std::vector<std::uint32_t>;  // floats as bits, so that NaNs compare equal

/// Returns random words. Half of them are values that copying by floating-point arithmetic would change, such as NaNs.
Bits random_words(SplitMix& random, std::size_t count) {
    const std::uint32_t fragile_values[] = {0x80000000u, 0x7fc12345u, 0x7f800001u,
                                            0xff923456u, 0x00000001u, 0x7f800000u};
    Bits words(count);
    for (std::uint32_t& word : words)
        word = random.next() % 2 ? fragile_values[random.next() % 6] : std::uint32_t(random.next());
    return words;
}

Bits contents(Session& session, const Buffer<float>& buffer) {
    std::vector<float> words(buffer.size());
    session.read("contents", buffer, words);
    Bits bits(words.size());
    std::memcpy(bits.data(), words.data(), 4 * words.size());
    return bits;
}

Buffer<float> filled(Session& session, const std::string& name, const Bits& bits) {
    std::vector<float> words(bits.size());
    std::memcpy(words.data(), bits.data(), 4 * bits.size());
    Buffer<float> buffer = session.buffer<float>(name, words.size());
    session.write(name, buffer, words);
    return buffer;
}

/// Returns the blocks after rotations by `distance`: block i is the former block (i + distance) mod P.
Bits rotated(const Bits& blocks, std::size_t pes, std::size_t distance) {
    Bits moved(blocks.size());
    const std::size_t size = blocks.size() / pes;
    for (std::size_t i = 0; i < pes; ++i)
        for (std::size_t n = 0; n < size; ++n) moved[i * size + n] = blocks[(i + distance) % pes * size + n];
    return moved;
}

/// Returns the number of bytes of all copies between buffers whose label starts with `label`.
std::uint64_t copied_bytes(Session& session, const std::string& label) {
    std::uint64_t bytes = 0;
    for (const CommandRecord& command : session.profile().commands())
        if (command.kind == "copy" && command.label.starts_with(label)) bytes += command.bytes;
    return bytes;
}

/// Returns the number of commands that are not copies.
std::size_t commands_without_copies(Session& session) {
    const auto& commands = session.profile().commands();
    return static_cast<std::size_t>(
        std::count_if(commands.begin(), commands.end(), [](const CommandRecord& c) { return c.kind != "copy"; }));
}

constexpr std::size_t kRingSizes[] = {1, 2, 3, 7, 64};

}  // namespace

TEST_CASE("a rotation moves every block to the neighbour, in either direction", "[ring]") {
    Session session(choose_device(""));
    for (const std::size_t pes : kRingSizes)
        for (const std::size_t block : {1, 3, 17, 768}) {
            CAPTURE(pes, block);
            CHECK(check_rotations(session, pes, block).outcome == Outcome::kPass);
        }
}

TEST_CASE("P rotations in either direction bring every block back", "[ring]") {
    constexpr std::uint64_t kSeed = 9;
    SplitMix random(kSeed);
    Session session(choose_device(""));
    for (const std::size_t pes : kRingSizes)
        for (const RingDirection direction : {RingDirection::kDown, RingDirection::kUp}) {
            CAPTURE(kSeed, pes, int(direction));
            Communication counted;
            Ring ring(session, counted, Distribution(static_cast<std::uint32_t>(pes)), 1, 5);
            const Bits before = random_words(random, pes * 5);
            ring.load(filled(session, "own", before), 5, 0);
            for (std::size_t n = 1; n <= pes; ++n) {
                ring.rotate(direction);
                const std::size_t distance = direction == RingDirection::kDown ? n : pes - n;
                if (contents(session, ring.blocks()) != rotated(before, pes, distance))
                    FAIL_CHECK("wrong blocks after rotation " << n);
            }
            CHECK(contents(session, ring.blocks()) == before);
        }
}

TEST_CASE("rotations are counted by the words that were copied", "[ring]") {
    constexpr std::uint64_t kSeed = 10;
    SplitMix random(kSeed);
    Session session(choose_device(""));
    for (int i = 0; i < 100; ++i) {
        const std::size_t pes = kRingSizes[i % 5], block = 1 + random_below(random, 40);
        const std::uint32_t down = random_below(random, 5), up = random_below(random, 5);
        CAPTURE(kSeed, i, pes, block, down, up);
        Communication counted;
        Ring ring(session, counted, Distribution(static_cast<std::uint32_t>(pes)), 1, block);
        const Buffer<float> own_buffer = filled(session, "own", random_words(random, pes * block));
        session.clear_profile();
        ring.load(own_buffer, block, 0);
        CHECK((counted.rotations == 0 && counted.rotation_words == 0));  // a PE's own words do not move
        for (std::uint32_t n = 0; n < down; ++n) ring.rotate(RingDirection::kDown);
        for (std::uint32_t n = 0; n < up; ++n) ring.rotate(RingDirection::kUp);
        CHECK(counted.rotations == down + up);
        CHECK(counted.rotation_words == (down + up) * pes * block);
        CHECK(copied_bytes(session, "ring.rotate") == 4 * counted.rotation_words);
        CHECK(copied_bytes(session, "ring.rotate_down") == 4 * down * pes * block);
        CHECK(copied_bytes(session, "ring.load") == 4 * pes * block);
        CHECK(copied_bytes(session, "") == 4 * (down + up + 1) * pes * block);
        CHECK(commands_without_copies(session) == 0);
        CHECK((counted.broadcasts == 0 && counted.gathers == 0));
    }
}

TEST_CASE("a band that reaches beyond the share's end loads the remaining words and leaves the other words unchanged",
          "[ring]") {
    constexpr std::uint64_t kSeed = 11;
    SplitMix random(kSeed);
    Session session(choose_device(""));
    int short_bands = 0;
    for (int i = 0; i < 200; ++i) {
        const std::size_t pes = kRingSizes[i % 5], rows = 1 + i % 3, share = 1 + random_below(random, 30);
        const std::size_t band = 1 + random_below(random, share), begin = random_below(random, share);
        CAPTURE(kSeed, i, pes, rows, share, band, begin);
        Communication counted;
        Ring ring(session, counted, Distribution(static_cast<std::uint32_t>(pes)), rows, band);
        const Bits own_words = random_words(random, pes * rows * share),
                   stale = random_words(random, pes * rows * band);
        const Buffer<float> own_buffer = filled(session, "own", own_words);
        ring.load(filled(session, "stale", stale), band, 0);
        ring.load(own_buffer, share, begin);
        Bits expected = stale;
        const std::size_t count = std::min(band, share - begin);
        for (std::size_t row = 0; row < pes * rows; ++row)
            for (std::size_t n = 0; n < count; ++n) expected[row * band + n] = own_words[row * share + begin + n];
        CHECK(contents(session, ring.blocks()) == expected);
        CHECK(contents(session, own_buffer) == own_words);
        CHECK(counted.rotations == 0);
        short_bands += count < band;
    }
    CHECK(short_bands > 20);
}

TEST_CASE("bus transfers and broadcasts by PEs copy every block to its destination", "[ring][bus]") {
    Session session(choose_device(""));
    for (const std::size_t pes : kRingSizes)
        for (const std::size_t block : {1, 3, 17, 768}) {
            CAPTURE(pes, block);
            CHECK(check_transfers(session, pes, block).outcome == Outcome::kPass);
        }
}

TEST_CASE("bus transfers and broadcasts are counted by the words that were copied", "[ring][bus]") {
    constexpr std::uint64_t kSeed = 15;
    SplitMix random(kSeed);
    Session session(choose_device(""));
    for (int i = 0; i < 50; ++i) {
        const std::size_t pes = kRingSizes[i % 5], rows = 1 + i % 3, share = 1 + random_below(random, 40);
        const std::size_t words = 1 + random_below(random, share);
        const std::uint32_t sent = random_below(random, 5), broadcasts = random_below(random, 5);
        CAPTURE(kSeed, i, pes, rows, share, words, sent, broadcasts);
        Communication counted;
        Bus bus(session, counted, Distribution(static_cast<std::uint32_t>(pes)));
        const Bits own_words = random_words(random, pes * rows * share);
        const Buffer<float> own_buffer = filled(session, "own", own_words);
        Buffer<float> blocks = filled(session, "blocks", random_words(random, pes * rows * words));
        session.clear_profile();
        for (std::uint32_t n = 0; n < sent; ++n)
            bus.send(own_buffer, {n % pes, share, share - words, rows}, blocks, {(n + 1) % pes, words, 0, rows}, words);
        for (std::uint32_t n = 0; n < broadcasts; ++n)
            bus.broadcast_from(own_buffer, {n % pes, share, 0, rows}, blocks, {n % pes, words, 0, rows}, words);
        CHECK((counted.transfers == sent && counted.transfer_words == sent * rows * words));
        CHECK((counted.pe_broadcasts == broadcasts && counted.pe_broadcast_words == broadcasts * rows * words));
        CHECK(copied_bytes(session, "bus.send") == 4 * counted.transfer_words);
        CHECK(copied_bytes(session, "bus.broadcast_from") == 4 * counted.pe_broadcast_words);
        CHECK(commands_without_copies(session) == 0);
        CHECK((counted.rotations == 0 && counted.broadcasts == 0 && counted.gathers == 0));
        CHECK(contents(session, own_buffer) == own_words);
    }
}

TEST_CASE("an exchange brings every band from every distance once, with the predicted number of moves", "[ring][bus]") {
    constexpr std::uint64_t kSeed = 12;
    const ExchangeMethod method = GENERATE(ExchangeMethod::kRing, ExchangeMethod::kBus, ExchangeMethod::kBroadcast);
    SplitMix random(kSeed);
    Session session(choose_device(""));
    for (int i = 0; i < 100; ++i) {
        const raya_mapping m = any_mapping(random, 8);
        const std::uint32_t capacity = largest_share(m), band = 1 + random_below(random, capacity);
        CAPTURE(kSeed, i, exchange_name(method), m.width, m.height, m.pes, mapping_text(m), m.kind, capacity, band);
        const Bits own_words = random_words(random, std::size_t{m.pes} * capacity * 3);
        const Buffer<float> own_buffer = filled(session, "own", own_words);
        Communication counted;
        NeighbourExchange exchange(session, counted, m, capacity, band, method, Distribution(m.pes));
        std::uint32_t wrong = 0;
        for (raya_u32 side = 0; side < RAYA_SIDES; ++side) {
            const std::vector<std::uint32_t> distances = neighbour_distances(m, side);
            std::vector<std::uint64_t> expected_arrivals, arrivals;
            for (std::uint32_t begin = 0; begin < capacity; begin += band)
                for (const std::uint32_t d : distances) expected_arrivals.push_back(std::uint64_t{begin} << 32 | d);
            exchange.visit(own_buffer, {side}, [&](const Arrival& arrival) {
                CHECK(arrival.side == side);
                arrivals.push_back(std::uint64_t{arrival.begin} << 32 | arrival.distance);
                const Bits blocks = contents(session, arrival.blocks);
                for (std::size_t pe = 0; pe < m.pes; ++pe)
                    for (std::size_t n = 0; n < 3ull * band; ++n) {
                        const std::size_t sender = (pe + arrival.distance) % m.pes, pixel = arrival.begin + n % band;
                        wrong += pixel < capacity &&
                                 blocks[pe * band * 3 + n] != own_words[(sender * 3 + n / band) * capacity + pixel];
                    }
            });
            std::sort(arrivals.begin(), arrivals.end());
            CHECK(arrivals == expected_arrivals);
        }
        CHECK(wrong == 0);
        const std::uint64_t bands = (capacity + band - 1) / band, moves = sum_of(exchange_moves(m, method, false));
        const std::uint64_t total_words =
            3ull * capacity * moves;  // number of words of all moves; a shorter last band moves fewer words
        const bool ring = method == ExchangeMethod::kRing, bus = method == ExchangeMethod::kBus;
        CHECK(counted.rotations == (ring ? moves * bands : 0));
        CHECK(counted.rotation_words == counted.rotations * m.pes * band * 3);
        CHECK(counted.transfers == (bus ? moves * bands : 0));
        CHECK(counted.transfer_words == (bus ? total_words : 0));
        CHECK(counted.pe_broadcasts == (ring || bus ? 0 : moves * bands));
        CHECK(counted.pe_broadcast_words == (ring || bus ? 0 : total_words));
        CHECK(contents(session, own_buffer) == own_words);
    }
}
