#include "host/base/interruption.hpp"

#include <dlfcn.h>
#include <poll.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <climits>
#include <csignal>
#include <cstring>

namespace raya {
namespace {

// Path of the file in progress; empty: none. Of fixed size, because a signal handler may neither allocate nor lock.
std::array<char, PATH_MAX> file_in_progress{};
std::atomic<bool> message_suppressed{false};
std::array<std::atomic<bool>, 32> is_protected;  // [signal]: handle_signal() was called

/// The signal handler. It may run in any thread and calls only async-signal-safe functions.
extern "C" void remove_file_and_end(int signal) {
    static std::atomic<bool> ending{false};
    if (ending.exchange(true)) return;  // a second signal, which timeout(1) sends, must not end the first call early
    remove_file_in_progress();
    static constexpr char kMessage[] = "\r\033[Kraya: interrupted\n";
    constexpr std::size_t kClear = 4;  // length of "\r\033[K", which erases a progress bar from a terminal
    const std::size_t skipped = ::isatty(STDERR_FILENO) != 0 ? 0 : kClear;
    pollfd out{STDERR_FILENO, POLLOUT, 0};  // write() to a full pipe would block
    if (!message_suppressed && ::poll(&out, 1, 0) == 1 && out.revents == POLLOUT)
        if (::write(STDERR_FILENO, kMessage + skipped, sizeof kMessage - 1 - skipped) < 0) message_suppressed = true;
    std::signal(signal, SIG_DFL);
    ::raise(signal);  // the parent sees the signal in the exit status
}

}  // namespace

void remove_file_in_progress() {
    if (file_in_progress[0] != '\0') ::unlink(file_in_progress.data());
}

void handle_signal(int signal, void (*handler)(int)) {
    struct sigaction action {};
    ::sigaction(signal, nullptr, &action);
    if (action.sa_handler == SIG_DFL) {
        action.sa_handler = handler;
        action.sa_flags = SA_NODEFER | SA_ONSTACK;
        ::sigaction(signal, &action, nullptr);
    }
    is_protected.at(static_cast<std::size_t>(signal)) = true;
}

void install_interrupt_handlers() {
    for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGQUIT}) handle_signal(signal, remove_file_and_end);
}

void suppress_interrupt_message() { message_suppressed = true; }

FileInProgress::FileInProgress(const std::filesystem::path& path) {
    // A relative path is still valid in the handler, because raya never changes its working directory.
    if (path.native().size() >= PATH_MAX || file_in_progress[0] != '\0') return;
    is_registered_ = true;
    std::strcpy(file_in_progress.data() + 1, path.c_str() + 1);
    std::atomic_signal_fence(std::memory_order_release);
    file_in_progress[0] = path.c_str()[0];  // written last, so that the handler sees either the whole path or none
}

FileInProgress::~FileInProgress() {
    if (is_registered_) file_in_progress[0] = '\0';
}

}  // namespace raya

// Replaces the C library's sigaction() in the program and, because the program exports it, in all libraries. LLVM,
// which PoCL uses, would install handlers (lib/Support/Unix/Signals.inc) with which SIGQUIT does not end the process
// and abort() ends it without raya's message.
extern "C" __attribute__((visibility("default"))) int sigaction(int signal, const struct sigaction* action,
                                                                struct sigaction* previous) noexcept {
    static auto* const next = reinterpret_cast<decltype(&::sigaction)>(::dlsym(RTLD_NEXT, "sigaction"));
    const auto index = static_cast<std::size_t>(signal);
    const bool keeps = index < raya::is_protected.size() && raya::is_protected[index];
    return next(signal, keeps ? nullptr : action, previous);
}
