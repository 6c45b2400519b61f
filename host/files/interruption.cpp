#include "host/files/interruption.hpp"

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
std::array<std::atomic<bool>, 32> silent;  // by signal

/// Runs in whatever thread the signal finds; calls nothing but what a handler may call.
extern "C" void remove_and_end(int signal) {
    remove_files_in_progress();
    static constexpr char kMessage[] = "\r\033[Kraya: interrupted\n";
    constexpr std::size_t kClear = 4;  // wipes a progress bar off the line, on a terminal
    const std::size_t skipped = ::isatty(STDERR_FILENO) != 0 ? 0 : kClear;
    const bool speaks = !silent[static_cast<std::size_t>(signal)].load();
    if (speaks && ::write(STDERR_FILENO, kMessage + skipped, sizeof kMessage - 1 - skipped) < 0) ::_exit(128 + signal);
    ::raise(signal);  // SA_RESETHAND: what the signal does by itself, so that the caller sees why the program ended
}

void handle(int signal) {
    struct sigaction before {};
    if (::sigaction(signal, nullptr, &before) != 0 || before.sa_handler == SIG_IGN) return;
    struct sigaction action {};
    action.sa_handler = remove_and_end;
    action.sa_flags = static_cast<int>(SA_RESETHAND | SA_NODEFER);
    ::sigaction(signal, &action, nullptr);
}

}  // namespace

void remove_files_in_progress() {
    for (Slot& slot : slots)
        if (slot.taken.load() && slot.name[0] != '\0') ::unlink(slot.name.data());
}

void end_cleanly_when_interrupted() {
    for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGQUIT}) handle(signal);
}

void end_silently_on(int signal) { silent.at(static_cast<std::size_t>(signal)).store(true); }

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
