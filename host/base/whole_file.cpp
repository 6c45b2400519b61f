#include "host/base/whole_file.hpp"

#include <fcntl.h>
#include <fmt/core.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstdio>
#include <map>
#include <memory>
#include <mutex>
#include <system_error>
#include <utility>

#include "host/base/interruption.hpp"
#include "host/base/log.hpp"
#include "host/error.hpp"

namespace raya {

namespace fs = std::filesystem;
namespace {

/// Names in messages: of inputs, by file_version(), and of promised outputs, by file_identity().
struct UsedFiles {
    std::mutex mutex;
    std::map<std::string, std::string> inputs, outputs;
};

UsedFiles& used_files() {
    static UsedFiles files;
    return files;
}

/// Returns a text that identifies a regular file and its contents: device, inode, and time of the last change, because
/// a new file may get the inode of a deleted one. Empty if there is no such file.
std::string file_version(const fs::path& path) {
    struct stat s {};
    if (::stat(path.c_str(), &s) != 0 || !S_ISREG(s.st_mode)) return "";
    return fmt::format("{}:{}:{}.{}", s.st_dev, s.st_ino, s.st_ctim.tv_sec, s.st_ctim.tv_nsec);
}

/// Throws UserError if the output `name` is the input `version`. Call with the lock held.
void refuse_input(const UsedFiles& files, const std::string& version, const std::string& name) {
    if (const auto input = files.inputs.find(version); input != files.inputs.end())
        throw UserError(fmt::format("{}: would overwrite the input {}; name another file", name, input->second));
}

[[noreturn]] void refuse_to_read(int error) { throw UnreadableFile(std::generic_category().message(error)); }

struct Descriptor {
    int number;
    ~Descriptor() { ::close(number); }
};

void check_kind(const struct stat& status, Pipes pipes) {
    if (S_ISDIR(status.st_mode)) throw UnreadableFile("it is a directory, not a file");
    if (S_ISFIFO(status.st_mode) && pipes == Pipes::kRefused) throw UnreadableFile("it is a pipe, not a regular file");
    if (!S_ISREG(status.st_mode) && !S_ISFIFO(status.st_mode)) throw UnreadableFile("not a regular file");
}

// Reads to the end of the file. `expected_bytes` is only the initial buffer size: the file may grow or shrink.
std::string read_all(int descriptor, std::uint64_t expected_bytes, std::uint64_t max_bytes) {
    constexpr std::size_t kBlock = 1 << 16;
    // One byte more than expected, so that the read() that detects the end of the file needs no larger buffer.
    std::string bytes(static_cast<std::size_t>(std::min(expected_bytes, max_bytes)) + 1, '\0');
    for (std::size_t end = 0;;) {
        if (end > max_bytes) throw UnreadableFile(fmt::format("larger than {} bytes", max_bytes));
        if (end == bytes.size()) bytes.resize(end + std::max(end, kBlock));
        const ssize_t read_bytes = ::read(descriptor, bytes.data() + end, bytes.size() - end);
        if (read_bytes < 0 && errno != EINTR) refuse_to_read(errno);
        end += static_cast<std::size_t>(std::max<ssize_t>(read_bytes, 0));
        if (read_bytes != 0) continue;
        bytes.resize(end);
        return bytes;
    }
}

constexpr mode_t kFileMode = 0666;  // mode of a new file, before the user's umask applies

[[noreturn]] void refuse(const fs::path& path, std::string_view reason, std::string_view remedy) {
    throw UserError(fmt::format("cannot write '{}': {}; {}", output_name(path), reason, remedy));
}

std::string_view remedy_for(int error) {
    switch (error) {
        case ENOSPC:
        case EDQUOT:
            return "free some space there or name a file on another disk";
        case EFBIG:
            return "raise the limit on the size of files (ulimit -f) or ask for a smaller file";
        case EACCES:
        case EPERM:
        case EROFS:
            return "name a file in a folder that you may write to";
        default:
            return "name another file";
    }
}

[[noreturn]] void refuse(const fs::path& path, int error) {
    refuse(path, std::generic_category().message(error), remedy_for(error));
}

bool has_access(const fs::path& path, int mode) { return ::faccessat(AT_FDCWD, path.c_str(), mode, AT_EACCESS) == 0; }

fs::path folder_of(const fs::path& path) { return path.has_parent_path() ? path.parent_path() : fs::path("."); }

void check_output_folder(const fs::path& path, const fs::path& folder) {
    std::error_code error;
    const fs::file_status status = fs::status(folder, error);
    if (status.type() == fs::file_type::not_found)
        refuse(path, fmt::format("the folder '{}' does not exist", folder.string()),
               "make it first (mkdir -p) or name another file");
    if (error) refuse(path, error.value());
    if (!fs::is_directory(status))
        refuse(path, fmt::format("'{}' is not a folder", folder.string()), "name a file in another folder");
    if (!has_access(folder, W_OK | X_OK))
        refuse(path, fmt::format("the folder '{}' is not writable", folder.string()),
               "change its permissions or name a file in another folder");
}

/// The file to which write_whole_file() writes.
struct Target {
    fs::path file;        // symbolic links resolved
    bool direct = false;  // written without a temporary file, because it is a device, a pipe or stdout
};

/// Follows `path` as long as it is a symbolic link; the last target need not exist.
fs::path resolve_links(const fs::path& path) {
    constexpr int kMaxLinks = 40;  // Linux's own limit
    fs::path file = path;
    std::error_code error;
    for (int links = 0; fs::is_symlink(fs::symlink_status(file, error)); ++links) {
        if (links == kMaxLinks) refuse(path, ELOOP);
        const fs::path named = fs::read_symlink(file, error);
        if (error) refuse(path, error.value());
        file = named.is_absolute() ? named : folder_of(file) / named;
    }
    return file;
}

Target checked_target(const fs::path& path) {
    if (path.empty()) refuse(path, "the name is empty", "name a file");
    if (is_standard_stream(path)) return {path, true};
    std::error_code error;
    const fs::file_status status = fs::status(path, error);
    if (fs::is_directory(status) || !path.has_filename()) refuse(path, "it is a folder", "name a file in it");
    if (error && status.type() != fs::file_type::not_found) refuse(path, error.value());
    const bool exists = fs::exists(status);
    if (exists && !has_access(path, W_OK))
        refuse(path, "the file exists and is not writable", "change its permissions or name another file");
    if (exists && !fs::is_regular_file(status)) return {path, true};
    const fs::path file = resolve_links(path);
    check_output_folder(path, folder_of(file));
    const fs::path folder = fs::canonical(folder_of(file), error);
    if (error) refuse(path, error.value());
    return {folder / file.filename(), false};
}

using NextPiece = std::function<std::string_view()>;

/// Writes all pieces to the descriptor and closes it. Returns 0 or the errno of the failed call.
int write_and_close(int descriptor, const NextPiece& next_piece) {
    int error = 0;
    for (std::string_view bytes = next_piece(); !bytes.empty() && error == 0;) {
        const ssize_t written = ::write(descriptor, bytes.data(), bytes.size());
        if (written >= 0)
            bytes.remove_prefix(static_cast<std::size_t>(written));
        else if (errno != EINTR)
            error = errno;
        if (bytes.empty()) bytes = next_piece();
    }
    // Network file systems may report a full disk only in close(). After EINTR Linux has closed the descriptor.
    if (::close(descriptor) != 0 && error == 0 && errno != EINTR) error = errno;
    return error;
}

/// A new file in the folder of the target. Unless it is renamed, the destructor or an interruption deletes it. Its name
/// does not contain the target's name, so that it cannot exceed the maximum length of a file name.
struct TemporaryFile {
    fs::path path;
    FileInProgress in_progress;  // constructed before the file is created: an interruption may come at any time
    int descriptor;
    bool renamed = false;

    explicit TemporaryFile(const fs::path& name)
        : path(name),
          in_progress(path),
          descriptor(::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, kFileMode)) {}
    ~TemporaryFile() {
        if (descriptor >= 0 && !renamed) ::unlink(path.c_str());
    }
};

std::unique_ptr<TemporaryFile> open_temporary(const fs::path& target, const fs::path& named_path) {
    static std::atomic<unsigned> counter{0};
    while (true) {
        auto file =
            std::make_unique<TemporaryFile>(folder_of(target) / fmt::format(".raya-{}-{}.tmp", ::getpid(), counter++));
        if (file->descriptor >= 0) return file;
        if (errno != EEXIST && errno != EINTR) refuse(named_path, errno);
    }
}

void write_direct(const fs::path& path, const NextPiece& next_piece) {
    const int descriptor = is_standard_stream(path) ? take_stdout() : ::open(path.c_str(), O_WRONLY | O_CLOEXEC);
    if (descriptor < 0 && errno == EINTR) return write_direct(path, next_piece);  // open() waits for a pipe's reader
    if (descriptor < 0) refuse(path, errno);
    if (const int error = write_and_close(descriptor, next_piece)) refuse(path, error);
}

}  // namespace

std::string read_file(const std::filesystem::path& path, Pipes pipes, std::uint64_t max_bytes) {
    if (is_standard_stream(path)) return read_all(take_stdin(), 0, max_bytes);
    struct stat status {};
    if (::stat(path.c_str(), &status) != 0) refuse_to_read(errno);
    check_kind(status, pipes);  // before open(), which would wait for the other end of a pipe
    const Descriptor file{::open(path.c_str(), O_RDONLY | O_CLOEXEC)};
    if (file.number < 0) refuse_to_read(errno);
    return read_all(file.number, static_cast<std::uint64_t>(status.st_size), max_bytes);
}

void register_input(const fs::path& path, const std::string& name) {
    const fs::path file = is_standard_stream(path) ? "/dev/stdin" : path;
    const std::string version = file_version(file);
    if (version.empty()) return;
    UsedFiles& files = used_files();
    const std::lock_guard lock(files.mutex);
    const auto input = files.inputs.emplace(version, path.string()).first;
    if (!name.empty()) input->second = name;
    if (const auto output = files.outputs.find(file_identity(file)); output != files.outputs.end())
        refuse_input(files, version, output->second);
}

void forget_input(const fs::path& path) {
    const std::lock_guard lock(used_files().mutex);
    used_files().inputs.erase(file_version(path));
}

std::string read_input(const fs::path& path, Pipes pipes, std::uint64_t max_bytes) {
    register_input(path);
    return read_file(path, pipes, max_bytes);
}

void promise_output(const fs::path& path, const std::string& name) {
    const bool is_stdout = is_standard_stream(path);
    const fs::path file = is_stdout ? "/dev/stdout" : path;
    // If an earlier check has reserved stdout for a file, /dev/stdout refers to stderr.
    const bool is_known = !is_stdout || !stdout_is_reserved();
    std::string identity = is_known ? file_identity(file) : "";
    if (identity.empty() && is_stdout) identity = path.string();
    UsedFiles& files = used_files();
    const std::lock_guard lock(files.mutex);
    if (is_known) refuse_input(files, file_version(file), name);
    if (identity.empty()) return;
    const auto [output, is_new] = files.outputs.emplace(identity, name);
    if (is_new || output->second == name) return;
    if (is_stdout && output->second.ends_with(" -"))
        throw UserError(fmt::format("{} and {}: only one file can go to stdout; name files for the other options",
                                    output->second, name));
    throw UserError(fmt::format("{}: the same file as {}; name another file", name, output->second));
}

void forget_promised_outputs() {
    const std::lock_guard lock(used_files().mutex);
    used_files().outputs.clear();
}

void check_writable(const fs::path& path) {
    checked_target(path);
    if (is_standard_stream(path)) reserve_stdout();
}

std::string file_identity(const fs::path& path) {
    struct stat status {};
    const auto inode = [&] { return fmt::format("{}:{}", status.st_dev, status.st_ino); };
    if (::stat(path.c_str(), &status) == 0) return S_ISREG(status.st_mode) ? inode() : "";
    const fs::path file = resolve_links(path);
    if (::stat(folder_of(file).c_str(), &status) == 0) return inode() + '/' + file.filename().string();
    return fs::absolute(file).lexically_normal().string();
}

void write_whole_file(const fs::path& path, std::string_view bytes) {
    write_whole_file(path, [left = bytes]() mutable { return std::exchange(left, {}); });
}

void write_whole_file(const fs::path& path, const std::function<std::string_view()>& next_piece) {
    const Target target = checked_target(path);
    if (target.direct) return write_direct(path, next_piece);
    {
        const std::lock_guard lock(used_files().mutex);
        refuse_input(used_files(), file_version(target.file), path.string());
    }
    const auto temporary = open_temporary(target.file, path);
    if (const int error = write_and_close(temporary->descriptor, next_piece)) refuse(path, error);
    if (std::rename(temporary->path.c_str(), target.file.c_str()) != 0) refuse(path, errno);
    temporary->renamed = true;
}

namespace {

constexpr int kNotReserved = -1;
constexpr int kTaken = -2;  // take_stdout() has returned the descriptor

int reserved_stdout = kNotReserved;  // descriptor of a duplicate of stdout, or one of the two values above

}  // namespace

bool is_standard_stream(const std::filesystem::path& path) { return path.native() == "-"; }

std::string input_name(const std::filesystem::path& path) { return is_standard_stream(path) ? "stdin" : path.string(); }

std::string output_name(const std::filesystem::path& path) {
    return is_standard_stream(path) ? "stdout" : path.string();
}

int take_stdin() {
    static bool taken = false;
    if (std::exchange(taken, true))
        throw UnreadableFile("stdin can be read only once; give - once and name files for the other inputs");
    if (::isatty(STDIN_FILENO) != 0)
        print_log("raya: reading stdin from the terminal; end with Ctrl-D on a line of its own\n");
    return STDIN_FILENO;
}

void reserve_stdout() {
    if (reserved_stdout != kNotReserved) return;
    std::fflush(stdout);
    reserved_stdout = ::fcntl(STDOUT_FILENO, F_DUPFD_CLOEXEC, STDERR_FILENO + 1);
    if (reserved_stdout < 0 || TEMP_FAILURE_RETRY(::dup2(STDERR_FILENO, STDOUT_FILENO)) < 0)
        throw UserError("cannot reserve stdout for a file: " + std::generic_category().message(errno));
}

bool stdout_is_reserved() { return reserved_stdout != kNotReserved; }

int take_stdout() {
    reserve_stdout();
    const int descriptor = std::exchange(reserved_stdout, kTaken);
    if (descriptor == kTaken) throw UserError("only one file can go to stdout; name files for the other outputs");
    return descriptor;
}

void refuse_bytes_on_terminal(const std::filesystem::path& path) {
    if (!is_standard_stream(path) || ::isatty(stdout_is_reserved() ? reserved_stdout : STDOUT_FILENO) == 0) return;
    throw UserError(
        "-: stdout is a terminal and the output is binary; redirect it to a file or a program (raya ... | program)");
}

}  // namespace raya
