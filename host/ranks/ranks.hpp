// Ranks: the processes that share a render, each with its own device. A program started alone has a single rank.
#pragma once
#include <concepts>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "host/ranks/transport.hpp"

namespace raya {

template <class T>
concept Sendable = std::is_trivially_copyable_v<T>;

/// Traffic that a rank has sent, and its waiting time. A broadcast counts as one message of rank 0, an all-gather as
/// one message of each rank.
struct RankTraffic {
    std::uint64_t messages = 0, bytes = 0;
    double waiting_s = 0;

    RankTraffic operator-(const RankTraffic& before) const {
        return {messages - before.messages, bytes - before.bytes, waiting_s - before.waiting_s};
    }
};

/// Communication among ranks. Collective calls must be made by all ranks in the same order. With a single rank they do
/// nothing.
class Ranks {
  public:
    /// A single rank.
    static Ranks& alone();

    /// Collective: finds the ranks that share a host.
    explicit Ranks(std::unique_ptr<Transport> transport);

    std::uint32_t rank() const { return rank_; }
    std::uint32_t count() const { return count_; }
    bool first() const { return rank_ == 0; }  // rank 0 reads, prints and writes
    bool many() const { return count_ > 1; }
    std::uint32_t on_host() const { return on_host_; }  // index of this rank among those of its host
    std::uint32_t of_host() const { return of_host_; }  // number of ranks of this host
    std::string host() const { return transport_->host(); }
    std::string library() const { return transport_->library(); }

    /// Sends a value, a vector or a text of rank 0 to all ranks.
    template <Sendable T>
    void broadcast(T& value) {
        broadcast_bytes(std::as_writable_bytes(std::span(&value, 1)));
    }
    template <Sendable T>
    void broadcast(std::vector<T>& values) {
        std::uint64_t size = values.size();
        broadcast(size);
        values.resize(size);
        broadcast_bytes(std::as_writable_bytes(std::span(values)));
    }
    void broadcast(std::string& text);

    /// Returns the elements of all ranks, in the order of ranks.
    template <Sendable T>
    std::vector<T> all_gather(std::span<const T> own) {
        return all_gather(own, all_sizes(own.size()));
    }
    template <Sendable T>
    std::vector<T> all_gather(const T& own) {
        return all_gather(std::span(&own, 1), std::vector<std::size_t>(count_, 1));
    }
    /// `sizes` [rank]: number of elements.
    template <Sendable T>
    std::vector<T> all_gather(std::span<const T> own, std::vector<std::size_t> sizes) {
        std::size_t all = 0;
        for (std::size_t& size : sizes) all += std::exchange(size, size * sizeof(T));
        std::vector<T> gathered(all);
        gather_bytes(std::as_bytes(own), std::as_writable_bytes(std::span(gathered)), sizes);
        return gathered;
    }
    /// The same in rank 0 only, for large data; empty in other ranks.
    template <Sendable T>
    std::vector<T> gather(std::span<const T> own, const std::vector<std::size_t>& sizes) {
        if (!first()) {
            send(0, own);
            return {};
        }
        std::vector<T> gathered(own.begin(), own.end());
        for (std::uint32_t rank = 1; rank < count_; ++rank) {
            gathered.resize(gathered.size() + sizes[rank]);
            receive(rank, std::span(gathered).last(sizes[rank]));
        }
        return gathered;
    }
    std::vector<std::string> gather(const std::string& text);

    /// Sends elements to one rank, which must receive the same number.
    template <Sendable T>
    void send(std::uint32_t to, std::span<const T> values) {
        const Outgoing out{to, kPlainTag, std::as_bytes(values)};
        start({&out, 1}, {});
        wait();
    }
    template <Sendable T>
    void receive(std::uint32_t from, std::span<T> values) {
        const Incoming in{from, kPlainTag, std::as_writable_bytes(values)};
        start({}, {&in, 1});
        wait();
    }

    /// Several messages at once (see Transport).
    void start(std::span<const Outgoing> out, std::span<const Incoming> in);
    void wait();

    /// Throws RankFailure in rank 0 if another rank has failed. To be called during long computations.
    void poll_failures() { transport_->poll_failures(); }

    /// Does the work in one rank of each host, then in the others, so that these find its results in caches. Returns
    /// when all ranks have done it.
    template <std::invocable Work>
    void one_first_on_each_host(Work&& work) {
        if (on_host_ == 0) work();
        wait_for_first_on_host();
        if (on_host_ > 0) work();
        all_gather('\0');
    }

    const RankTraffic& traffic() const { return traffic_; }

    /// Prints the error of this rank once and ends all ranks with the code. With a single rank, returns the code.
    int fail(const std::string& text, int code);

    /// The same for a failure of another rank.
    int fail(const RankFailure& failure);

    /// Collective: closes the transport and returns the maximum of all exit codes.
    int close(int code);

  private:
    int end_all(const std::string& whole, int code);
    static constexpr int kPlainTag = 0, kHostTag = 1;

    void broadcast_bytes(std::span<std::byte> bytes);
    void gather_bytes(std::span<const std::byte> own, std::span<std::byte> all, std::span<const std::size_t> sizes);
    std::vector<std::size_t> all_sizes(std::size_t own);
    void find_host();
    void wait_for_first_on_host();
    template <class Call>
    void timed(Call&& call);

    std::unique_ptr<Transport> transport_;
    std::uint32_t rank_, count_;
    std::uint32_t on_host_ = 0, of_host_ = 1;
    std::vector<std::uint32_t> host_ranks_;  // of this host, ascending
    RankTraffic traffic_;
};

/// Adding `offset_ns` to a time of this rank gives rank 0's time, with an error of at most `uncertainty_ns`.
struct RankClock {
    std::int64_t offset_ns = 0;
    std::uint64_t uncertainty_ns = 0;
};

/// Synchronises clocks as NTP does (D. L. Mills 1991): each rank in turn asks rank 0 for its time repeatedly and takes
/// the answer with the shortest round trip. Later drift of the clocks is not corrected. `now`: nanoseconds.
RankClock rank_clock(Ranks& ranks, const std::function<std::uint64_t()>& now);

}  // namespace raya
