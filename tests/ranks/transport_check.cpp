// Program that checks every call of the MPI transport with known bytes, for messages of 0 bytes up to more than MPI's
// eager limit. Run it under mpirun, also with Valgrind or sanitizers. In a whole render, these tools find few errors of
// the transport, because most of the time is spent inside an OpenCL driver.
#include <fmt/core.h>

#include <memory>
#include <vector>

#include "host/base/module.hpp"
#include "host/ranks/ranks.hpp"
#include "host/ranks/transport.hpp"

namespace raya {
namespace {

constexpr std::size_t kSizes[] = {0, 1, 3, 1000, 65'536, (1 << 20) + 1, 5 << 20};  // bytes
constexpr int kTags = 4;                                                           // number of tags

using Bytes = std::vector<std::uint8_t>;

/// Returns the bytes that `sender` sends to `receiver` with `tag`. The bytes depend on both ranks, the tag and their
/// position.
Bytes known_bytes(std::size_t size, std::uint32_t sender, std::uint32_t receiver, int tag) {
    Bytes bytes(size);
    for (std::size_t i = 0; i < size; ++i)
        bytes[i] =
            static_cast<std::uint8_t>((i * 37 + i / 251) ^ (sender * 59 + receiver * 17 + static_cast<unsigned>(tag)));
    return bytes;
}

struct Checks {
    std::uint32_t count = 0, failures = 0;

    void compare(const Bytes& got, const Bytes& expected) {
        ++count;
        failures += got != expected;
    }
};

void check_broadcast(Ranks& ranks, std::size_t size, Checks& checks) {
    const Bytes expected = known_bytes(size, 0, 0, 0);
    Bytes bytes = ranks.is_first() ? expected : Bytes();
    ranks.broadcast(bytes);
    checks.compare(bytes, expected);
}

// Checks all_gather() and gather(). Every third rank contributes no bytes.
void check_gathers(Ranks& ranks, std::size_t size, Checks& checks) {
    const auto bytes_of = [size](std::uint32_t rank) { return known_bytes(size * (rank % 3), rank, 0, 0); };
    Bytes expected;
    std::vector<std::size_t> sizes;
    for (std::uint32_t rank = 0; rank < ranks.count(); ++rank) {
        const Bytes bytes = bytes_of(rank);
        expected.insert(expected.end(), bytes.begin(), bytes.end());
        sizes.push_back(bytes.size());
    }
    const Bytes own_bytes = bytes_of(ranks.rank());
    const std::span<const std::uint8_t> span(own_bytes);
    checks.compare(ranks.all_gather(span), expected);
    checks.compare(ranks.gather(span, sizes), ranks.is_first() ? expected : Bytes());
}

// Each rank sends messages to ranks rank + 1 and rank - 1 (modulo the number of ranks) concurrently, with several tags
// that are received in reverse order. With two ranks both receivers are the same rank; a single rank sends to itself.
void check_neighbours(Ranks& ranks, std::size_t size, Checks& checks) {
    const std::uint32_t count = ranks.count(), own_rank = ranks.rank();
    struct Message {
        std::uint32_t partner;
        int tag;
        Bytes bytes;
    };
    std::vector<Message> sent, received;
    for (int tag = 0; tag < kTags; ++tag) {
        const std::uint32_t step = tag % 2 == 0 ? 1 : count - 1;
        const std::uint32_t receiver = (own_rank + step) % count, sender = (own_rank + count - step) % count;
        const std::size_t bytes = size + static_cast<std::size_t>(tag);
        sent.push_back({receiver, tag, known_bytes(bytes, own_rank, receiver, tag)});
        received.insert(received.begin(), {sender, tag, Bytes(bytes)});
    }
    std::vector<OutgoingMessage> out;
    std::vector<IncomingMessage> in;
    for (const Message& m : sent) out.push_back({m.partner, m.tag, std::as_bytes(std::span(m.bytes))});
    for (Message& m : received) in.push_back({m.partner, m.tag, std::as_writable_bytes(std::span(m.bytes))});
    ranks.start(out, in);
    ranks.wait();
    for (const Message& m : received) checks.compare(m.bytes, known_bytes(m.bytes.size(), m.partner, own_rank, m.tag));
}

int check_all(Ranks& ranks) {
    Checks checks;
    for (const std::size_t size : kSizes) {
        check_broadcast(ranks, size, checks);
        check_gathers(ranks, size, checks);
        check_neighbours(ranks, size, checks);
        ranks.poll_failures();
    }
    std::uint32_t failures = 0;
    for (const std::uint32_t rank_failures : ranks.all_gather(checks.failures)) failures += rank_failures;
    if (ranks.is_first())
        fmt::print("{} on {} ranks: {} checks in each, {} wrong\n", ranks.library(), ranks.count(), checks.count,
                   failures);
    return ranks.close(failures == 0 ? 0 : 1);
}

}  // namespace
}  // namespace raya

// Usage: transport_check PROGRAM. PROGRAM is the path of raya, whose folder contains raya_mpi.so.
int main(int argc, char** argv) {
    constexpr double kTimeLimit_s = 60;
    if (argc > 1) raya::set_program_file(argv[1]);
    auto* const make_transport =
        reinterpret_cast<raya::MakeMpiTransport*>(raya::module_function(raya::kMpiModule, raya::kMakeMpiTransport));
    raya::Ranks ranks{std::unique_ptr<raya::Transport>(make_transport(kTimeLimit_s))};
    return raya::check_all(ranks);
}
