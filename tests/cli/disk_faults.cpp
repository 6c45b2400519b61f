// A disk that is full: preloaded into raya (LD_PRELOAD), it lets files of one folder take so many bytes and no more.
//   RAYA_FULL_DISK="1000000 /folder"    the files that are written there get 1,000,000 bytes together, then write()
//   fails with ENOSPC
//   RAYA_FULL_DISK="write /folder"      a write() there does half of its work and then does not return
//   RAYA_FULL_DISK="rename /folder"     a rename() there does not return
// As on a real disk the last write that finds room is cut short. Small disks can be mounted by root alone, and not in
// every container.
#include <dlfcn.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <climits>
#include <cstdio>
#include <cstdlib>
#include <string>

namespace {

struct Disk {
    std::string folder;  // ends in a slash; empty: no disk is full
    std::atomic<long long> room{0};
    std::string stuck;  // the call that does not return

    Disk() {
        const char* text = std::getenv("RAYA_FULL_DISK");
        if (text == nullptr) return;
        const std::string all = text;
        const std::size_t space = all.find(' ');
        room = std::atoll(text);
        if (room == 0) stuck = all.substr(0, space);
        folder = all.substr(space + 1) + "/";
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

[[noreturn]] void stay() {
    for (;;) ::pause();
}

}  // namespace

extern "C" int rename(const char* from, const char* to) noexcept {
    if (disk().stuck == "rename" && std::string(to).find(disk().folder) == 0) stay();
    return reinterpret_cast<decltype(&::rename)>(::dlsym(RTLD_NEXT, "rename"))(from, to);
}

extern "C" ssize_t write(int descriptor, const void* bytes, std::size_t count) {
    static const auto real = reinterpret_cast<decltype(&::write)>(::dlsym(RTLD_NEXT, "write"));
    if (!is_there(descriptor)) return real(descriptor, bytes, count);
    if (disk().stuck == "rename") return real(descriptor, bytes, count);
    if (disk().stuck == "write" && real(descriptor, bytes, count / 2) >= 0) stay();
    const long long room = disk().room;
    if (room <= 0 && count > 0) {
        errno = ENOSPC;
        return -1;
    }
    const ssize_t written = real(descriptor, bytes, std::min(count, static_cast<std::size_t>(room)));
    disk().room -= std::max<ssize_t>(written, 0);
    return written;
}
