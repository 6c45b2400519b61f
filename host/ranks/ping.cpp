#include "host/ranks/ping.hpp"

#include <algorithm>
#include <limits>

#include "host/base/clock.hpp"

namespace raya {
namespace {

constexpr std::uint64_t kMaxPingBytes = 4 << 20;

// Lengths of the messages. The shortest has one byte, because the transport does not send empty messages.
constexpr std::uint64_t kMessageBytes[] = {1,        64,        1 << 10, 4 << 10,      16 << 10,
                                           64 << 10, 256 << 10, 1 << 20, kMaxPingBytes};
// Returns the number of repetitions of a measurement; higher for short messages. All messages together have at most
// 1 GB.
int repetitions_of(std::uint64_t bytes) { return bytes <= (64 << 10) ? 300 : 20; }

template <class Call>
double minimum_seconds(int repetitions, Call&& call) {
    double minimum = std::numeric_limits<double>::max();
    for (int i = 0; i < repetitions; ++i) {
        const Clock::time_point start = Clock::now();
        call();
        minimum = std::min(minimum, seconds_since(start));
    }
    return minimum;
}

// Measures messages between rank 0 and `partner`. In rank 0, returns half of the minimum round-trip time; the result is
// not valid in other ranks.
MessageTime message_time(Ranks& ranks, std::uint32_t partner, std::uint64_t bytes) {
    std::vector<std::byte> block(bytes);
    if (ranks.rank() != 0 && ranks.rank() != partner) return {bytes, 0};
    const double round_trip_s = minimum_seconds(repetitions_of(bytes), [&] {
        if (ranks.is_first()) ranks.send(partner, std::span<const std::byte>(block));
        ranks.receive(ranks.is_first() ? partner : 0, std::span(block));
        if (!ranks.is_first()) ranks.send(0, std::span<const std::byte>(block));
    });
    return {bytes, round_trip_s / 2};
}

}  // namespace

// Minimises the sum over the messages (b bytes, t seconds) of
//   ((alpha + beta b) / t - 1)^2
// by setting its derivatives with respect to alpha and beta to 0 and solving the two linear equations. If alpha or beta
// is negative, sets that parameter to 0 and fits only the remaining one.
Network fitted_network(std::span<const MessageTime> times) {
    double ones = 0, b = 0, bb = 0, y = 0, by = 0;  // sums of 1/t^2, b/t^2, b^2/t^2, 1/t, b/t
    for (const MessageTime& time : times) {
        const double w = 1 / time.seconds, bytes = static_cast<double>(time.bytes);
        ones += w * w;
        b += bytes * w * w;
        bb += bytes * bytes * w * w;
        y += w;
        by += bytes * w;
    }
    const double determinant = ones * bb - b * b;
    const Network solution{(y * bb - by * b) / determinant, (by * ones - y * b) / determinant};
    if (solution.alpha_s < 0) return {0, by / bb};
    if (solution.beta_s < 0) return {y / ones, 0};
    return solution;
}

PingReport ping(Ranks& ranks) {
    PingReport report;
    report.library = ranks.library();
    const std::vector<std::string> hosts = ranks.gather(ranks.host());
    report.partner = 1;
    for (std::uint32_t rank = ranks.is_first() ? ranks.count() - 1 : 0; rank > 0; --rank)
        if (hosts[rank] != hosts[0]) report.partner = rank;
    ranks.broadcast(report.partner);
    for (const std::uint64_t bytes : kMessageBytes)
        report.messages.push_back(message_time(ranks, report.partner, bytes));
    if (ranks.is_first()) report.network = fitted_network(report.messages);
    return report;
}

Json PingReport::json() const {
    Json times = Json::array();
    for (const MessageTime& time : messages) times.push_back({{"bytes", time.bytes}, {"seconds", time.seconds}});
    return {{"kind", "raya ping"}, {"library", library},         {"partner", partner},
            {"messages", times},   {"alpha_s", network.alpha_s}, {"beta_s_per_byte", network.beta_s}};
}

}  // namespace raya
