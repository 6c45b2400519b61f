// Fault injection into file writes: a library that is preloaded into raya (LD_PRELOAD).
//   RAYA_FULL_DISK="1000000 /folder"    the files in this folder have space for 1,000,000 bytes in total. The write()
//                                       that exceeds the space writes the bytes that fit; later calls fail with ENOSPC.
//   RAYA_FULL_DISK="write /folder"      a write() to a file in this folder writes half of its bytes, then blocks
//   RAYA_FULL_DISK="rename /folder"     a rename() to a file in this folder blocks
//   RAYA_WRITE_FAULT="17 28"            the 17th of raya's writing calls (below) fails with errno 28 (ENOSPC)
//   RAYA_WRITE_FAULT="17 short"         the 17th of raya's writing calls writes half its bytes
//   RAYA_WRITE_CALLS=FILE               appends a line to FILE for each writing call: its name, and "fails" if it fails
// Writing calls: calls that raya or the C++ library, but not a driver, makes to the functions at the end of this file.
// The library simulates a full disk, because only root can mount a small file system.
#include <dlfcn.h>
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <climits>
#include <cstdarg>
#include <cstdlib>
#include <string>

#include "tests/cli/calling_module.hpp"

namespace {

struct Disk {
    std::string folder;  // ends in a slash; empty: no fault
    std::atomic<long long> free_bytes{0};
    std::string blocking_call;  // "write", "rename" or empty

    Disk() {
        const char* text = std::getenv("RAYA_FULL_DISK");
        if (text == nullptr) return;
        const std::string setting = text;
        const std::size_t blank_at = setting.find(' ');
        free_bytes = std::atoll(text);
        if (free_bytes == 0) blocking_call = setting.substr(0, blank_at);
        folder = setting.substr(blank_at + 1) + "/";
    }
};

Disk& disk() {
    static Disk instance;
    return instance;
}

/// Returns true if the file is in the folder of RAYA_FULL_DISK.
bool is_in_folder(int descriptor) {
    std::array<char, PATH_MAX> name{};
    const std::string link = "/proc/self/fd/" + std::to_string(descriptor);
    const ssize_t length = ::readlink(link.c_str(), name.data(), name.size());
    const std::string path(name.data(), static_cast<std::size_t>(std::max<ssize_t>(length, 0)));
    return !disk().folder.empty() && path.compare(0, disk().folder.size(), disk().folder) == 0;
}

[[noreturn]] void block() {
    for (;;) ::pause();
}

template <class Function>
Function* library_function(const char* name, Function*) {
    return reinterpret_cast<Function*>(::dlsym(RTLD_NEXT, name));
}

struct WriteFault {
    long number = 0;  // number of the failing call from 1; 0: none
    int error = 0;    // errno of the failing call
    bool is_short = false;

    WriteFault() {
        const char* text = std::getenv("RAYA_WRITE_FAULT");
        if (text == nullptr) return;
        char* end = nullptr;
        number = std::strtol(text, &end, 10);
        error = std::atoi(end);
        is_short = error == 0;
    }
};

const WriteFault& write_fault() {
    static const WriteFault fault;
    return fault;
}

void record_call(const char* call, bool fails) {
    static const char* const file = std::getenv("RAYA_WRITE_CALLS");
    if (file == nullptr) return;
    const int descriptor = library_function("open", &::open)(file, O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0666);
    const std::string line = std::string(call) + (fails ? " fails\n" : "\n");
    library_function("write", &::write)(descriptor, line.data(), line.size());
    library_function("close", &::close)(descriptor);
}

bool is_call_by_raya(const void* caller) {
    std::uintptr_t base = 0;
    const char* const module = raya::module_of(reinterpret_cast<std::uintptr_t>(caller) - 1, base);
    return module != nullptr && (raya::is_raya(module) || raya::begins_with(module, "libstdc++"));
}

/// Counts a call by raya or the C++ library and returns true if it must fail. Calls by other libraries are not counted
/// and do not fail. A short write or EINTR is injected only into calls whose manual page (section 2) documents it.
bool fails(const char* call, const void* caller, bool can_be_short, bool can_be_interrupted) {
    static std::atomic<long> calls{0};
    if (!is_call_by_raya(caller)) return false;
    const WriteFault& fault = write_fault();
    const bool fails_now =
        ++calls == fault.number && (!fault.is_short || can_be_short) && (fault.error != EINTR || can_be_interrupted);
    record_call(call, fails_now);
    if (fails_now) errno = fault.error;
    return fails_now;
}

/// Returns true if the descriptor refers to a regular file other than the one to which stderr is redirected.
bool is_file(int descriptor) {
    struct stat status {
    }, stderr_status{};
    const int saved_errno = errno;
    const bool is_regular = ::fstat(descriptor, &status) == 0 && S_ISREG(status.st_mode);
    const bool is_stderr = ::fstat(STDERR_FILENO, &stderr_status) == 0 && stderr_status.st_ino == status.st_ino;
    errno = saved_errno;
    return is_regular && !is_stderr;
}

bool is_open_for_writing(int descriptor) {
    return is_file(descriptor) && (::fcntl(descriptor, F_GETFL) & O_ACCMODE) != O_RDONLY;
}

bool opens_for_writing(int flags) { return (flags & O_ACCMODE) != O_RDONLY || (flags & O_CREAT) != 0; }

ssize_t write_within_limits(int descriptor, const void* bytes, std::size_t count) {
    static auto* const next = library_function("write", &::write);
    if (!is_in_folder(descriptor) || disk().blocking_call == "rename") return next(descriptor, bytes, count);
    if (disk().blocking_call == "write" && next(descriptor, bytes, count / 2) >= 0) block();
    const long long free_bytes = disk().free_bytes;
    if (free_bytes <= 0 && count > 0) {
        errno = ENOSPC;
        return -1;
    }
    const ssize_t written = next(descriptor, bytes, std::min(count, static_cast<std::size_t>(free_bytes)));
    disk().free_bytes -= std::max<ssize_t>(written, 0);
    return written;
}

}  // namespace

#define CALLER __builtin_return_address(0)

extern "C" {

ssize_t write(int descriptor, const void* bytes, std::size_t count) {
    if (is_file(descriptor) && fails("write", CALLER, count > 1, true)) {
        if (!write_fault().is_short) return -1;
        count /= 2;
    }
    return write_within_limits(descriptor, bytes, count);
}

int open(const char* path, int flags, ...) {
    std::va_list mode_argument;
    va_start(mode_argument, flags);
    const mode_t mode = (flags & O_CREAT) != 0 ? va_arg(mode_argument, mode_t) : 0;
    va_end(mode_argument);
    if (opens_for_writing(flags) && fails("open", CALLER, false, true)) return -1;
    return library_function("open", &::open)(path, flags, mode);
}

int close(int descriptor) {
    const bool must_fail = is_open_for_writing(descriptor) && fails("close", CALLER, false, true);
    const int error = errno;
    const int result = library_function("close", &::close)(descriptor);  // also if the call must fail
    if (!must_fail) return result;
    errno = error;
    return -1;
}

int rename(const char* from, const char* to) noexcept {
    if (disk().blocking_call == "rename" && std::string(to).find(disk().folder) == 0) block();
    return fails("rename", CALLER, false, false) ? -1 : library_function("rename", &::rename)(from, to);
}

char* mkdtemp(char* path) noexcept {
    return fails("mkdtemp", CALLER, false, false) ? nullptr : library_function("mkdtemp", &::mkdtemp)(path);
}

}  // extern "C"
