// HostCounters counts the events of the threads that start after its construction.
#include <sys/mman.h>
#include <sys/resource.h>

#include <atomic>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstdint>
#include <ctime>
#include <thread>

#include "host/cl/profile.hpp"

namespace raya {
namespace {

constexpr double kWorkNs = 5e7;
constexpr std::size_t kPages = 200, kPageBytes = 4096;

double processor_ns(clockid_t clock) {
    timespec time{};
    ::clock_gettime(clock, &time);
    return 1e9 * static_cast<double>(time.tv_sec) + static_cast<double>(time.tv_nsec);
}

// Takes kWorkNs of this thread's processor time, and kPages page faults.
void work() {
    const double start = processor_ns(CLOCK_THREAD_CPUTIME_ID);
    auto* const bytes = static_cast<volatile char*>(
        ::mmap(nullptr, kPages * kPageBytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0));
    if (bytes == MAP_FAILED) return;
    ::madvise(const_cast<char*>(bytes), kPages * kPageBytes, MADV_NOHUGEPAGE);  // else one fault may map many pages
    for (std::size_t i = 0; i < kPages; ++i) bytes[i * kPageBytes] = 1;
    ::munmap(const_cast<char*>(bytes), kPages * kPageBytes);
    while (processor_ns(CLOCK_THREAD_CPUTIME_ID) - start < kWorkNs) {
    }
}

}  // namespace

TEST_CASE("host counters: count running threads that started later, and no thread that started earlier", "[cl]") {
    std::atomic<int> turn{0};  // 1: the earlier thread works, 2: it is done, 3: the later one works, 4: it is done
    const auto work_in_turn = [&](int number) {
        turn.wait(number - 1);
        if (turn != number) return;
        work();
        turn = number + 1;
        turn.notify_all();
        turn.wait(number + 1);
    };
    const auto counts_of = [&](const HostCounters& counters, int number) {
        const HostCounts before = counters.read();
        turn = number;
        turn.notify_all();
        turn.wait(number);
        return (counters.read() - before).of;  // the thread is waiting, not joined
    };
    std::thread earlier(work_in_turn, 1);
    const HostCounters counters;
    std::thread later([&] {
        turn.wait(0), turn.wait(1), turn.wait(2);
        work_in_turn(3);
    });
    const auto without = counts_of(counters, 1), with = counts_of(counters, 3);
    turn = 5;
    turn.notify_all();
    earlier.join(), later.join();
    if (std::isnan(with[kCpuNs])) {
        WARN("not tested: " << counters.unavailable());
        return;
    }
    CAPTURE(without[kCpuNs], with[kCpuNs], without[kPageFaults], with[kPageFaults], counters.unavailable());
    CHECK(without[kCpuNs] < 0.5 * kWorkNs);
    CHECK(with[kCpuNs] > 0.9 * kWorkNs);
    CHECK(with[kCpuNs] < 2 * kWorkNs);
    CHECK(without[kPageFaults] < kPages / 2);
    CHECK(with[kPageFaults] >= kPages);
    CHECK(with[kPageFaults] < 2 * kPages);
    for (const HostEvent event : {kCycles, kInstructions, kBranchMisses}) {
        CHECK((std::isnan(with[event]) || with[event] > 0));
        CHECK((!std::isnan(with[event]) || counters.unavailable().starts_with("no ")));
    }
}

TEST_CASE("host counters: without descriptors there are no counts, and the reason is given", "[cl]") {
    rlimit files{};
    ::getrlimit(RLIMIT_NOFILE, &files);
    const rlimit none{0, files.rlim_max};
    ::setrlimit(RLIMIT_NOFILE, &none);
    const HostCounters counters;
    ::setrlimit(RLIMIT_NOFILE, &files);
    for (const double count : counters.read().of) CHECK(std::isnan(count));
    CHECK_THAT(counters.unavailable(), Catch::StartsWith("no cycles, instructions, cache misses, branch misses"));
    CHECK_THAT(counters.unavailable(), Catch::Contains(", page faults: "));
}

TEST_CASE("host counts: differences and sums of unknown counts are unknown", "[cl]") {
    HostCounts a, b;
    a.of = {5, 5, 5, NAN, 5, 5};
    b.of = {2, 0, NAN, NAN, 3, 1};
    const auto sum = (a + b).of, difference = (a - b).of;
    CHECK((sum[0] == 7 && sum[1] == 5 && std::isnan(sum[2]) && std::isnan(sum[3]) && sum[5] == 6));
    CHECK((difference[0] == 3 && difference[1] == 5 && std::isnan(difference[2]) && difference[5] == 4));
}

}  // namespace raya
