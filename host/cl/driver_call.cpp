#include "host/cl/driver_call.hpp"

#include <dlfcn.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <csignal>
#include <cstring>

#include "host/error.hpp"
#include "host/files/interruption.hpp"

namespace raya {
namespace {

std::atomic<const char*> doing{nullptr};
std::atomic<bool> explains{false};
static_assert(std::atomic<const char*>::is_always_lock_free);

std::array<char, 300> process{};  // "rank 1 on node7: ", or empty
unsigned int turn_us = 0;

constexpr std::array<int, 5> kCrashes = {SIGABRT, SIGSEGV, SIGBUS, SIGILL, SIGFPE};

/// Calls nothing but what a handler may call.
void tell(const char* text) {
    if (::write(STDERR_FILENO, text, std::strlen(text)) < 0) return;  // nobody listens
}

extern "C" void explain(int signal) {
    const char* const what = doing.load();
    if (what == nullptr) {
        ::raise(signal);  // SA_RESETHAND: what the signal does by itself
        return;
    }
    remove_files_in_progress();
    if (turn_us > 0) ::usleep(turn_us);
    tell("\nraya: ");
    tell(process.data());
    tell("the OpenCL driver crashed (SIG");
    tell(::sigabbrev_np(signal));
    tell(") while ");
    tell(what);
    tell(
        "; what it said stands above; remedy: POCL_CACHE_DIR=DIR with an empty folder in place of a cache that may be "
        "damaged, more memory (ulimit -v), a /sys that is mounted, another driver (raya devices), and raya verify, "
        "which says what a driver does wrong\n");
    ::_exit(kExitDeviceError);
}

using SetAction = int(int, const struct sigaction*, struct sigaction*);

SetAction* next_sigaction() {
    static auto* const next = reinterpret_cast<SetAction*>(::dlsym(RTLD_NEXT, "sigaction"));
    return next;
}

void set_handler(int signal, void (*from)(int), void (*to)(int)) {
    struct sigaction before {};
    if (next_sigaction()(signal, nullptr, &before) != 0 || before.sa_handler != from) return;
    struct sigaction action {};
    action.sa_handler = to;
    action.sa_flags = static_cast<int>(SA_RESETHAND | SA_NODEFER);
    next_sigaction()(signal, &action, nullptr);
}

}  // namespace

// In the place of the C library's, for the program and its libraries: LLVM, in PoCL, would put a handler of its own in
// the place of ours and call ours after it, as it does for other signals; but after one handler abort() waits for no
// other.
extern "C" __attribute__((visibility("default"))) int sigaction(int signal, const struct sigaction* action,
                                                                struct sigaction* before) noexcept {
    const bool is_ours = signal == SIGABRT && explains.load();
    return next_sigaction()(signal, is_ours ? nullptr : action, before);
}

DriverCall::DriverCall(const char* what) : before_(doing.exchange(what)) {}
DriverCall::~DriverCall() { doing.store(before_); }

void name_process_in_crashes(const std::string& name, double turn_s) {
    process = {};
    name.copy(process.data(), process.size() - 1);
    turn_us = static_cast<unsigned int>(turn_s * 1e6);
}

void explain_driver_crashes() {
    explains = true;
    for (const int signal : kCrashes) set_handler(signal, SIG_DFL, explain);
}

void leave_driver_crashes() {
    explains = false;
    for (const int signal : kCrashes) set_handler(signal, explain, SIG_DFL);
}

}  // namespace raya
