#include "host/base/whole_file.hpp"

#include <fcntl.h>
#include <fmt/core.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdio>
#include <map>
#include <mutex>
#include <system_error>
#include <utility>

#include "host/base/interruption.hpp"
#include "host/base/log.hpp"
#include "host/error.hpp"

namespace raya {

namespace fs = std::filesystem;
namespace {

std::string error_text(int error) { return std::generic_category().message(error); }

/// Names in messages of inputs and of promised outputs, by file_identity().
struct UsedFiles {
    std::mutex mutex;
    std::map<std::string, std::string> inputs, outputs;

    /// Throws UserError if the output `name` is an input.
    void refuse_input(const std::string& identity, const std::string& name) const {
        if (const auto input = inputs.find(identity); input != inputs.end())
            throw UserError(fmt::format("{}: would overwrite the input {}; name another file", name, input->second));
    }
};

UsedFiles& used_files() {
    static UsedFiles files;
    return files;
}

/// Returns a text that is the same for all paths of a file: device, inode and time of the last change, because a new
/// file may get the inode of a deleted one; the path, if there is no file. Empty for a device, a pipe or a folder.
std::string file_identity(const fs::path& path) {
    struct stat s {};
    if (::stat(path.c_str(), &s) != 0) {
        std::error_code error;
        return fs::weakly_canonical(fs::absolute(path, error), error).string();
    }
    const auto& change = s.st_ctim;
    return S_ISREG(s.st_mode) ? fmt::format("{}:{}:{}.{}", s.st_dev, s.st_ino, change.tv_sec, change.tv_nsec) : "";
}

/// Closes its descriptor, unless that was already done.
struct Descriptor {
    int number;
    ~Descriptor() { close(); }
    /// Returns 0 or the error. Network file systems may report a full disk only here. After EINTR Linux has closed the
    /// descriptor.
    int close() { return number < 0 || ::close(std::exchange(number, -1)) == 0 || errno == EINTR ? 0 : errno; }
};

int open_file(const fs::path& path, int flags, mode_t mode = 0) {
    return static_cast<int>(TEMP_FAILURE_RETRY(::open(path.c_str(), flags | O_CLOEXEC, mode)));
}

std::string read_all(int descriptor, std::uint64_t expected_bytes, std::uint64_t max_bytes) {
    std::string bytes;
    bytes.reserve(static_cast<std::size_t>(std::min(expected_bytes, max_bytes)));
    std::array<char, 1 << 16> block;
    while (true) {
        const ssize_t count = TEMP_FAILURE_RETRY(::read(descriptor, block.data(), block.size()));
        if (count < 0) throw UnreadableFile(error_text(errno));
        if (count == 0) return bytes;
        bytes.append(block.data(), static_cast<std::size_t>(count));
        if (bytes.size() > max_bytes) throw UnreadableFile(fmt::format("larger than {} bytes", max_bytes));
    }
}

fs::path folder_of(const fs::path& path) { return path.has_parent_path() ? path.parent_path() : fs::path("."); }

[[noreturn]] void refuse_to_write(const fs::path& path, const std::string& reason) {
    throw UserError(fmt::format("cannot write '{}': {}", output_name(path), reason));
}

/// Throws UserError with the reason of the system's error `error` and a remedy.
[[noreturn]] void refuse_to_write(const fs::path& path, int error) {
    constexpr const char* kFull = "{1}; free some space there or name a file on another disk";
    static const std::map<int, const char*> texts = {
        {ENOENT, "the folder '{0}' does not exist; make it first (mkdir -p) or name another file"},
        {ENOTDIR, "'{0}' is not a folder; name a file in another folder"},
        {EISDIR, "it is a folder; name a file in it"},
        {EACCES, "the folder '{0}' is not writable; change its permissions or name a file in another folder"},
        {EROFS, "{1}; name a file in another folder"},
        {ENOSPC, kFull},
        {EDQUOT, kFull},
        {EFBIG, "{1}; raise the limit on the size of files (ulimit -f) or ask for a smaller file"}};
    const auto text = texts.find(error);
    refuse_to_write(path, fmt::format(fmt::runtime(text == texts.end() ? "{1}; name another file" : text->second),
                                      folder_of(path).string(), error_text(error)));
}

/// The file to which write_whole_file() writes.
struct Target {
    fs::path file;        // symbolic links resolved
    bool direct = false;  // written without a temporary file, because it is a device, a pipe or stdout
};

Target checked_target(const fs::path& path) {
    if (is_standard_stream(path)) return {path, true};
    struct stat status {};
    const bool exists = ::stat(path.c_str(), &status) == 0;
    if (!exists && errno != ENOENT) refuse_to_write(path, errno);
    if (!path.has_filename() || (exists && S_ISDIR(status.st_mode))) refuse_to_write(path, EISDIR);
    if (!exists) return {path};
    if (::faccessat(AT_FDCWD, path.c_str(), W_OK, AT_EACCESS) != 0)
        refuse_to_write(path, "the file exists and is not writable; change its permissions or name another file");
    return {S_ISREG(status.st_mode) ? fs::canonical(path) : path, !S_ISREG(status.st_mode)};
}

/// Not std::random_device, which needs glibc 2.36, newer than that of many systems on which tools/bundle's program
/// runs.
std::uint32_t random_number() {
    std::uint32_t number = 0;
    if (::getentropy(&number, sizeof number) != 0) number = static_cast<std::uint32_t>(::getpid());
    return number;
}

/// A new file in the folder of the target. Unless it is renamed, the destructor or an interruption deletes it. Its name
/// does not contain the target's name, so that it cannot exceed the maximum length of a file name.
class TemporaryFile {
  public:
    /// Throws UserError, which names `named_path`, if the file cannot be created.
    TemporaryFile(const fs::path& target, const fs::path& named_path)
        : path_(folder_of(target) / fmt::format(".raya-{:08x}.tmp", random_number())), in_progress_(path_) {
        constexpr mode_t kMode = 0666;  // before the user's umask applies
        out.number = open_file(path_, O_WRONLY | O_CREAT | O_EXCL, kMode);
        if (out.number < 0) refuse_to_write(named_path, errno);
        exists_ = true;
    }
    TemporaryFile(const TemporaryFile&) = delete;
    TemporaryFile& operator=(const TemporaryFile&) = delete;
    ~TemporaryFile() {
        if (exists_) ::unlink(path_.c_str());
    }

    /// Returns 0 or the errno of the failed call.
    int rename_to(const fs::path& target) {
        if (std::rename(path_.c_str(), target.c_str()) != 0) return errno;
        exists_ = false;
        return 0;
    }

    Descriptor out{-1};

  private:
    fs::path path_;
    FileInProgress in_progress_;  // before the file is created: an interruption may come at any time
    bool exists_ = false;
};

/// Writes the bytes to the descriptor and closes it. Returns 0 or the errno of the failed call.
int write_and_close(Descriptor& out, std::string_view bytes, bool direct) {
    while (!bytes.empty()) {
        const ssize_t written = TEMP_FAILURE_RETRY(::write(out.number, bytes.data(), bytes.size()));
        if (written < 0) return errno;
        bytes.remove_prefix(static_cast<std::size_t>(written));
    }
    if (!direct && TEMP_FAILURE_RETRY(::fsync(out.number)) != 0) return errno;
    return out.close();
}

constexpr int kNotReserved = -1;
constexpr int kTaken = -2;  // take_stdout() has returned the descriptor

int reserved_stdout = kNotReserved;  // descriptor of a duplicate of stdout, or one of the two values above

/// Returns the descriptor of stdin. Prints a hint if stdin is a terminal.
int take_stdin() {
    static bool taken = false;
    if (std::exchange(taken, true))
        throw UnreadableFile("stdin can be read only once; give - once and name files for the other inputs");
    if (::isatty(STDIN_FILENO) != 0)
        print_log("raya: reading stdin from the terminal; end with Ctrl-D on a line of its own\n");
    return STDIN_FILENO;
}

/// Reserves stdout for a file. Further calls do nothing.
void reserve_stdout() {
    if (reserved_stdout != kNotReserved) return;
    std::fflush(stdout);
    reserved_stdout = ::fcntl(STDOUT_FILENO, F_DUPFD_CLOEXEC, STDERR_FILENO + 1);
    if (reserved_stdout < 0 || TEMP_FAILURE_RETRY(::dup2(STDERR_FILENO, STDOUT_FILENO)) < 0)
        throw UserError("cannot reserve stdout for a file: " + error_text(errno));
}

/// Returns the reserved descriptor, which the caller closes.
int take_stdout() {
    reserve_stdout();
    const int descriptor = std::exchange(reserved_stdout, kTaken);
    if (descriptor == kTaken) throw UserError("only one file can go to stdout; name files for the other outputs");
    return descriptor;
}

void write_direct(const fs::path& path, std::string_view bytes) {
    Descriptor out{is_standard_stream(path) ? take_stdout() : open_file(path, O_WRONLY)};  // waits for a pipe's reader
    if (out.number < 0) refuse_to_write(path, errno);
    if (const int error = write_and_close(out, bytes, true)) refuse_to_write(path, error);
}

}  // namespace

std::string read_file(const fs::path& path, std::uint64_t max_bytes) {
    if (is_standard_stream(path)) return read_all(take_stdin(), 0, max_bytes);
    struct stat status {};
    if (::stat(path.c_str(), &status) != 0) throw UnreadableFile(error_text(errno));
    if (S_ISDIR(status.st_mode)) throw UnreadableFile("it is a directory, not a file");
    if (!S_ISREG(status.st_mode) && !S_ISFIFO(status.st_mode)) throw UnreadableFile("not a regular file");
    const Descriptor file{open_file(path, O_RDONLY)};
    if (file.number < 0) throw UnreadableFile(error_text(errno));
    return read_all(file.number, static_cast<std::uint64_t>(status.st_size), max_bytes);
}

void register_input(const fs::path& path, const std::string& name) {
    const std::string identity = file_identity(is_standard_stream(path) ? "/dev/stdin" : path);
    if (identity.empty()) return;
    UsedFiles& files = used_files();
    const std::lock_guard lock(files.mutex);
    const auto input = files.inputs.emplace(identity, path.string()).first;
    if (!name.empty()) input->second = name;
    if (const auto output = files.outputs.find(identity); output != files.outputs.end())
        files.refuse_input(identity, output->second);
}

void forget_input(const fs::path& path) {
    const std::lock_guard lock(used_files().mutex);
    used_files().inputs.erase(file_identity(path));
}

std::string read_input(const fs::path& path) {
    register_input(path);
    return read_file(path);
}

void promise_output(const fs::path& path, const std::string& name) {
    const int stdout_descriptor = reserved_stdout == kNotReserved ? STDOUT_FILENO : reserved_stdout;
    std::string identity =
        file_identity(is_standard_stream(path) ? fmt::format("/dev/fd/{}", stdout_descriptor) : path.string());
    if (identity.empty() && is_standard_stream(path)) identity = "-";
    if (identity.empty()) return;
    UsedFiles& files = used_files();
    const std::lock_guard lock(files.mutex);
    files.refuse_input(identity, name);
    const auto [output, is_new] = files.outputs.emplace(identity, name);
    if (!is_new && output->second != name)
        throw UserError(fmt::format("{}: the same file as {}; name another file", name, output->second));
}

void forget_promised_outputs() {
    const std::lock_guard lock(used_files().mutex);
    used_files().outputs.clear();
}

void check_writable(const fs::path& path) {
    const Target target = checked_target(path);
    if (is_standard_stream(path)) reserve_stdout();
    if (target.direct) return;
    if (const int error = TemporaryFile(target.file, path).out.close()) refuse_to_write(path, error);
}

void write_whole_file(const fs::path& path, std::string_view bytes) {
    const Target target = checked_target(path);
    if (target.direct) return write_direct(path, bytes);
    {
        const std::lock_guard lock(used_files().mutex);
        used_files().refuse_input(file_identity(target.file), path.string());
    }
    TemporaryFile temporary(target.file, path);
    if (const int error = write_and_close(temporary.out, bytes, false)) refuse_to_write(path, error);
    if (const int error = temporary.rename_to(target.file)) refuse_to_write(path, error);
}

bool is_standard_stream(const fs::path& path) { return path.native() == "-"; }

std::string input_name(const fs::path& path) { return is_standard_stream(path) ? "stdin" : path.string(); }

std::string output_name(const fs::path& path) { return is_standard_stream(path) ? "stdout" : path.string(); }

bool stdout_is_reserved() { return reserved_stdout != kNotReserved; }

void refuse_bytes_on_terminal(const fs::path& path) {
    if (!is_standard_stream(path) || ::isatty(stdout_is_reserved() ? reserved_stdout : STDOUT_FILENO) == 0) return;
    throw UserError(
        "-: stdout is a terminal and the output is binary; redirect it to a file or a program (raya ... | program)");
}

}  // namespace raya
