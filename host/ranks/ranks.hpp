// Ranks: the processes that together compute one render, each on its own device. Without a launcher there is a single
// rank.
#pragma once
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "host/base/members.hpp"
#include "host/ranks/transport.hpp"

namespace raya {

template <class T>
concept Sendable = std::is_trivially_copyable_v<T>;

/// Numbers of messages and bytes that a rank has sent, and the time for which it has waited in communication calls. A
/// broadcast counts as one message of rank 0, an all-gather as one message of each rank.
struct RankTraffic {
    std::uint64_t messages = 0, bytes = 0;
    double waiting_s = 0;

    RankTraffic operator-(const RankTraffic& before) const {
        return {messages - before.messages, bytes - before.bytes, waiting_s - before.waiting_s};
    }
};

/// Communication among ranks. All ranks must make the same collective calls in the same order. With a single rank,
/// communication is a no-op.
class Ranks {
  public:
    /// Returns the single rank of a program that was started without a launcher.
    static Ranks& single();

    /// Collective: determines which ranks run on the same host.
    explicit Ranks(std::unique_ptr<Transport> transport);

    std::uint32_t rank() const { return rank_; }
    std::uint32_t count() const { return count_; }
    bool is_first() const { return rank_ == 0; }  // rank 0 prints, and reads and writes files
    bool has_several() const { return count_ > 1; }
    std::uint32_t rank_on_host() const { return rank_on_host_; }    // index of this rank among the ranks of its host
    std::uint32_t ranks_on_host() const { return ranks_on_host_; }  // number of ranks of this host
    std::string host() const { return transport_->host(); }
    std::string library() const { return transport_->library(); }

    /// Collective: replaces the value, vector or text in every rank by that of rank 0.
    template <Sendable T>
    void broadcast(T& value) {
        broadcast_bytes(std::as_writable_bytes(std::span(&value, 1)));
    }
    template <Sendable T>
    void broadcast(std::vector<T>& values) {
        std::uint64_t size = values.size();
        broadcast(size);
        values.resize(static_cast<std::size_t>(size));
        broadcast_bytes(std::as_writable_bytes(std::span(values)));
    }
    void broadcast(std::string& text);

    /// Collective: returns the elements of all ranks, concatenated in the order of ranks.
    template <Sendable T>
    std::vector<T> all_gather(std::span<const T> own_elements) {
        return all_gather(own_elements, all_gather(own_elements.size()));
    }
    template <Sendable T>
    std::vector<T> all_gather(const T& own_element) {
        return all_gather(std::span(&own_element, 1), std::vector<std::size_t>(count_, 1));
    }
    /// This overload sends no sizes, because the caller passes them. sizes[rank]: number of elements of the rank.
    template <Sendable T>
    std::vector<T> all_gather(std::span<const T> own_elements, std::vector<std::size_t> sizes) {
        std::size_t total_elements = 0;
        for (std::size_t& size : sizes) total_elements += std::exchange(size, size * sizeof(T));
        std::vector<T> gathered(total_elements);
        gather_bytes(std::as_bytes(own_elements), std::as_writable_bytes(std::span(gathered)), sizes);
        return gathered;
    }
    /// Collective: returns the elements of all ranks in rank 0, and an empty vector in other ranks. Unlike
    /// all_gather(), gather() can return more than 2^31 bytes. sizes[rank]: number of elements of the rank.
    template <Sendable T>
    std::vector<T> gather(std::span<const T> own_elements, const std::vector<std::size_t>& sizes) {
        if (!is_first()) {
            send(0, own_elements);
            return {};
        }
        std::vector<T> gathered(own_elements.begin(), own_elements.end());
        for (std::uint32_t rank = 1; rank < count_; ++rank) {
            gathered.resize(gathered.size() + sizes[rank]);
            receive(rank, std::span(gathered).last(sizes[rank]));
        }
        return gathered;
    }
    /// Collective: returns the texts of all ranks in rank 0, and an empty vector in other ranks.
    std::vector<std::string> gather(const std::string& text);

    /// Sends elements to a rank, which must receive the same number of elements.
    template <Sendable T>
    void send(std::uint32_t receiver, std::span<const T> values) {
        const OutgoingMessage out{receiver, kDataTag, std::as_bytes(values)};
        start({&out, 1}, {});
        wait();
    }
    template <Sendable T>
    void receive(std::uint32_t sender, std::span<T> values) {
        const IncomingMessage in{sender, kDataTag, std::as_writable_bytes(values)};
        start({}, {&in, 1});
        wait();
    }

    /// Starts several non-blocking messages, and waits for them (see Transport).
    void start(std::span<const OutgoingMessage> out, std::span<const IncomingMessage> in);
    void wait();

    /// Throws RankFailure in rank 0 if another rank has failed. To be called during long computations.
    void poll_failures() { transport_->poll_failures(); }

    /// Collective: calls work() first in one rank of each host, then in the remaining ranks, which find the first
    /// ranks' results in caches on disk. Returns when all ranks have finished.
    template <std::invocable Work>
    void one_rank_per_host_first(Work&& work) {
        for (const bool first_on_host : {true, false}) {
            if ((rank_on_host_ == 0) == first_on_host) work();
            all_gather('\0');
        }
    }

    const RankTraffic& traffic() const { return traffic_; }

    /// With several ranks, rank 0 prints the error of this rank and ends all ranks with exit code `code`.
    /// With a single rank, prints the error and returns the code.
    int fail(const std::string& text, int code);

    /// Prints a failure that another rank has reported, and ends all ranks with the failure's exit code.
    int fail(const RankFailure& failure);

    /// Collective: closes the transport and returns the maximum of all exit codes.
    int close(int code);

  private:
    int abort_all(const std::string& message, int code);
    static constexpr int kDataTag = 0;

    void broadcast_bytes(std::span<std::byte> bytes);
    void gather_bytes(std::span<const std::byte> own_bytes, std::span<std::byte> all_bytes,
                      std::span<const std::size_t> sizes);
    template <class Call>
    void measure_wait(Call&& call);

    std::unique_ptr<Transport> transport_;
    std::uint32_t rank_, count_;
    std::uint32_t rank_on_host_ = 0, ranks_on_host_ = 0;
    RankTraffic traffic_;
};

/// Clock offset of a rank: the rank's time plus offset_ns is rank 0's time, with an error of at most uncertainty_ns.
struct RankClock {
    std::int64_t offset_ns = 0;
    std::uint64_t uncertainty_ns = 0;
};

/// Collective: measures this rank's clock offset as NTP does (D. L. Mills 1991). Each rank in turn requests the time of
/// rank 0 repeatedly and uses the answer with the shortest round trip. Later drift of the clocks is not corrected.
/// `now`: returns this rank's time in nanoseconds.
RankClock rank_clock(Ranks& ranks, const std::function<std::uint64_t()>& now);

// Detection of an MPI launcher (mpirun, srun, ...), and start of the ranks.

/// Rank of this process and number of ranks, which a launcher has set in environment variables.
struct Launch {
    std::uint32_t rank = 0;
    std::optional<std::uint32_t> count;  // number of ranks; empty if the launcher does not set it
};

/// Returns rank and number of ranks, or empty if no launcher has started this process.
std::optional<Launch> find_launch();

/// Connects the ranks if a launcher has started more than one, else returns nullptr. Sets the environment variable
/// POCL_MAX_PTHREAD_COUNT to threads_of_rank(), unless the user has set it. So open_ranks() must be called before
/// OpenCL is used. Throws UserError in every process if raya was built without MPI, or with a different MPI than that
/// of the launcher.
std::unique_ptr<Ranks> open_ranks();

/// Collective: throws UserError if this rank runs a different version of raya than rank 0, or has different arguments.
void check_same_program(Ranks& ranks, const std::vector<std::string>& arguments);

/// Returns the number of threads, at least 1, for a rank's OpenCL CPU device. `usable_cores`: number of cores to which
/// the process is bound. Returns `usable_cores` if it is less than `host_cores`, else `host_cores` / `ranks_of_host`.
std::uint32_t threads_of_rank(std::uint32_t usable_cores, std::uint32_t host_cores, std::uint32_t ranks_of_host);

}  // namespace raya
