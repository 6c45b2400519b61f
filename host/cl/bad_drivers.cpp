#include "host/cl/bad_drivers.hpp"

#include <fcntl.h>
#include <fmt/core.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <list>
#include <string>
#include <vector>

#include "host/base/child_process.hpp"
#include "host/base/clock.hpp"
#include "host/base/log.hpp"
#include "host/base/standard_streams.hpp"

namespace raya {
namespace {

namespace fs = std::filesystem;

// After 4 s the program starts again; then the drivers have as much time. A driver that takes longer is left out only
// if another one answers.
constexpr unsigned kLimit_s = 4;
constexpr const char *kDrivers = "OCL_ICD_VENDORS", *kRestarted = "RAYA_RESTARTED";

// What execve() needs in a signal handler. No arguments: there is no restart.
std::vector<char*> arguments, environment;
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
    ::execve("/proc/self/exe", arguments.data(), environment.data());
}

void replace_handlers(void (*old_handler)(int), void (*new_handler)(int)) {
    for (const int crash : kCrashSignals) {
        struct sigaction action {};
        if (::sigaction(crash, nullptr, &action) == 0 && action.sa_handler == old_handler)
            std::signal(crash, new_handler);
    }
}

std::vector<fs::path> driver_files() {
    const char* const named = std::getenv(kDrivers);
    std::vector<fs::path> files;
    std::error_code error;
    for (const auto& entry : fs::directory_iterator(named != nullptr ? named : "/etc/OpenCL/vendors", error))
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
    const char* const named = std::getenv(kDrivers);
    const std::string before = named != nullptr ? named : "";
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
    for (char** argument = argv; *argument != nullptr; ++argument) arguments.push_back(*argument);
    arguments.push_back(nullptr);
    for (char** variable = environ; *variable != nullptr; ++variable) environment.push_back(*variable);
    static std::string restarted = std::string(kRestarted) + "=1";
    environment.push_back(restarted.data());
    environment.push_back(nullptr);
    kept_descriptor = kept;
}

Discovery::Discovery() {
    if (discoveries++ > 0 || arguments.empty()) return;
    // The crashes of a worker; other processes have handlers, which call restart_after_crash().
    replace_handlers(SIG_DFL, restart);
    std::signal(SIGALRM, restart);
    ::alarm(kLimit_s);
}

Discovery::~Discovery() {
    if (--discoveries > 0 || arguments.empty()) return;
    ::alarm(0);
    replace_handlers(restart, SIG_DFL);
}

void restart_after_crash() {
    if (discoveries > 0 && !arguments.empty()) restart(SIGALRM);
}

}  // namespace raya
