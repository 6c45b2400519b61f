// A disk that is full: preloaded into raya (LD_PRELOAD), it lets files of one folder take so many bytes and no more.
//   RAYA_FULL_DISK="1000000 /folder"    the files that are written there get 1,000,000 bytes together, then write()
//   fails with ENOSPC
// As on a real disk the last write that finds room is cut short. Small disks can be mounted by root alone, and not in
// every container.
#include <dlfcn.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <climits>
#include <cstdlib>
#include <string>

namespace {

struct Disk {
    std::string folder;  // ends in a slash; empty: no disk is full
    std::atomic<long long> room{0};

    Disk() {
        const char* text = std::getenv("RAYA_FULL_DISK");
        if (text == nullptr) return;
        char* end = nullptr;
        room = std::strtoll(text, &end, 10);
        folder = std::string(end + (*end == ' ')) + "/";
    }
};

Disk& disk() {
    static Disk the_disk;
    return the_disk;
}

bool is_there(int descriptor) {
    std::array<char, PATH_MAX> name{};
    const std::string link = "/proc/self/fd/" + std::to_string(descriptor);
    const ssize_t length = ::readlink(link.c_str(), name.data(), name.size());
    const std::string path(name.data(), static_cast<std::size_t>(std::max<ssize_t>(length, 0)));
    return !disk().folder.empty() && path.compare(0, disk().folder.size(), disk().folder) == 0;
}

}  // namespace

extern "C" ssize_t write(int descriptor, const void* bytes, std::size_t count) {
    static const auto real = reinterpret_cast<decltype(&::write)>(::dlsym(RTLD_NEXT, "write"));
    if (!is_there(descriptor)) return real(descriptor, bytes, count);
    const long long room = disk().room;
    if (room <= 0 && count > 0) {
        errno = ENOSPC;
        return -1;
    }
    const ssize_t written = real(descriptor, bytes, std::min(count, static_cast<std::size_t>(room)));
    disk().room -= std::max<ssize_t>(written, 0);
    return written;
}
