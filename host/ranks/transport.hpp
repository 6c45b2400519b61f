// Interface for the transfer of bytes between ranks. Its implementations are the MPI module raya_mpi.so, threads in
// tests, and a stub for a single rank.
#pragma once
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <span>
#include <stdexcept>
#include <string>
#include <thread>

#include "host/base/parallel.hpp"

namespace raya {

/// A message to another rank. `tag` distinguishes messages between the same two ranks.
struct OutgoingMessage {
    std::uint32_t receiver = 0;  // rank
    int tag = 0;                 // 0..32767
    std::span<const std::byte> bytes{};
};

/// A message from another rank. `bytes`: destination, which must have exactly the size of the message.
struct IncomingMessage {
    std::uint32_t sender = 0;  // rank
    int tag = 0;
    std::span<std::byte> bytes{};
};

/// Thrown by a call that waits for another rank, if a rank has failed or does not answer. The text names the rank and
/// its host; `code` is the exit code of raya.
struct RankFailure : std::runtime_error {
    RankFailure(const std::string& text, int exit_code) : std::runtime_error(text), code(exit_code) {}
    int code;
};

/// Returns the time by which a failed rank delays the end of its process. The time increases with the rank, so that if
/// several ranks fail, only the lowest of the failed ranks ends all ranks.
inline double failure_delay_s(std::uint32_t rank) {
    constexpr double kDelayPerRank_s = 0.25, kMaxDelay_s = 3;
    return std::min(kDelayPerRank_s * rank, kMaxDelay_s);
}

/// Transfer of bytes between ranks. All ranks must make the same collective calls in the same order. Each rank must
/// make its calls from one thread. A call that waits longer than a time limit throws RankFailure. The functions of this
/// class are those of a single rank, for which communication is a no-op.
class Transport {
  public:
    virtual ~Transport() = default;

    virtual std::uint32_t rank() const { return 0; }    // 0 .. count() - 1
    virtual std::uint32_t count() const { return 1; }   // number of ranks, >= 1
    virtual std::string host() const { return {}; }     // name of this rank's host
    virtual std::string library() const { return {}; }  // name and version of the MPI library, for messages and reports

    /// Collective: copies the bytes of rank 0 to all ranks. The size must be the same in all ranks.
    virtual void broadcast(std::span<std::byte> /*bytes*/) {}

    /// Collective: writes the bytes of all ranks to `all_bytes` of each rank, concatenated in the order of ranks.
    /// sizes[rank]: number of bytes of that rank. The sum of `sizes` must be at most 2^31 - 1.
    virtual void all_gather(std::span<const std::byte> own_bytes, std::span<std::byte> all_bytes,
                            std::span<const std::size_t> /*sizes*/) {
        std::copy(own_bytes.begin(), own_bytes.end(), all_bytes.begin());
    }

    /// Starts non-blocking messages; wait() waits until they are complete. The buffers must stay valid, and no other
    /// function may be called, until wait() has returned.
    virtual void start(std::span<const OutgoingMessage> /*out*/, std::span<const IncomingMessage> /*in*/) {}
    virtual void wait() {}

    /// Throws RankFailure in rank 0 if another rank has reported a failure; does not block.
    virtual void poll_failures() {}

    /// Reports an error of this rank to rank 0, which prints it and ends all ranks. Returns after some seconds if rank
    /// 0 has not ended this rank.
    virtual void report_failure(const std::string& /*text*/, int /*code*/) {}

    /// Ends the processes of all ranks with exit code `code`.
    [[noreturn]] virtual void abort(int code) { std::exit(code); }

    /// Ends the communication. Must be the last call.
    virtual void close() {}
};

/// Type of the function `kMakeMpiTransport` in raya_mpi.so. The function starts MPI and returns the transport, which
/// the caller owns. `limit_s`: time limit of each wait for other ranks.
using MakeMpiTransport = Transport*(double limit_s);

inline constexpr const char *kMpiModule = "raya_mpi", *kMakeMpiTransport = "raya_make_mpi_transport";

/// Time limit for calls that have no time limit themselves, such as MPI_Init and MPI_Finalize. Unless the returned
/// object is destroyed within `limit_s` seconds, prints `text` on stderr and ends the process with exit code `code`.
[[nodiscard]] inline std::jthread deadline(double limit_s, const std::string& text, int code) {
    return call_after(limit_s, [text, code] {
        std::fputs(text.c_str(), stderr);
        std::_Exit(code);
    });
}

}  // namespace raya
