// Worker: a child process that runs raya's executable for one task and reports to its parent through a pipe.
#pragma once
#include <sys/types.h>

#include <cerrno>
#include <cstdlib>
#include <filesystem>
#include <optional>
#include <string>
#include <system_error>
#include <vector>

#include "host/base/json.hpp"

namespace raya {

// A new folder for temporary files. The destructor removes the folder and its contents.

class TemporaryFolder {
  public:
    /// Creates the folder. Its name starts with `name`. It is in the system's folder for temporary files, or, if `name`
    /// is an absolute path, in the parent folder of this path. Throws std::system_error if it cannot be created.
    explicit TemporaryFolder(const std::string& name) {
        const std::string random_part(6, 'X');  // mkdtemp() replaces these letters
        std::string made = (std::filesystem::temp_directory_path() / (name + "-" + random_part)).string();
        if (::mkdtemp(made.data()) == nullptr)
            throw std::system_error(errno, std::generic_category(), "cannot create a temporary folder: " + made);
        path_ = made;
    }
    TemporaryFolder(const TemporaryFolder&) = delete;
    TemporaryFolder& operator=(const TemporaryFolder&) = delete;
    ~TemporaryFolder() {
        std::error_code ignored;
        std::filesystem::remove_all(path_, ignored);
    }

    std::filesystem::path operator/(const std::string& name) const { return path_ / name; }
    const std::filesystem::path& path() const { return path_; }

  private:
    std::filesystem::path path_;
};

/// Exit code of a child process in which exec failed.
inline constexpr int kNotStarted = 127;

/// Runs `program` in a child process, without a search in PATH; arguments[0] is its name. The child inherits the
/// standard streams and the descriptor `kept`, and no other. If the parent ends for any reason, the system kills the
/// child. The child ignores SIGINT, SIGTERM, SIGHUP and SIGQUIT, which the parent handles. If exec fails, the child
/// ends with kNotStarted. Throws std::runtime_error if there can be no new process.
pid_t start_child(const std::string& program, std::vector<std::string> arguments, int kept);

/// A child process that runs raya's executable for one task and writes JSON objects, one per line, into a pipe to its
/// parent. The destructor kills the child. See also start_child(). Command line of the child:
///
///     raya --worker '{"task": TASK, "lines": descriptor of the pipe, "verbosity": level - kErrorsOnly,
///                     "settings": {...}}'
class ChildProcess {
  public:
    /// Starts the child. Throws std::runtime_error on failure.
    ChildProcess(const char* task, const Json& settings);
    ChildProcess(const ChildProcess&) = delete;
    ChildProcess& operator=(const ChildProcess&) = delete;
    ~ChildProcess();

    enum class Read { kLine, kNothing, kEnd };

    /// Reads the next line into `line`. Returns kLine if there is one, kNothing if none arrived within `wait`, and kEnd
    /// if the child has ended or closed the pipe.
    Read read(std::string& line, std::chrono::milliseconds wait);

    /// Waits for the child to end and returns its waitpid() status.
    int wait();

  private:
    /// Moves the first whole line of unread_text_ to `line`. Returns false if unread_text_ has none.
    bool take_line(std::string& line);
    /// Returns true if the child has ended. Does not wait.
    bool check_ended();

    pid_t child_ = -1;
    int pipe_ = -1;
    int status_ = 0;
    bool ended_ = false;       // waitpid() has returned status_
    std::string unread_text_;  // text from the pipe that read() has not returned yet
};

/// Returns a text for a waitpid() status: "signal 11 (SIGSEGV)" or "exit code 1".
std::string ending_text(int status);

/// The task of a child process, parsed from its command line.
struct WorkerRequest {
    std::string task;
    int pipe = -1;  // descriptor of the pipe to the parent
    Json settings;
};

/// Call this function at the start of main(). In a child process it returns the task, sets the verbosity that the
/// parent passed, and marks the pipe close-on-exec, so that programs that the child starts, such as a driver's
/// compiler, do not inherit the pipe. In any other process it returns nothing. Throws UserError for an invalid command
/// line.
std::optional<WorkerRequest> worker_request(int argc, const char* const* argv);

/// In the child: writes `object` as one line into `pipe`, the descriptor in WorkerRequest. Writes nothing if the parent
/// has closed its end of the pipe.
void send_line(int pipe, const Json& object);

}  // namespace raya
