// Checks every call of the MPI transport with known bytes, for messages from empty to larger than MPI's eager limit.
// Runs under mpirun, also with Valgrind or sanitizers: they find little in a whole render, most of which runs inside an
// OpenCL driver.
#include <fmt/core.h>

#include <memory>
#include <vector>

#include "host/base/module.hpp"
#include "host/ranks/ranks.hpp"
#include "host/ranks/transport.hpp"

namespace raya {
namespace {

constexpr std::size_t kSizes[] = {0, 1, 3, 1000, 65'536, (1 << 20) + 1, 5 << 20};
constexpr int kTags = 4;

using Bytes = std::vector<std::uint8_t>;

/// The bytes that `rank` sends to `to` with a tag. They differ between ranks, tags and neighbouring bytes.
Bytes known_bytes(std::size_t size, std::uint32_t rank, std::uint32_t to, int tag) {
    Bytes bytes(size);
    for (std::size_t i = 0; i < size; ++i)
        bytes[i] = static_cast<std::uint8_t>((i * 37 + i / 251) ^ (rank * 59 + to * 17 + static_cast<unsigned>(tag)));
    return bytes;
}

struct Checks {
    std::uint32_t done = 0, wrong = 0;

    void same(const Bytes& got, const Bytes& expected) {
        ++done;
        wrong += got != expected;
    }
};

void check_broadcast(Ranks& ranks, std::size_t size, Checks& checks) {
    const Bytes expected = known_bytes(size, 0, 0, 0);
    Bytes bytes = ranks.first() ? expected : Bytes();
    ranks.broadcast(bytes);
    checks.same(bytes, expected);
}

// Every third rank contributes no bytes.
void check_gathers(Ranks& ranks, std::size_t size, Checks& checks) {
    const auto bytes_of = [size](std::uint32_t rank) { return known_bytes(size * (rank % 3), rank, 0, 0); };
    Bytes expected;
    std::vector<std::size_t> sizes;
    for (std::uint32_t rank = 0; rank < ranks.count(); ++rank) {
        const Bytes bytes = bytes_of(rank);
        expected.insert(expected.end(), bytes.begin(), bytes.end());
        sizes.push_back(bytes.size());
    }
    const Bytes own = bytes_of(ranks.rank());
    const std::span<const std::uint8_t> span(own);
    checks.same(ranks.all_gather(span), expected);
    checks.same(ranks.gather(span, sizes), ranks.first() ? expected : Bytes());
}

// Sends to both neighbours in a ring of ranks concurrently, with several tags that are received in reverse order. With
// two ranks, both neighbours are the same rank; a single rank sends to itself.
void check_neighbours(Ranks& ranks, std::size_t size, Checks& checks) {
    const std::uint32_t count = ranks.count(), own = ranks.rank();
    struct Message {
        std::uint32_t partner;
        int tag;
        Bytes bytes;
    };
    std::vector<Message> sent, received;
    for (int tag = 0; tag < kTags; ++tag) {
        const std::uint32_t step = tag % 2 == 0 ? 1 : count - 1;
        const std::uint32_t to = (own + step) % count, from = (own + count - step) % count;
        const std::size_t bytes = size + static_cast<std::size_t>(tag);
        sent.push_back({to, tag, known_bytes(bytes, own, to, tag)});
        received.insert(received.begin(), {from, tag, Bytes(bytes)});
    }
    std::vector<Outgoing> out;
    std::vector<Incoming> in;
    for (const Message& m : sent) out.push_back({m.partner, m.tag, std::as_bytes(std::span(m.bytes))});
    for (Message& m : received) in.push_back({m.partner, m.tag, std::as_writable_bytes(std::span(m.bytes))});
    ranks.start(out, in);
    ranks.wait();
    for (const Message& m : received) checks.same(m.bytes, known_bytes(m.bytes.size(), m.partner, own, m.tag));
}

int check_all(Ranks& ranks) {
    Checks checks;
    for (const std::size_t size : kSizes) {
        check_broadcast(ranks, size, checks);
        check_gathers(ranks, size, checks);
        check_neighbours(ranks, size, checks);
        ranks.poll_failures();
    }
    std::uint32_t wrong = 0;
    for (const std::uint32_t of_rank : ranks.all_gather(checks.wrong)) wrong += of_rank;
    if (ranks.first())
        fmt::print("{} on {} ranks: {} checks in each, {} wrong\n", ranks.library(), ranks.count(), checks.done, wrong);
    return ranks.close(wrong == 0 ? 0 : 1);
}

}  // namespace
}  // namespace raya

// Usage: transport_check PROGRAM. PROGRAM is raya; the MPI module is loaded from its folder.
int main(int argc, char** argv) {
    constexpr double kPatience = 60;  // seconds
    if (argc > 1) raya::set_own_file(argv[1]);
    auto* const open = reinterpret_cast<raya::OpenMpi*>(raya::module_function(raya::kMpiModule, raya::kOpenMpi));
    raya::Ranks ranks{std::unique_ptr<raya::Transport>(open(kPatience))};
    return raya::check_all(ranks);
}
