#include "host/cl/driver.hpp"

#include <fcntl.h>
#include <fmt/core.h>
#include <pthread.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <list>
#include <system_error>
#include <thread>
#include <vector>

#include "host/base/child_process.hpp"
#include "host/base/encoding.hpp"
#include "host/base/interruption.hpp"
#include "host/base/log.hpp"
#include "host/base/module.hpp"
#include "host/base/whole_file.hpp"
#include "host/error.hpp"

namespace raya {

namespace fs = std::filesystem;
namespace {

std::atomic<const char*> current_operation{nullptr};
static_assert(std::atomic<const char*>::is_always_lock_free);

std::array<char, 300> crash_prefix{};  // "rank 1 on node7: ", or empty
unsigned int crash_delay_us = 0;

// Size of a thread's stack in bytes: more than the largest stack frame measured for a work-group, 88 MB (1,024
// work-items of 16 lanes with a grid and 31 bounces).
constexpr std::size_t kStackBytes = std::size_t{128} << 20;
// Stack on which signal handlers of the first thread run. LLVM would replace a smaller stack by its own.
using AlternateStack = std::array<std::byte, 80 << 10>;

/// Writes `text` to stderr. Async-signal-safe.
void write_message(const char* text) {
    if (::write(STDERR_FILENO, text, std::strlen(text)) < 0) return;  // stderr is closed: the message is lost
}

extern "C" void report_driver_crash(int signal) {
    static std::atomic<pid_t> crashed_thread{0};
    const pid_t thread = ::gettid();
    pid_t first_thread = 0;
    if (!crashed_thread.compare_exchange_strong(first_thread, thread) && first_thread != thread)
        for (;;) ::pause();  // another thread crashed first: it ends the process
    remove_files_in_progress();
    const char* operation = current_operation.load();
    if (operation == nullptr && thread != ::getpid()) operation = "running a kernel";  // probably a driver's thread
    if (first_thread == 0) restart_after_crash();
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
        "; remedy: smaller work-groups (--group) or fewer lanes (--lanes), an empty folder as POCL_CACHE_DIR in case "
        "the cache is damaged, more memory (ulimit -v), a mounted /sys, or another driver (raya devices); raya verify "
        "shows the driver's errors\n");
    ::_exit(kExitDeviceError);
}

/// Runs at exit(). PoCL's LLVM calls exit() if the disk with the kernel cache is full.
void report_driver_exit() {
    const char* const operation = current_operation.load();
    if (operation == nullptr) return;
    remove_files_in_progress();
    for (const char* text :
         {"\nraya: ", static_cast<const char*>(crash_prefix.data()), "the OpenCL driver ended the program while ",
          operation, "; remedy: free some space for PoCL's kernels, or name another folder in POCL_CACHE_DIR\n"})
        write_message(text);
    ::_exit(kExitDeviceError);
}

/// Replaces the signal's handler, if it is `old_handler`, by `new_handler`.
void replace_handler(int signal, void (*old_handler)(int), void (*new_handler)(int)) {
    struct sigaction action {};
    if (::sigaction(signal, nullptr, &action) != 0 || action.sa_handler != old_handler) return;
    action.sa_handler = new_handler;
    action.sa_flags = SA_NODEFER | SA_ONSTACK;
    ::sigaction(signal, &action, nullptr);
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

/// Creates a folder that only this user may access. Returns true if the folder then belongs to this user and has these
/// permissions; another user may have created it before.
bool make_private_folder(const fs::path& folder) {
    struct stat status {};
    ::mkdir(folder.c_str(), S_IRWXU);
    return ::lstat(folder.c_str(), &status) == 0 && S_ISDIR(status.st_mode) && status.st_uid == ::geteuid() &&
           (status.st_mode & ACCESSPERMS) == S_IRWXU;
}

/// In the folder for temporary files, creates a folder that only this user may access, and returns its path. Throws
/// DeviceError if that fails. `reason`, for the error message: why PoCL's default folder is not safe.
fs::path private_cache_folder(const std::string& reason) {
    std::error_code error;
    fs::path temporary = fs::canonical(fs::temp_directory_path(error), error);
    if (error) temporary = "/tmp";
    const std::string base_path = temporary / fmt::format("raya-pocl-cache-{}", ::geteuid());
    if (unsafe_path_reason(temporary, {::geteuid()}, Sticky::kAllowed).empty())
        for (const char* suffix : {"", "-1", "-2", "-3", "-4", "-5", "-6", "-7", "-8", "-9"})
            if (make_private_folder(base_path + suffix)) return base_path + suffix;
    throw DeviceError(fmt::format(
        "no safe folder for PoCL's kernel cache: {0}; none of the folders '{1}', '{1}-1', ... '{1}-9' can be "
        "restricted to this user; name another folder in POCL_CACHE_DIR",
        reason, base_path));
}

}  // namespace

DriverCall::DriverCall(const char* operation) : outer_operation_(current_operation.exchange(operation)) {}
DriverCall::~DriverCall() { current_operation.store(outer_operation_); }

void set_crash_prefix(const std::string& prefix, double delay_s) {
    crash_prefix = {};
    prefix.copy(crash_prefix.data(), crash_prefix.size() - 1);
    crash_delay_us = static_cast<unsigned int>(delay_s * 1e6);
}

void install_crash_handlers() {
    std::atexit(report_driver_exit);
    for (const int signal : kCrashSignals) {
        replace_handler(signal, SIG_DFL, report_driver_crash);
        if (signal != SIGFPE) protect_handler(signal);  // PoCL's SIGFPE handler lets kernels continue after x / 0
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

void remove_crash_handlers() {
    for (const int signal : kCrashSignals) {
        unprotect_handler(signal);
        replace_handler(signal, report_driver_crash, SIG_DFL);
    }
}

void set_driver_cache_folder() {
    if (!environment_value(kCacheVariable).empty()) return;
    std::error_code error;
    const fs::path preferred = fs::weakly_canonical(fs::absolute(default_cache_folder(), error), error);
    const std::string reason =
        error ? fmt::format("'{}': {}", default_cache_folder().string(), error.message()) : unsafe_reason(preferred);
    // PoCL gets the resolved path that was checked, because a symbolic link could be changed after the check.
    const fs::path chosen = reason.empty() ? preferred : private_cache_folder(reason);
    ::setenv(kCacheVariable, chosen.c_str(), 1);
    if (!reason.empty())
        warn(fmt::format("warning: {}: PoCL keeps its kernels in {}; set POCL_CACHE_DIR to use another folder", reason,
                         chosen.string()));
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

namespace {

// After 4 s the program starts again; then the drivers have as much time. A driver that takes longer is left out only
// if another one answers.
constexpr unsigned kLimit_s = 4;
constexpr const char *kDrivers = "OCL_ICD_VENDORS", *kRestarted = "RAYA_RESTARTED";

// What execve() needs in a signal handler. Empty: there is no restart.
std::vector<char*> restart_arguments, restart_environment;
int kept_descriptor = -1;
std::atomic<int> discoveries = 0;

extern "C" void restart(int signal) {
    if (discoveries == 0) {  // LLVM has kept this handler, and calls it for a later crash
        std::signal(signal, SIG_DFL);
        ::raise(signal);
        return;
    }
    sigset_t none;  // execve() keeps the signals that are blocked in a handler
    ::sigemptyset(&none);
    ::sigprocmask(SIG_SETMASK, &none, nullptr);
    restore_stdout();
    if (kept_descriptor >= 0) ::fcntl(kept_descriptor, F_SETFD, 0);
    ::execve("/proc/self/exe", restart_arguments.data(), restart_environment.data());
}

void replace_handlers(void (*old_handler)(int), void (*new_handler)(int)) {
    for (const int crash : kCrashSignals) {
        struct sigaction action {};
        if (::sigaction(crash, nullptr, &action) == 0 && action.sa_handler == old_handler)
            std::signal(crash, new_handler);
    }
}

std::vector<fs::path> driver_files() {
    const std::string named = environment_value(kDrivers);
    std::vector<fs::path> files;
    std::error_code error;
    for (const auto& entry : fs::directory_iterator(named.empty() ? "/etc/OpenCL/vendors" : named, error))
        if (entry.path().extension() == ".icd") files.push_back(entry.path());
    std::ranges::sort(files);
    return files;
}

void leave_out_bad_drivers() {
    struct Driver {
        explicit Driver(const fs::path& named) : file(named) {}
        fs::path file;
        ChildProcess process{kDiscoveryTask, {{"driver", file.string()}}};
    };
    std::list<Driver> asked;
    std::vector<fs::path> good, bad;
    const std::string before = environment_value(kDrivers);
    for (const fs::path& file : driver_files()) {
        ::setenv(kDrivers, file.c_str(), 1);
        asked.emplace_back(file);
    }
    before.empty() ? ::unsetenv(kDrivers) : ::setenv(kDrivers, before.c_str(), 1);
    const Clock::time_point deadline = Clock::now() + std::chrono::seconds(kLimit_s);
    for (Driver& driver : asked) {
        const auto left = std::chrono::ceil<std::chrono::milliseconds>(deadline - Clock::now());
        std::string line;
        const bool answers =
            driver.process.read(line, std::max(left, std::chrono::milliseconds(1))) == ChildProcess::Read::kLine;
        (answers ? good : bad).push_back(driver.file);
    }
    if (good.empty() || bad.empty()) return;
    static const TemporaryFolder folder("raya-drivers");  // deleted when the program ends
    for (const fs::path& file : good) fs::create_symlink(fs::absolute(file), folder / file.filename().string());
    ::setenv(kDrivers, folder.path().c_str(), 1);
    for (const fs::path& file : bad)
        warn(
            fmt::format("warning: the OpenCL driver {} hangs or crashes when it is asked for its devices, and is left "
                        "out; remedy: remove or update it, or set OCL_ICD_VENDORS",
                        file.string()));
}

}  // namespace

void restart_without_bad_drivers(char** argv, int kept) {
    if (std::getenv(kRestarted) != nullptr) {
        ::unsetenv(kRestarted);
        return leave_out_bad_drivers();
    }
    for (char** argument = argv; *argument != nullptr; ++argument) restart_arguments.push_back(*argument);
    restart_arguments.push_back(nullptr);
    for (char** variable = environ; *variable != nullptr; ++variable) restart_environment.push_back(*variable);
    static std::string restarted = std::string(kRestarted) + "=1";
    restart_environment.push_back(restarted.data());
    restart_environment.push_back(nullptr);
    kept_descriptor = kept;
}

Discovery::Discovery() {
    if (discoveries++ > 0 || restart_arguments.empty()) return;
    // The crashes of a worker; other processes have handlers, which call restart_after_crash().
    replace_handlers(SIG_DFL, restart);
    std::signal(SIGALRM, restart);
    ::alarm(kLimit_s);
}

Discovery::~Discovery() {
    if (--discoveries > 0 || restart_arguments.empty()) return;
    ::alarm(0);
    replace_handlers(restart, SIG_DFL);
}

void restart_after_crash() {
    if (discoveries > 0 && !restart_arguments.empty()) restart(SIGALRM);
}

}  // namespace raya
