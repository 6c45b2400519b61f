#include "host/ranks/ranks.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <limits>

#include "host/base/interruption.hpp"
#include "host/base/log.hpp"

namespace raya {
namespace {

// Transport of a single rank: communication is a no-op.
class SingleRankTransport final : public Transport {
  public:
    std::uint32_t rank() const override { return 0; }
    std::uint32_t count() const override { return 1; }
    std::string host() const override { return {}; }
    std::string library() const override { return {}; }
    void broadcast(std::span<std::byte>) override {}
    void all_gather(std::span<const std::byte> own_bytes, std::span<std::byte> all_bytes,
                    std::span<const std::size_t>) override {
        std::copy(own_bytes.begin(), own_bytes.end(), all_bytes.begin());
    }
    void start(std::span<const OutgoingMessage>, std::span<const IncomingMessage>) override {}
    void wait() override {}
    void poll_failures() override {}
    void report_failure(const std::string&, int) override {}
    [[noreturn]] void abort(int code) override { std::exit(code); }
    void close() override {}
};

std::uint64_t total_bytes(std::span<const OutgoingMessage> out) {
    std::uint64_t bytes = 0;
    for (const OutgoingMessage& message : out) bytes += message.bytes.size();
    return bytes;
}

constexpr int kClockRequests = 16;

// Receives kClockRequests requests from the rank `requester`, and answers each with this rank's time.
void answer_clock_requests(Ranks& ranks, std::uint32_t requester, const std::function<std::uint64_t()>& now) {
    for (int i = 0; i < kClockRequests; ++i) {
        char request = 0;
        ranks.receive(requester, std::span(&request, 1));
        const std::uint64_t time = now();
        ranks.send(requester, std::span(&time, 1));
    }
}

// Requests rank 0's time kClockRequests times, and returns the clock offset with the minimum uncertainty.
RankClock request_clock(Ranks& ranks, const std::function<std::uint64_t()>& now) {
    RankClock best_clock{0, UINT64_MAX};
    for (int i = 0; i < kClockRequests; ++i) {
        const char request = 1;
        std::uint64_t time = 0;
        const std::uint64_t before = now();
        ranks.send(0, std::span(&request, 1));
        ranks.receive(0, std::span(&time, 1));
        const std::uint64_t half_trip_ns = (now() - before) / 2;
        if (half_trip_ns < best_clock.uncertainty_ns)
            best_clock = {static_cast<std::int64_t>(time - (before + half_trip_ns)), half_trip_ns};
    }
    return best_clock;
}

}  // namespace

Ranks& Ranks::single() {
    static Ranks single_rank(std::make_unique<SingleRankTransport>());
    return single_rank;
}

Ranks::Ranks(std::unique_ptr<Transport> transport)
    : transport_(std::move(transport)), rank_(transport_->rank()), count_(transport_->count()) {
    find_ranks_of_host();
}

void Ranks::find_ranks_of_host() {
    constexpr std::size_t kMaxNameBytes = 256;
    std::array<char, kMaxNameBytes> own_host{};
    host().copy(own_host.data(), kMaxNameBytes);
    const std::vector<std::array<char, kMaxNameBytes>> hosts = all_gather(own_host);
    for (std::uint32_t rank = 0; rank < count_; ++rank)
        if (hosts[rank] == own_host) host_ranks_.push_back(rank);
    ranks_on_host_ = static_cast<std::uint32_t>(host_ranks_.size());
    rank_on_host_ =
        static_cast<std::uint32_t>(std::find(host_ranks_.begin(), host_ranks_.end(), rank_) - host_ranks_.begin());
}

void Ranks::broadcast(std::string& text) {
    std::vector<char> characters(text.begin(), text.end());
    broadcast(characters);
    text.assign(characters.begin(), characters.end());
}

std::vector<std::string> Ranks::gather(const std::string& text) {
    const std::vector<std::size_t> sizes = sizes_of_all_ranks(text.size());
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

std::vector<std::size_t> Ranks::sizes_of_all_ranks(std::size_t own_size) { return all_gather(own_size); }

void Ranks::start(std::span<const OutgoingMessage> out, std::span<const IncomingMessage> in) {
    traffic_.messages += out.size();
    traffic_.bytes += total_bytes(out);
    transport_->start(out, in);
}

void Ranks::wait() {
    measure_wait([&] { transport_->wait(); });
}

void Ranks::wait_for_first_on_host() {
    const char done = 1;
    char received = 0;
    std::vector<OutgoingMessage> out;
    std::vector<IncomingMessage> in;
    if (rank_on_host_ == 0)
        for (std::uint32_t i = 1; i < ranks_on_host_; ++i)
            out.push_back({host_ranks_[i], kHostTag, std::as_bytes(std::span(&done, 1))});
    else
        in.push_back({host_ranks_[0], kHostTag, std::as_writable_bytes(std::span(&received, 1))});
    start(out, in);
    wait();
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
    if (!ranks.is_first()) return request_clock(ranks, now);
    for (std::uint32_t rank = 1; rank < ranks.count(); ++rank) answer_clock_requests(ranks, rank, now);
    return {};
}

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
