#include "host/cl/driver.hpp"

#include <dlfcn.h>
#include <fmt/core.h>
#include <pthread.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <csignal>
#include <cstddef>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <memory>
#include <string>
#include <system_error>
#include <thread>
#include <utility>

#include "host/base/interruption.hpp"
#include "host/base/module.hpp"
#include "host/base/say.hpp"
#include "host/base/whole_file.hpp"
#include "host/error.hpp"

namespace raya {
namespace fs = std::filesystem;
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

constexpr const char* kVariable = "POCL_CACHE_DIR";

std::string variable(const char* name) {
    const char* value = std::getenv(name);
    return value != nullptr ? value : "";
}

/// What PoCL takes unless POCL_CACHE_DIR names another one.
fs::path usual_folder() {
    const std::string home = variable("HOME"), cache = variable("XDG_CACHE_HOME");
    if (!cache.empty()) return fs::path(cache) / "pocl/kcache";
    return home.empty() ? "/tmp/pocl/kcache" : fs::path(home) / ".cache/pocl/kcache";
}

/// Why PoCL's cache must not be this folder, or be made below what there is of its path; empty if it may.
std::string unsafe(fs::path folder) {
    std::error_code error;
    while (!fs::exists(folder, error) && folder.has_relative_path()) folder = folder.parent_path();
    if (::access(folder.c_str(), W_OK | X_OK) != 0) return fmt::format("'{}' is not writable", folder.string());
    return other_writers(folder, {::geteuid()}, Sticky::kRefused);
}

/// Makes a folder for this user alone, unless it is there and is such a one. Others may have made it.
bool is_own(const fs::path& folder) {
    struct stat is {};
    ::mkdir(folder.c_str(), S_IRWXU);
    return ::lstat(folder.c_str(), &is) == 0 && S_ISDIR(is.st_mode) && is.st_uid == ::geteuid() &&
           (is.st_mode & ACCESSPERMS) == S_IRWXU;
}

fs::path own_folder(const std::string& why) {
    std::error_code error;
    fs::path temporary = fs::canonical(fs::temp_directory_path(error), error);
    if (error) temporary = "/tmp";
    const std::string first = temporary / fmt::format("raya-pocl-cache-{}", ::geteuid());
    if (other_writers(temporary, {::geteuid()}, Sticky::kAllowed).empty())
        for (const char* end : {"", "-1", "-2", "-3", "-4", "-5", "-6", "-7", "-8", "-9"})
            if (is_own(first + end)) return first + end;
    throw DeviceError(
        fmt::format("no folder for PoCL's kernels: {}, and neither '{}' nor one with -1 to -9 behind that is a folder "
                    "of this user alone; name one in POCL_CACHE_DIR",
                    why, first));
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

void provide_driver_cache() {
    if (!variable(kVariable).empty()) return;
    std::error_code error;
    const fs::path usual = fs::weakly_canonical(fs::absolute(usual_folder(), error), error);
    const std::string why = error ? fmt::format("'{}': {}", usual_folder().string(), error.message()) : unsafe(usual);
    // PoCL gets the path that was checked: what links lead to may change.
    const fs::path chosen = why.empty() ? usual : own_folder(why);
    ::setenv(kVariable, chosen.c_str(), 1);
    if (!why.empty())
        warn(fmt::format("warning: {}: PoCL keeps its kernels in {}; POCL_CACHE_DIR names another folder", why,
                         chosen.string()));
}

std::string driver_cache_trouble() {
    constexpr std::size_t kEnough = 1 << 20;  // bytes: a kernel takes less
    const fs::path folder = variable(kVariable), probe = folder / fmt::format("raya-{}", ::getpid());
    try {
        std::error_code error;
        fs::create_directories(folder, error);
        write_whole_file(probe, std::string(kEnough, 'x'));
        fs::remove(probe, error);
        return {};
    } catch (const UserError& error) {
        return fmt::format("PoCL's kernel cache (POCL_CACHE_DIR={}): {}", folder.string(), error.what());
    }
}

}  // namespace raya
