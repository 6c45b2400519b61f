#include "host/ranks/ranks.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>

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

}  // namespace raya
