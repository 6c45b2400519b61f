#include "host/cl/driver_call.hpp"

#include <dlfcn.h>
#include <pthread.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <csignal>
#include <cstddef>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <thread>
#include <utility>

#include "host/base/interruption.hpp"
#include "host/error.hpp"

namespace raya {
namespace {

std::atomic<const char*> doing{nullptr};
std::atomic<bool> prepares_threads{false};
static_assert(std::atomic<const char*>::is_always_lock_free);

std::array<char, 300> process{};  // "rank 1 on node7: ", or empty
unsigned int turn_us = 0;

// The largest frame measured for a group is 88 MB: 1,024 work-items of 16 lanes with a grid and 31 bounces.
constexpr std::size_t kStack = std::size_t{128} << 20;
using AlternateStack = std::array<std::byte, 80 << 10>;  // with less LLVM would allocate its own

constexpr std::array<int, 5> kCrashes = {SIGABRT, SIGSEGV, SIGBUS, SIGILL, SIGFPE};

/// Calls nothing but what a handler may call.
void tell(const char* text) {
    if (::write(STDERR_FILENO, text, std::strlen(text)) < 0) return;  // nobody listens
}

extern "C" void explain(int signal) {
    static std::atomic<pid_t> crashed{0};
    const pid_t thread = ::gettid();
    pid_t first = 0;
    if (!crashed.compare_exchange_strong(first, thread) && first != thread)
        for (;;) ::pause();  // of threads that crash alike the first ends the process
    remove_files_in_progress();
    const char* what = doing.load();
    if (what == nullptr && thread != ::getpid()) what = "running a kernel";  // raya's own work is elsewhere
    if (what == nullptr || first != 0) {
        std::signal(signal, SIG_DFL);
        ::raise(signal);
        return;
    }
    if (turn_us > 0) ::usleep(turn_us);
    tell("\nraya: ");
    tell(process.data());
    tell("the OpenCL driver crashed (SIG");
    tell(::sigabbrev_np(signal));
    tell(") while ");
    tell(what);
    tell(
        "; remedy: smaller work-groups (--group) or fewer lanes (--lanes), an empty folder as POCL_CACHE_DIR in case "
        "the cache is damaged, more memory (ulimit -v), a mounted /sys, or another driver (raya devices); raya verify "
        "shows what a driver does wrong\n");
    ::_exit(kExitDeviceError);
}

/// LLVM, in PoCL, calls exit() where the disk with the kernel cache is full.
void explain_exit() {
    const char* const what = doing.load();
    if (what == nullptr) return;
    remove_files_in_progress();
    for (const char* text :
         {"\nraya: ", static_cast<const char*>(process.data()), "the OpenCL driver ended the program while ", what,
          "; remedy: make room for PoCL's kernels, or name another folder in POCL_CACHE_DIR\n"})
        tell(text);
    ::_exit(kExitDeviceError);
}

void set_handler(int signal, void (*from)(int), void (*to)(int)) {
    struct sigaction action {};
    if (::sigaction(signal, nullptr, &action) != 0 || action.sa_handler != from) return;
    action.sa_handler = to;
    action.sa_flags = SA_NODEFER | SA_ONSTACK;
    ::sigaction(signal, &action, nullptr);
}

/// Bytes for a thread's stack, and as many for its guard: of limited address space an eighth for one thread per core.
std::size_t thread_stack() {
    rlimit memory{RLIM_INFINITY, RLIM_INFINITY};
    ::getrlimit(RLIMIT_AS, &memory);
    const rlim_t cores = std::max(1u, std::thread::hardware_concurrency());
    return std::clamp<rlim_t>(memory.rlim_cur / 16 / cores, kStack / 16, kStack);
}

using Start = std::pair<void* (*)(void*), void*>;  // a thread's routine and its argument

void* run_thread(void* given) {
    const auto [routine, argument] = *std::unique_ptr<Start>(static_cast<Start*>(given));
    AlternateStack memory;
    const stack_t own{memory.data(), 0, memory.size()};
    stack_t before{};
    ::sigaltstack(&own, &before);
    void* const result = routine(argument);
    ::sigaltstack(&before, nullptr);
    return result;
}

}  // namespace

// Replaces the C library's in the program and, as the program exports it, in all libraries: PoCL runs kernels in
// threads that it creates with default attributes, and has the private memory of a whole work-group on the stack.
// Frames may be larger than the guard page: they would write into the next thread's stack.
extern "C" __attribute__((visibility("default"))) int pthread_create(pthread_t* thread,
                                                                     const pthread_attr_t* attributes,
                                                                     void* (*routine)(void*), void* argument) noexcept {
    static auto* const next = reinterpret_cast<decltype(&::pthread_create)>(::dlsym(RTLD_NEXT, "pthread_create"));
    if (attributes != nullptr || !prepares_threads) return next(thread, attributes, routine, argument);
    auto start = std::make_unique<Start>(routine, argument);
    pthread_attr_t large;
    ::pthread_attr_init(&large);
    ::pthread_attr_setstacksize(&large, thread_stack());
    ::pthread_attr_setguardsize(&large, thread_stack());
    int error = next(thread, &large, run_thread, start.get());
    if (error != 0) error = next(thread, nullptr, run_thread, start.get());  // there is less address space
    ::pthread_attr_destroy(&large);
    if (error == 0) start.release();
    return error;
}

DriverCall::DriverCall(const char* what) : before_(doing.exchange(what)) {}
DriverCall::~DriverCall() { doing.store(before_); }

void name_process_in_crashes(const std::string& name, double turn_s) {
    process = {};
    name.copy(process.data(), process.size() - 1);
    turn_us = static_cast<unsigned int>(turn_s * 1e6);
}

void explain_driver_crashes() {
    std::atexit(explain_exit);
    for (const int signal : kCrashes) {
        set_handler(signal, SIG_DFL, explain);
        if (signal != SIGFPE) keep_handler(signal);  // PoCL's makes a division by 0 go on
    }
    static AlternateStack memory;
    const stack_t own{memory.data(), 0, memory.size()};
    ::sigaltstack(&own, nullptr);
    rlimit stack{};  // of this thread, which runs kernels on PoCL's basic device
    ::getrlimit(RLIMIT_STACK, &stack);
    stack.rlim_cur = std::min<rlim_t>(stack.rlim_max, thread_stack());
    ::setrlimit(RLIMIT_STACK, &stack);
    prepares_threads = true;
}

void leave_driver_crashes() {
    for (const int signal : kCrashes) {
        keep_handler(signal, false);
        set_handler(signal, explain, SIG_DFL);
    }
}

}  // namespace raya
