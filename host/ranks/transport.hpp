// Interface for the transfer of bytes between ranks. Implementations: MPI in a loadable module, threads in tests, a
// stub for a single rank.
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

/// A message to send to rank `to`. `tag` distinguishes messages between the same two ranks.
struct Outgoing {
    std::uint32_t to = 0;
    int tag = 0;  // 0..32767
    std::span<const std::byte> bytes{};
};

/// A message to receive from rank `from`. `bytes` must have exactly the size of the message.
struct Incoming {
    std::uint32_t from = 0;
    int tag = 0;
    std::span<std::byte> bytes{};
};

/// Thrown by waiting calls if another rank has failed or does not answer. The text names rank and host; `code` is the
/// exit code.
struct RankFailure : std::runtime_error {
    RankFailure(const std::string& text, int exit_code) : std::runtime_error(text), code(exit_code) {}
    int code;
};

/// Seconds that a failed rank waits before its report. The delay increases with the rank, so that if several ranks
/// fail, only the first one reports and ends all ranks.
inline double failure_delay_s(std::uint32_t rank) {
    constexpr double kDelayPerRank = 0.25, kMaxDelay = 3;
    return std::min(kDelayPerRank * rank, kMaxDelay);
}

/// All ranks must make the same collective calls in the same order, each from one thread. Every wait has a time limit,
/// after which it throws RankFailure.
class Transport {
  public:
    virtual ~Transport() = default;

    virtual std::uint32_t rank() const = 0;   // 0 .. count() - 1
    virtual std::uint32_t count() const = 0;  // number of ranks, >= 1
    virtual std::string host() const = 0;     // the name of this rank's host
    virtual std::string library() const = 0;  // name and version, for messages and reports

    /// Collective: copies the bytes of rank 0 to all ranks. The size must be the same in all ranks.
    virtual void broadcast(std::span<std::byte> bytes) = 0;

    /// Collective: concatenates the bytes of all ranks, in each rank. sizes[rank]: number of bytes of a rank; at most
    /// 2^31 - 1 in total.
    virtual void all_gather(std::span<const std::byte> own, std::span<std::byte> all,
                            std::span<const std::size_t> sizes) = 0;

    /// Starts non-blocking messages; wait() waits until they are complete. The buffers must stay valid, and no other
    /// function may be called, until wait() has returned.
    virtual void start(std::span<const Outgoing> out, std::span<const Incoming> in) = 0;
    virtual void wait() = 0;

    /// Throws RankFailure in rank 0 if another rank has reported one; does not block.
    virtual void poll_failures() = 0;

    /// Reports an error of this rank to rank 0, which prints it and ends all ranks. Returns after some seconds if rank
    /// 0 has not ended this rank.
    virtual void report_failure(const std::string& text, int code) = 0;

    /// Ends the processes of all ranks with that exit code.
    [[noreturn]] virtual void abort(int code) = 0;

    /// Ends the communication. Must be the last call.
    virtual void close() = 0;
};

/// Type of the module's function that starts MPI. A wait of more than `limit_s` seconds throws RankFailure. The caller
/// owns the result.
using OpenMpi = Transport*(double limit_s);

inline constexpr const char *kMpiModule = "raya_mpi", *kOpenMpi = "raya_open_mpi";

/// Time limit for calls that have none, such as MPI_Init and MPI_Finalize. If the object is not destroyed within
/// `limit_s` seconds, it prints `text` on stderr and ends the process with `code`.
class Deadline {
  public:
    Deadline(double limit_s, std::string text, int code)
        : watch_([this, limit_s, text = std::move(text), code] {
              std::unique_lock lock(mutex_);
              if (ended_.wait_for(lock, std::chrono::duration<double>(limit_s), [this] { return cancelled_; })) return;
              if (!text.empty() && ::write(STDERR_FILENO, text.data(), text.size()) < 0) std::_Exit(code);
              std::_Exit(code);
          }) {}
    ~Deadline() {
        {
            const std::lock_guard lock(mutex_);
            cancelled_ = true;
        }
        ended_.notify_one();
        watch_.join();
    }
    Deadline(const Deadline&) = delete;
    Deadline& operator=(const Deadline&) = delete;

  private:
    std::mutex mutex_{};
    std::condition_variable ended_{};
    bool cancelled_ = false;
    std::thread watch_;  // declared last, because the thread uses the members above
};

}  // namespace raya
