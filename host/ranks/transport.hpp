// What carries bytes from rank to rank: MPI in a module of its own, threads in tests, nothing where a program runs
// alone.
#pragma once
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <stdexcept>
#include <string>

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

}  // namespace raya
