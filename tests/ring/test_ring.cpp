// Exchanges bring the blocks of the right PEs without changing a bit. The number of copied words is counted. `raya
// verify` checks single rotations and transfers.
#include <algorithm>
#include <bit>
#include <catch2/catch.hpp>
#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

#include "host/ring/bus_and_ring.hpp"
#include "host/ring/mapping.hpp"
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

/// Returns the number of bytes of all copies between buffers whose label starts with `label`.
std::uint64_t copied_bytes(Session& session, const std::string& label) {
    std::uint64_t bytes = 0;
    for (const CommandRecord& command : session.profile().commands())
        if (command.kind == "copy" && command.label.starts_with(label)) bytes += command.bytes;
    return bytes;
}

}  // namespace

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
        session.clear_profile();
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
        CHECK(copied_bytes(session, "ring.rotate") == 4 * counted.rotation_words);
        CHECK(copied_bytes(session, "bus.send") == 4 * counted.transfer_words);
        CHECK(copied_bytes(session, "bus.broadcast_from") == 4 * counted.pe_broadcast_words);
        CHECK((counted.broadcasts == 0 && counted.gathers == 0));
        CHECK(contents(session, own_buffer) == own_words);
    }
}
