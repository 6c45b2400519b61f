// MPI transport: raya_mpi.so. raya loads this module only if an MPI launcher has started raya, so that other runs do
// not load MPI's libraries. wait() polls the requests instead of calling MPI_Wait, because MPI_Wait has no time limit
// and would not notice that another rank has failed.
#define OMPI_SKIP_MPICXX  // leaves out the C++ bindings, which MPI-3 has removed
#define MPICH_SKIP_MPICXX
#include <fmt/core.h>
#include <mpi.h>
#include <sys/prctl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <climits>
#include <cstdlib>
#include <regex>
#include <thread>
#include <vector>

#include "host/base/log.hpp"
#include "host/error.hpp"
#include "host/ranks/transport.hpp"

namespace raya {
namespace {

// Maximum number of bytes in an MPI message. Longer messages are split, because MPI's message length is an int.
constexpr std::size_t kMaxMessageBytes = std::size_t{1} << 30;
constexpr int kFailureTag = 1;  // tag of messages that report a failure to rank 0

void check_mpi(int result, const char* call) {
    if (result == MPI_SUCCESS) return;
    std::array<char, MPI_MAX_ERROR_STRING> text{};
    int length = 0;
    MPI_Error_string(result, text.data(), &length);
    throw DeviceError(fmt::format("{} failed: {}", call, text.data()));
}

// Returns the library's name and version: the start of "Open MPI v4.1.4, package: ..." or "MPICH Version: 4.0.2 ...".
std::string library_name() {
    std::array<char, MPI_MAX_LIBRARY_VERSION_STRING> text{};
    int length = 0;
    MPI_Get_library_version(text.data(), &length);
    const std::string name = std::regex_replace(text.data(), std::regex("[,\n].*|\\s+$"), "");
    return std::regex_replace(name, std::regex("\\s+"), " ");
}

class MpiTransport final : public Transport {
  public:
    explicit MpiTransport(double limit_s) : limit_s_(limit_s) {
        int provided = 0;
        check_mpi(MPI_Init_thread(nullptr, nullptr, MPI_THREAD_FUNNELED, &provided), "MPI_Init_thread");
        for (MPI_Comm* comm : {&data_comm_, &failure_comm_}) {
            check_mpi(MPI_Comm_dup(MPI_COMM_WORLD, comm), "MPI_Comm_dup");
            check_mpi(MPI_Comm_set_errhandler(*comm, MPI_ERRORS_RETURN), "MPI_Comm_set_errhandler");
        }
        ::prctl(PR_SET_TIMERSLACK, 1);  // 1 ns: by default Linux may extend each sleep by 50 us
        MPI_Comm_rank(data_comm_, &rank_);
        MPI_Comm_size(data_comm_, &count_);
        spin_s_ = ranks_of_host() > ::sysconf(_SC_NPROCESSORS_ONLN) ? 30e-6 : 300e-6;
        std::array<char, HOST_NAME_MAX + 1> name{};
        ::gethostname(name.data(), name.size() - 1);
        host_ = name.data();
        library_ = library_name();
    }

    std::uint32_t rank() const override { return static_cast<std::uint32_t>(rank_); }
    std::uint32_t count() const override { return static_cast<std::uint32_t>(count_); }
    std::string host() const override { return host_; }
    std::string library() const override { return library_; }

    void broadcast(std::span<std::byte> bytes) override {
        for_pieces(bytes, [&](std::span<std::byte> piece) {
            check_mpi(
                MPI_Ibcast(piece.data(), static_cast<int>(piece.size()), MPI_BYTE, 0, data_comm_, &next_request()),
                "MPI_Ibcast");
            wait();
        });
    }

    void all_gather(std::span<const std::byte> own_bytes, std::span<std::byte> all_bytes,
                    std::span<const std::size_t> sizes) override {
        if (all_bytes.size() > INT_MAX) throw std::length_error("all_gather: 2^31 bytes or more");
        std::vector<int> counts, starts;
        int end = 0;
        for (const std::size_t size : sizes) {
            counts.push_back(static_cast<int>(size));
            starts.push_back(end);
            end += counts.back();
        }
        check_mpi(MPI_Iallgatherv(own_bytes.data(), static_cast<int>(own_bytes.size()), MPI_BYTE, all_bytes.data(),
                                  counts.data(), starts.data(), MPI_BYTE, data_comm_, &next_request()),
                  "MPI_Iallgatherv");
        wait();
    }

    // The pieces of a message arrive in order, because MPI keeps the order of messages with equal sender, receiver and
    // tag.
    void start(std::span<const OutgoingMessage> out, std::span<const IncomingMessage> in) override {
        for (const IncomingMessage& m : in)
            for_pieces(m.bytes, [&](std::span<std::byte> piece) {
                check_mpi(MPI_Irecv(piece.data(), static_cast<int>(piece.size()), MPI_BYTE, static_cast<int>(m.sender),
                                    m.tag, data_comm_, &next_request()),
                          "MPI_Irecv");
            });
        for (const OutgoingMessage& m : out)
            for_pieces(m.bytes, [&](std::span<const std::byte> piece) {
                check_mpi(MPI_Isend(piece.data(), static_cast<int>(piece.size()), MPI_BYTE,
                                    static_cast<int>(m.receiver), m.tag, data_comm_, &next_request()),
                          "MPI_Isend");
            });
    }

    void wait() override {
        if (!complete_within(limit_s_, requests_)) throw RankFailure(timeout_text(), kExitDeviceError);
        requests_.clear();
    }

    void report_failure(const std::string& text, int code) override {
        // Time that rank 0 has to end all ranks; after this time the caller aborts all ranks. The time increases with
        // the rank. So if several ranks fail and rank 0 does not react, only the lowest of the failed ranks aborts.
        const double timeout_s = 4 + failure_delay_s(rank());
        std::string message = fmt::format("{} {}", code, text);
        std::vector<MPI_Request> sent(1);
        const int size = static_cast<int>(message.size());
        if (MPI_Isend(message.data(), size, MPI_BYTE, 0, kFailureTag, failure_comm_, sent.data()) != MPI_SUCCESS)
            return;
        const Clock::time_point start = Clock::now();
        complete_within(timeout_s, sent);
        // Normally rank 0 ends this process during the sleep.
        std::this_thread::sleep_for(std::chrono::duration<double>(timeout_s - seconds_since(start)));
    }

    void poll_failures() override {
        if (rank_ == 0) receive_failure();
    }

    [[noreturn]] void abort(int code) override {
        constexpr double kAbortLimit_s = 5;  // maximum duration of MPI_Abort
        const std::jthread limit = deadline(kAbortLimit_s, "", code);
        // MPICH's mpirun may lose output that is written just before MPI_Abort.
        std::this_thread::sleep_for(std::chrono::milliseconds(200));
        MPI_Abort(MPI_COMM_WORLD, code);
        std::_Exit(code);  // only if MPI_Abort returns, which the MPI standard allows
    }

    void close() override {
        const std::jthread limit =
            deadline(limit_s_, rank_ == 0 ? fmt::format("raya: {}\n", timeout_text()) : "", kExitDeviceError);
        MPI_Finalize();
    }

  private:
    template <class Byte, class Call>
    static void for_pieces(std::span<Byte> bytes, Call&& call) {
        for (std::size_t begin = 0; begin < bytes.size(); begin += kMaxMessageBytes)
            call(bytes.subspan(begin, std::min(kMaxMessageBytes, bytes.size() - begin)));
    }

    int ranks_of_host() const {
        MPI_Comm host = MPI_COMM_NULL;
        int ranks = 1;
        check_mpi(MPI_Comm_split_type(data_comm_, MPI_COMM_TYPE_SHARED, rank_, MPI_INFO_NULL, &host),
                  "MPI_Comm_split_type");
        MPI_Comm_size(host, &ranks);
        MPI_Comm_free(&host);
        return ranks;
    }

    std::string timeout_text() const {
        return fmt::format(
            "rank {} on {}: has waited for the other ranks for {:g} s; remedy: look for a rank that hangs, or raise "
            "the limit with RAYA_RANK_TIMEOUT=SECONDS",
            rank_, host_, limit_s_);
    }

    MPI_Request& next_request() { return requests_.emplace_back(MPI_REQUEST_NULL); }

    // Waits until all requests are complete; returns false if they are not complete after `limit_s` seconds. Ranks may
    // share cores, so the function polls without sleeping only for spin_s_ seconds and then sleeps between polls. It
    // sleeps instead of calling sched_yield, because the scheduler gives a thread that has just woken up priority over
    // computing threads, but not a thread that has yielded.
    bool complete_within(double limit_s, std::vector<MPI_Request>& requests) {
        constexpr auto kSleep = std::chrono::microseconds(20);
        const Clock::time_point start = Clock::now();
        for (;;) {
            int all_complete = 0;
            check_mpi(
                MPI_Testall(static_cast<int>(requests.size()), requests.data(), &all_complete, MPI_STATUSES_IGNORE),
                "MPI_Testall");
            if (all_complete) return true;
            const double elapsed_s = seconds_since(start);
            if (elapsed_s < spin_s_) continue;
            if (rank_ == 0) receive_failure();
            if (elapsed_s > limit_s) return false;
            std::this_thread::sleep_for(kSleep);
        }
    }

    void receive_failure() {
        int available = 0;
        MPI_Status status;
        check_mpi(MPI_Iprobe(MPI_ANY_SOURCE, kFailureTag, failure_comm_, &available, &status), "MPI_Iprobe");
        if (!available) return;
        int size = 0;
        MPI_Get_count(&status, MPI_BYTE, &size);
        std::string message(static_cast<std::size_t>(size), ' ');
        MPI_Recv(message.data(), size, MPI_BYTE, status.MPI_SOURCE, kFailureTag, failure_comm_, MPI_STATUS_IGNORE);
        const std::size_t blank_at = message.find(' ');
        throw RankFailure(message.substr(blank_at + 1), std::atoi(message.c_str()));
    }

    const double limit_s_;
    double spin_s_ = 0;  // time for which a wait polls before it sleeps; shorter if ranks share cores
    MPI_Comm data_comm_ = MPI_COMM_NULL, failure_comm_ = MPI_COMM_NULL;
    int rank_ = 0, count_ = 1;
    std::string host_, library_;
    std::vector<MPI_Request> requests_;
};

}  // namespace
}  // namespace raya

extern "C" __attribute__((visibility("default"))) raya::Transport* raya_make_mpi_transport(double limit_s) {
    return new raya::MpiTransport(limit_s);
}
