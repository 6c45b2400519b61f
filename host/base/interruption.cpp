#include "host/base/interruption.hpp"

#include <dlfcn.h>
#include <poll.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <climits>
#include <csignal>
#include <cstddef>
#include <cstring>

namespace raya {
namespace {

// A handler may neither allocate nor lock: names stand in a fixed table, an empty one is no file.
struct Slot {
    std::atomic<bool> taken{false};
    std::array<char, PATH_MAX> name{};
};
std::array<Slot, 16> slots;
static_assert(std::atomic<bool>::is_always_lock_free);
std::atomic<bool> silent{false};

using Handler = void (*)(int, siginfo_t*, void*);
std::array<std::atomic<bool>, 32> kept;          // by signal
std::array<std::atomic<Handler>, 32> displaced;  // what a library wanted instead of a kept handler
static_assert(std::atomic<Handler>::is_always_lock_free);

/// Runs in whatever thread the signal finds; calls nothing but what a handler may call.
extern "C" void remove_and_end(int signal, siginfo_t* info, void* context) {
    static std::atomic<bool> ending{false};
    if (ending.exchange(true)) return;  // timeout(1), for one, sends a signal twice; the first must not be cut short
    remove_files_in_progress();
    static constexpr char kMessage[] = "\r\033[Kraya: interrupted\n";
    constexpr std::size_t kClear = 4;  // wipes a progress bar off the line, on a terminal
    const std::size_t skipped = ::isatty(STDERR_FILENO) != 0 ? 0 : kClear;
    pollfd out{STDERR_FILENO, POLLOUT, 0};  // a pipe may be full
    if (!silent && ::poll(&out, 1, 0) == 1 && out.revents == POLLOUT)
        if (::write(STDERR_FILENO, kMessage + skipped, sizeof kMessage - 1 - skipped) < 0) silent = true;
    if (const Handler driver = displaced[static_cast<std::size_t>(signal)]) driver(signal, info, context);
    std::signal(signal, SIG_DFL);
    ::raise(signal);  // so that the caller sees why the program ended
}

void handle(int signal) {
    struct sigaction action {};
    if (::sigaction(signal, nullptr, &action) != 0) return;
    if (action.sa_handler != SIG_IGN) {
        action.sa_sigaction = remove_and_end;
        action.sa_flags = SA_NODEFER | SA_SIGINFO;
        ::sigaction(signal, &action, nullptr);
    }
    keep_handler(signal);
}

}  // namespace

void remove_files_in_progress() {
    for (Slot& slot : slots)
        if (slot.taken.load() && slot.name[0] != '\0') ::unlink(slot.name.data());
}

void end_cleanly_when_interrupted() {
    for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGQUIT}) handle(signal);
}

void keep_handler(int signal, bool keep) { kept.at(static_cast<std::size_t>(signal)) = keep; }

void end_silently() { silent = true; }

FileInProgress::FileInProgress(const std::filesystem::path& path) {
    // Where the handler runs the working folder is the same: raya never changes it.
    if (path.native().size() >= PATH_MAX) return;
    for (Slot& slot : slots) {
        if (slot.taken.exchange(true)) continue;
        name_ = slot.name.data();  // empty, as every free slot's
        std::strcpy(name_ + 1, path.c_str() + 1);
        std::atomic_signal_fence(std::memory_order_release);
        name_[0] = path.c_str()[0];  // last: a name is there whole or not at all
        return;
    }
}

FileInProgress::~FileInProgress() {
    for (Slot& slot : slots) {
        if (slot.name.data() != name_) continue;
        name_[0] = '\0';
        slot.taken.store(false);
    }
}

}  // namespace raya

// Replaces the C library's in the program and, as the program exports it, in all libraries. LLVM, in PoCL, installs
// handlers for HUP, INT, TERM, QUIT and all crashes (lib/Support/Unix/Signals.inc), which remove its temporary files
// and reinstall the handlers before. But after SIGQUIT they just return, and after any handler abort() calls no other.
extern "C" __attribute__((visibility("default"))) int sigaction(int signal, const struct sigaction* action,
                                                                struct sigaction* before) noexcept {
    using namespace raya;
    static auto* const next = reinterpret_cast<decltype(&::sigaction)>(::dlsym(RTLD_NEXT, "sigaction"));
    const auto index = static_cast<std::size_t>(signal);
    if (action == nullptr || index >= kept.size() || !kept[index]) return next(signal, action, before);
    // A handler that takes the number alone may be called with more: both share their place in the struct.
    const bool handles = action->sa_handler != SIG_DFL && action->sa_handler != SIG_IGN;
    if (handles && action->sa_sigaction != remove_and_end) displaced[index] = action->sa_sigaction;
    return next(signal, nullptr, before);
}
