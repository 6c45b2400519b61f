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

// The paths of the registered files are in a table of fixed size, because a signal handler may neither allocate nor
// lock.
struct FileEntry {
    std::atomic<bool> taken{false};
    std::array<char, PATH_MAX> path{};  // empty: no file is registered
};
std::array<FileEntry, 16> file_table;
static_assert(std::atomic<bool>::is_always_lock_free);
std::atomic<bool> message_suppressed{false};

using Handler = void (*)(int, siginfo_t*, void*);
std::array<std::atomic<bool>, 32> is_protected;  // [signal]: true if libraries cannot replace its handler
// [signal]: handler that a library tried to install; null if none.
std::array<std::atomic<Handler>, 32> library_handlers;
static_assert(std::atomic<Handler>::is_always_lock_free);

/// The signal handler. It may run in any thread and calls only async-signal-safe functions.
extern "C" void remove_files_and_end(int signal, siginfo_t* info, void* context) {
    static std::atomic<bool> ending{false};
    if (ending.exchange(true)) return;  // a second signal, which timeout(1) sends, must not end the first call early
    remove_files_in_progress();
    static constexpr char kMessage[] = "\r\033[Kraya: interrupted\n";
    constexpr std::size_t kClear = 4;  // length of "\r\033[K", which erases a progress bar from a terminal
    const std::size_t skipped = ::isatty(STDERR_FILENO) != 0 ? 0 : kClear;
    pollfd out{STDERR_FILENO, POLLOUT, 0};  // write() to a full pipe would block
    if (!message_suppressed && ::poll(&out, 1, 0) == 1 && out.revents == POLLOUT)
        if (::write(STDERR_FILENO, kMessage + skipped, sizeof kMessage - 1 - skipped) < 0) message_suppressed = true;
    if (const Handler library_handler = library_handlers[static_cast<std::size_t>(signal)])
        library_handler(signal, info, context);
    std::signal(signal, SIG_DFL);
    ::raise(signal);  // the parent sees the signal in the exit status
}

void install_handler(int signal) {
    struct sigaction action {};
    if (::sigaction(signal, nullptr, &action) != 0) return;
    if (action.sa_handler != SIG_IGN) {
        action.sa_sigaction = remove_files_and_end;
        action.sa_flags = SA_NODEFER | SA_SIGINFO;
        ::sigaction(signal, &action, nullptr);
    }
    protect_handler(signal);
}

}  // namespace

void remove_files_in_progress() {
    for (FileEntry& entry : file_table)
        if (entry.taken.load() && entry.path[0] != '\0') ::unlink(entry.path.data());
}

void install_interrupt_handlers() {
    for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGQUIT}) install_handler(signal);
}

void protect_handler(int signal) { is_protected.at(static_cast<std::size_t>(signal)) = true; }
void unprotect_handler(int signal) { is_protected.at(static_cast<std::size_t>(signal)) = false; }

void suppress_interrupt_message() { message_suppressed = true; }

FileInProgress::FileInProgress(const std::filesystem::path& path) {
    // A relative path is still valid in the handler, because raya never changes its working directory.
    if (path.native().size() >= PATH_MAX) return;
    for (FileEntry& entry : file_table) {
        if (entry.taken.exchange(true)) continue;
        path_ = entry.path.data();  // empty, because the entry was free
        std::strcpy(path_ + 1, path.c_str() + 1);
        std::atomic_signal_fence(std::memory_order_release);
        path_[0] = path.c_str()[0];  // written last, so that the handler sees either the whole path or an empty one
        return;
    }
}

FileInProgress::~FileInProgress() {
    for (FileEntry& entry : file_table) {
        if (entry.path.data() != path_) continue;
        path_[0] = '\0';
        entry.taken.store(false);
    }
}

}  // namespace raya

// Replaces the C library's sigaction() in the program and, because the program exports it, in all libraries. LLVM,
// which PoCL uses, installs handlers for HUP, INT, TERM, QUIT and all crash signals (lib/Support/Unix/Signals.inc).
// LLVM's handlers delete its temporary files and reinstall the previous handlers. They must not replace raya's
// handlers: after SIGQUIT they return without ending the process, and abort() does not call the reinstalled handler.
extern "C" __attribute__((visibility("default"))) int sigaction(int signal, const struct sigaction* action,
                                                                struct sigaction* previous) noexcept {
    using namespace raya;
    static auto* const next = reinterpret_cast<decltype(&::sigaction)>(::dlsym(RTLD_NEXT, "sigaction"));
    const auto index = static_cast<std::size_t>(signal);
    if (action == nullptr || index >= is_protected.size() || !is_protected[index])
        return next(signal, action, previous);
    // sa_handler and sa_sigaction share storage. A handler with one parameter ignores the other two arguments.
    const bool handles = action->sa_handler != SIG_DFL && action->sa_handler != SIG_IGN;
    if (handles && action->sa_sigaction != remove_files_and_end) library_handlers[index] = action->sa_sigaction;
    return next(signal, nullptr, previous);
}
