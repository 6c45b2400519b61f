#include "host/base/read_file.hpp"

#include <fcntl.h>
#include <fmt/core.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <system_error>

#include "host/base/standard_streams.hpp"

namespace raya {
namespace {

[[noreturn]] void refuse(int error) { throw UnreadableFile(std::generic_category().message(error)); }

struct Descriptor {
    int number;
    ~Descriptor() { ::close(number); }
};

void check_kind(const struct stat& status, Pipes pipes) {
    if (S_ISDIR(status.st_mode)) throw UnreadableFile("it is a directory, not a file");
    if (S_ISFIFO(status.st_mode) && pipes == Pipes::kRefused) throw UnreadableFile("it is a pipe, not a regular file");
    if (!S_ISREG(status.st_mode) && !S_ISFIFO(status.st_mode)) throw UnreadableFile("not a regular file");
}

// `expected` bytes may be wrong.
std::string read_all(int descriptor, std::uint64_t expected, std::uint64_t most) {
    constexpr std::size_t kBlock = 1 << 16;
    std::string bytes(static_cast<std::size_t>(std::min(expected, most)) + 1, '\0');  // the last finds the end
    for (std::size_t end = 0;;) {
        if (end > most) throw UnreadableFile(fmt::format("larger than {} bytes", most));
        if (end == bytes.size()) bytes.resize(end + std::max(end, kBlock));
        const ssize_t got = ::read(descriptor, bytes.data() + end, bytes.size() - end);
        if (got < 0 && errno != EINTR) refuse(errno);
        end += static_cast<std::size_t>(std::max<ssize_t>(got, 0));
        if (got != 0) continue;
        bytes.resize(end);
        return bytes;
    }
}

}  // namespace

std::string read_file(const std::filesystem::path& path, Pipes pipes, std::uint64_t most) {
    if (is_standard_stream(path)) return read_all(take_stdin(), 0, most);
    struct stat status {};
    if (::stat(path.c_str(), &status) != 0) refuse(errno);
    check_kind(status, pipes);  // before it is opened, which waits for a pipe's other end
    const Descriptor file{::open(path.c_str(), O_RDONLY | O_CLOEXEC)};
    if (file.number < 0) refuse(errno);
    return read_all(file.number, static_cast<std::uint64_t>(status.st_size), most);
}

}  // namespace raya
