#include "host/cl/driver.hpp"

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
#include <system_error>
#include <thread>

#include "host/base/encoding.hpp"
#include "host/base/interruption.hpp"
#include "host/base/log.hpp"
#include "host/base/module.hpp"
#include "host/base/parallel.hpp"
#include "host/base/whole_file.hpp"
#include "host/error.hpp"

namespace raya {

namespace fs = std::filesystem;
namespace {

std::atomic<const char*> current_operation{nullptr};
static_assert(std::atomic<const char*>::is_always_lock_free);

std::atomic<bool> is_searching{false};

constexpr std::array kCrashSignals = {SIGABRT, SIGSEGV, SIGBUS, SIGILL};  // PoCL handles SIGFPE: kernels divide by 0

std::array<char, 300> crash_prefix{};  // "rank 1 on node7: ", or empty
unsigned int crash_delay_us = 0;

constexpr double kLongSearch_s = 10;

// Size of a thread's stack in bytes: more than the largest stack frame measured for a work-group, 88 MB (1,024
// work-items of 16 lanes with a grid and 31 bounces).
constexpr std::size_t kStackBytes = std::size_t{128} << 20;
// Stack on which signal handlers of the first thread run. LLVM would replace a smaller stack by its own.
using AlternateStack = std::array<std::byte, 80 << 10>;

/// Writes `text` to stderr. Async-signal-safe.
void write_message(const char* text) {
    if (::write(STDERR_FILENO, text, std::strlen(text)) < 0) return;  // stderr is closed: the message is lost
}

constexpr const char* kLeaveOut =
    "; remedy: leave out the driver: set OCL_ICD_VENDORS to the .icd file of another one (/etc/OpenCL/vendors)";

extern "C" void report_driver_crash(int signal) {
    static std::atomic<pid_t> crashed_thread{0};
    const pid_t thread = ::gettid();
    pid_t first_thread = 0;
    if (!crashed_thread.compare_exchange_strong(first_thread, thread) && first_thread != thread)
        for (;;) ::pause();  // another thread crashed first: it ends the process
    remove_file_in_progress();
    const char* operation = current_operation.load();
    if (operation == nullptr && thread != ::getpid()) operation = "running a kernel";  // probably a driver's thread
    if (operation == nullptr || first_thread != 0) {  // outside of drivers, or in this handler itself
        std::signal(signal, SIG_DFL);
        ::raise(signal);
        return;
    }
    if (crash_delay_us > 0) ::usleep(crash_delay_us);
    write_message("\nraya: ");
    write_message(crash_prefix.data());
    write_message("the OpenCL driver crashed (SIG");
    write_message(::sigabbrev_np(signal));
    write_message(") while ");
    write_message(operation);
    write_message(
        is_searching
            ? kLeaveOut
            : "; remedy: smaller work-groups (--group) or fewer lanes (--lanes), an empty folder as POCL_CACHE_DIR in "
              "case the cache is damaged, more memory (ulimit -v), a mounted /sys, or another driver (raya devices); "
              "raya verify shows the driver's errors");
    write_message("\n");
    ::_exit(kExitDeviceError);
}

/// Runs at exit(). PoCL's LLVM calls exit() if the disk with the kernel cache is full.
void report_driver_exit() {
    const char* const operation = current_operation.load();
    if (operation == nullptr) return;
    remove_file_in_progress();
    for (const char* text :
         {"\nraya: ", static_cast<const char*>(crash_prefix.data()), "the OpenCL driver ended the program while ",
          operation, "; remedy: free some space for PoCL's kernels, or name another folder in POCL_CACHE_DIR\n"})
        write_message(text);
    ::_exit(kExitDeviceError);
}

/// Returns the size of a new thread's stack in bytes; its guard has the same size. If RLIMIT_AS limits the address
/// space, the size is chosen so that the stacks and guards of one thread per core together take an eighth of the limit.
/// Minimum: kStackBytes / 16; maximum, also without a limit: kStackBytes.
std::size_t thread_stack_bytes() {
    rlimit memory{RLIM_INFINITY, RLIM_INFINITY};
    ::getrlimit(RLIMIT_AS, &memory);
    const rlim_t cores = std::max(1u, std::thread::hardware_concurrency());
    return std::clamp<rlim_t>(memory.rlim_cur / 16 / cores, kStackBytes / 16, kStackBytes);
}

constexpr const char* kCacheVariable = "POCL_CACHE_DIR";

/// Returns the folder that PoCL uses unless POCL_CACHE_DIR names another folder.
fs::path default_cache_folder() {
    const std::string home = environment_value("HOME"), cache = environment_value("XDG_CACHE_HOME");
    if (!cache.empty()) return fs::path(cache) / "pocl/kcache";
    return home.empty() ? "/tmp/pocl/kcache" : fs::path(home) / ".cache/pocl/kcache";
}

/// Returns the reason why a folder is not safe for PoCL's cache: the folder is not writable, or other users may change
/// it. Returns an empty string if it is safe. If the folder does not exist, checks the nearest existing folder above.
std::string unsafe_reason(fs::path folder) {
    std::error_code error;
    while (!fs::exists(folder, error) && folder.has_relative_path()) folder = folder.parent_path();
    if (::access(folder.c_str(), W_OK | X_OK) != 0) return fmt::format("'{}' is not writable", folder.string());
    return unsafe_path_reason(folder, {::geteuid()}, Sticky::kRefused);
}

}  // namespace

DriverCall::DriverCall(const char* operation) : outer_operation_(current_operation.exchange(operation)) {}
DriverCall::~DriverCall() { current_operation.store(outer_operation_); }

void set_crash_prefix(const std::string& prefix, double delay_s) {
    crash_prefix = {};
    prefix.copy(crash_prefix.data(), crash_prefix.size() - 1);
    crash_delay_us = static_cast<unsigned int>(delay_s * 1e6);
}

void install_crash_handlers(bool is_worker) {
    if (!is_worker) {
        std::atexit(report_driver_exit);
        for (const int signal : kCrashSignals) handle_signal(signal, report_driver_crash);
    }
    static AlternateStack signal_stack;
    const stack_t alternate{signal_stack.data(), 0, signal_stack.size()};
    ::sigaltstack(&alternate, nullptr);
    rlimit stack{};  // limit of this thread's stack, on which PoCL's basic device runs kernels
    ::getrlimit(RLIMIT_STACK, &stack);
    stack.rlim_cur = std::min<rlim_t>(stack.rlim_max, thread_stack_bytes());
    ::setrlimit(RLIMIT_STACK, &stack);
    // PoCL runs kernels in threads that it creates with default attributes, and puts the private memory of a whole
    // work-group on the stack. Such a frame may be larger than the default guard page and would write into the next
    // thread's stack.
    pthread_attr_t large_stack;
    ::pthread_attr_init(&large_stack);
    ::pthread_attr_setstacksize(&large_stack, thread_stack_bytes());
    ::pthread_attr_setguardsize(&large_stack, thread_stack_bytes());
    ::pthread_setattr_default_np(&large_stack);
    ::pthread_attr_destroy(&large_stack);
}

void set_driver_cache_folder() {
    if (!environment_value(kCacheVariable).empty()) return;
    // PoCL gets the resolved path that was checked, because a symbolic link could be changed after the check.
    std::error_code error;
    fs::path folder = fs::weakly_canonical(fs::absolute(default_cache_folder(), error), error);
    const std::string reason = error ? default_cache_folder().string() + ": " + error.message() : unsafe_reason(folder);
    if (!reason.empty()) {
        const fs::path temporary = fs::canonical(fs::temp_directory_path(error), error);
        folder = (error ? "/tmp" : temporary) / fmt::format("raya-pocl-cache-{}", ::geteuid());
        ::mkdir(folder.c_str(), S_IRWXU);
        if (const std::string why = unsafe_reason(folder); !why.empty())
            throw DeviceError(
                fmt::format("no safe folder for PoCL's kernel cache: {}; {}; name one in POCL_CACHE_DIR", reason, why));
        warn(fmt::format("warning: {}: PoCL keeps its kernels in {}; set POCL_CACHE_DIR to use another folder", reason,
                         folder.string()));
    }
    ::setenv(kCacheVariable, folder.c_str(), 1);
}

std::string driver_cache_problem() {
    constexpr std::size_t kProbeBytes = 1 << 20;  // more than a compiled kernel takes
    const fs::path folder = environment_value(kCacheVariable), probe = folder / fmt::format("raya-{}", ::getpid());
    try {
        std::error_code error;
        fs::create_directories(folder, error);
        write_whole_file(probe, std::string(kProbeBytes, 'x'));
        fs::remove(probe, error);
        return {};
    } catch (const UserError& error) {
        return fmt::format("PoCL's kernel cache (POCL_CACHE_DIR={}): {}", folder.string(), error.what());
    }
}

DeviceSearch::DeviceSearch() {
    is_searching = true;
    try {
        warning_ = call_after(kLongSearch_s, [] {
            warn(std::string("warning: the OpenCL drivers need long to list their devices; one may hang") + kLeaveOut);
        });
    } catch (const std::system_error&) {  // the system allows no more threads
    }
}

DeviceSearch::~DeviceSearch() { is_searching = false; }

}  // namespace raya
