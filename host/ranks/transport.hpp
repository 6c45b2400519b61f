// What carries bytes from rank to rank: MPI in a module of its own, threads in tests, nothing where a program runs
// alone.
#pragma once
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <mutex>
#include <span>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>

namespace raya {

/// Bytes on their way to a rank; `tag` tells those of one pair of ranks apart.
struct Outgoing {
    std::uint32_t to = 0;
    int tag = 0;  // 0..32767
    std::span<const std::byte> bytes{};
};

/// Room for bytes that a rank sends: exactly as many as it sends.
struct Incoming {
    std::uint32_t from = 0;
    int tag = 0;
    std::span<std::byte> bytes{};
};

/// Another rank has failed, or does not answer: thrown out of whatever waits. The text names rank and host; `code`: the
/// exit code that goes with it.
struct RankFailure : std::runtime_error {
    RankFailure(const std::string& text, int exit_code) : std::runtime_error(text), code(exit_code) {}
    int code;
};

/// Seconds by which a rank that has failed lets those before it speak and end all, so that of several one is heard.
inline double speaking_turn_s(std::uint32_t rank) {
    constexpr double kTurn = 0.25, kMost = 3;
    return std::min(kTurn * rank, kMost);
}

/// Calls are made by all ranks in the same order, by one thread each. Every wait has an end: RankFailure.
class Transport {
  public:
    virtual ~Transport() = default;

    virtual std::uint32_t rank() const = 0;   // 0 .. count() - 1
    virtual std::uint32_t count() const = 0;  // ranks, 1 at least
    virtual std::string host() const = 0;     // the name of this rank's host
    virtual std::string library() const = 0;  // name and version, for messages and reports

    /// Bytes of rank 0 to all, of the same number in each.
    virtual void broadcast(std::span<std::byte> bytes) = 0;

    /// What all ranks have, one after another, to each; `sizes` [rank]: bytes of each, 2^31 together at most.
    virtual void all_gather(std::span<const std::byte> own, std::span<std::byte> all,
                            std::span<const std::size_t> sizes) = 0;

    /// Begins to send and to receive, and returns; wait() is called before the next call of any kind, and until then
    /// the bytes stay where they are.
    virtual void start(std::span<const Outgoing> out, std::span<const Incoming> in) = 0;
    virtual void wait() = 0;

    /// Throws RankFailure in rank 0 where another rank has told of one, and does not wait: for a rank that computes.
    virtual void look() = 0;

    /// Tells rank 0 what went wrong here, so that it says so and ends all; returns after some seconds if it does not.
    virtual void report_failure(const std::string& text, int code) = 0;

    /// Ends the processes of all ranks with that exit code.
    [[noreturn]] virtual void abort(int code) = 0;

    /// Nothing is called behind it.
    virtual void close() = 0;
};

/// Starts MPI. A wait of more than `limit_s` seconds ends with RankFailure. The caller owns what is returned.
using OpenMpi = Transport*(double limit_s);

inline constexpr const char *kMpiModule = "raya_mpi", *kOpenMpi = "raya_open_mpi";

/// An end for calls that have none of their own, such as MPI's beginning and its end.
/// Ends the process with `code` where it lives longer than `limit_s` seconds, and says `text` on stderr before; empty:
/// nothing.
class Deadline {
  public:
    Deadline(double limit_s, std::string text, int code)
        : watch_([this, limit_s, text = std::move(text), code] {
              std::unique_lock lock(mutex_);
              if (ended_.wait_for(lock, std::chrono::duration<double>(limit_s), [this] { return over_; })) return;
              if (!text.empty() && ::write(STDERR_FILENO, text.data(), text.size()) < 0) std::_Exit(code);  // unheard
              std::_Exit(code);
          }) {}
    ~Deadline() {
        {
            const std::lock_guard lock(mutex_);
            over_ = true;
        }
        ended_.notify_one();
        watch_.join();
    }
    Deadline(const Deadline&) = delete;
    Deadline& operator=(const Deadline&) = delete;

  private:
    std::mutex mutex_{};
    std::condition_variable ended_{};
    bool over_ = false;
    std::thread watch_;  // last: it uses the others
};

}  // namespace raya
