#include "host/ranks/ranks.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <limits>

#include "host/base/interruption.hpp"
#include "host/base/log.hpp"

namespace raya {

Ranks& Ranks::single() {
    static Ranks single_rank(std::make_unique<Transport>());
    return single_rank;
}

Ranks::Ranks(std::unique_ptr<Transport> transport)
    : transport_(std::move(transport)), rank_(transport_->rank()), count_(transport_->count()) {
    constexpr std::size_t kMaxNameBytes = 256;
    std::array<char, kMaxNameBytes> own_host{};
    host().copy(own_host.data(), kMaxNameBytes);
    const std::vector<std::array<char, kMaxNameBytes>> hosts = all_gather(own_host);
    for (std::uint32_t rank = 0; rank < count_; ++rank) {
        if (hosts[rank] != own_host) continue;
        rank_on_host_ += rank < rank_;
        ++ranks_on_host_;
    }
}

void Ranks::broadcast(std::string& text) {
    std::vector<char> characters(text.begin(), text.end());
    broadcast(characters);
    text.assign(characters.begin(), characters.end());
}

std::vector<std::string> Ranks::gather(const std::string& text) {
    const std::vector<std::size_t> sizes = all_gather(text.size());
    const std::vector<char> characters = gather(std::span<const char>(text), sizes);
    std::vector<std::string> texts;
    auto begin = characters.begin();
    for (std::size_t rank = 0; rank < (is_first() ? sizes.size() : 0); ++rank) {
        const auto end = begin + static_cast<std::ptrdiff_t>(sizes[rank]);
        texts.emplace_back(begin, end);
        begin = end;
    }
    return texts;
}

template <class Call>
void Ranks::measure_wait(Call&& call) {
    const Clock::time_point start = Clock::now();
    call();
    traffic_.waiting_s += seconds_since(start);
}

void Ranks::broadcast_bytes(std::span<std::byte> bytes) {
    traffic_.messages += has_several() && is_first();
    traffic_.bytes += has_several() && is_first() ? bytes.size() : 0;
    measure_wait([&] { transport_->broadcast(bytes); });
}

void Ranks::gather_bytes(std::span<const std::byte> own_bytes, std::span<std::byte> all_bytes,
                         std::span<const std::size_t> sizes) {
    traffic_.messages += has_several();
    traffic_.bytes += has_several() ? own_bytes.size() : 0;
    measure_wait([&] { transport_->all_gather(own_bytes, all_bytes, sizes); });
}

void Ranks::start(std::span<const OutgoingMessage> out, std::span<const IncomingMessage> in) {
    traffic_.messages += out.size();
    for (const OutgoingMessage& message : out) traffic_.bytes += message.bytes.size();
    transport_->start(out, in);
}

void Ranks::wait() {
    measure_wait([&] { transport_->wait(); });
}

int Ranks::fail(const std::string& text, int code) {
    if (!has_several()) {
        print_log(fmt::format("raya: {}\n", text));
        return code;
    }
    return abort_all(fmt::format("rank {} on {}: {}", rank_, host(), text), code);
}

int Ranks::fail(const RankFailure& failure) { return abort_all(failure.what(), failure.code); }

int Ranks::abort_all(const std::string& message, int code) {
    if (!is_first()) transport_->report_failure(message, code);
    suppress_interrupt_message();  // mpirun ends this rank too, by a signal that is not a Ctrl-C
    print_log(fmt::format("raya: {}\n", message));
    transport_->abort(code);
    return code;
}

int Ranks::close(int code) {
    const std::vector<int> codes = all_gather(code);
    const int highest_code = *std::max_element(codes.begin(), codes.end());
    // As soon as a rank has ended with another code than 0, mpirun interrupts the others.
    if (has_several() && highest_code != 0) suppress_interrupt_message();
    transport_->close();
    return highest_code;
}

RankClock rank_clock(Ranks& ranks, const std::function<std::uint64_t()>& now) {
    constexpr int kRequests = 16;
    char request = 0;
    std::uint64_t time = 0;
    if (ranks.is_first()) {
        for (std::uint32_t rank = 1; rank < ranks.count(); ++rank)
            for (int i = 0; i < kRequests; ++i) {
                ranks.receive(rank, std::span(&request, 1));
                time = now();
                ranks.send(rank, std::span<const std::uint64_t>(&time, 1));
            }
        return {};
    }
    RankClock best_clock{0, UINT64_MAX};
    for (int i = 0; i < kRequests; ++i) {
        const std::uint64_t before = now();
        ranks.send(0, std::span<const char>(&request, 1));
        ranks.receive(0, std::span(&time, 1));
        const std::uint64_t half_trip_ns = (now() - before) / 2;
        if (half_trip_ns < best_clock.uncertainty_ns)
            best_clock = {static_cast<std::int64_t>(time - (before + half_trip_ns)), half_trip_ns};
    }
    return best_clock;
}

namespace {

// Lengths of the messages. The shortest has one byte, because the transport does not send empty messages.
constexpr std::uint64_t kMessageBytes[] = {1, 64, 1 << 10, 4 << 10, 16 << 10, 64 << 10, 256 << 10, 1 << 20, 4 << 20};

// Measures messages between rank 0 and `partner`. In rank 0, returns half of the minimum round-trip time; the result is
// not valid in other ranks.
MessageTime message_time(Ranks& ranks, std::uint32_t partner, std::uint64_t bytes) {
    if (!ranks.is_first() && ranks.rank() != partner) return {bytes, 0};
    const int repetitions = bytes <= (64 << 10) ? 300 : 20;  // all messages together have at most 1 GB
    std::vector<std::byte> block(bytes);
    double round_trip_s = std::numeric_limits<double>::max();
    for (int i = 0; i < repetitions; ++i) {
        const Clock::time_point start = Clock::now();
        if (ranks.is_first()) ranks.send(partner, std::span<const std::byte>(block));
        ranks.receive(ranks.is_first() ? partner : 0, std::span(block));
        if (!ranks.is_first()) ranks.send(0, std::span<const std::byte>(block));
        round_trip_s = std::min(round_trip_s, seconds_since(start));
    }
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

void members_of(Members& m, const MessageTime& time) {
    m("bytes", time.bytes, "Size of the data that a rank sends, bytes.");
    m("seconds", time.seconds, "Time of the message, minimum over many repetitions, s.");
}

void members_of(Members& m, const PingReport& report) {
    m("kind", "raya ping", "Identifies the report: `raya ping`.");
    m("library", report.library, "MPI library and version.");
    m("partner", report.partner, "Rank that exchanges messages with rank 0: the first on another host, else 1.");
    m("messages", report.messages, "One-way times between rank 0 and `partner`.");
    m("alpha_s", report.network.alpha_s, "Latency of a message, s, fitted to `messages` (Hockney 1994).");
    m("beta_s_per_byte", report.network.beta_s, "Additional time per byte of a message, s, fitted to `messages`.");
}

}  // namespace raya
