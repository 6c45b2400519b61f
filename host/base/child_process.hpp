// Child processes. A worker is a child that runs raya's executable for one task and reports in JSON.
#pragma once
#include <sys/types.h>

#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <functional>
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

/// The descriptor into which a child reports, unless another one is given.
inline constexpr int kReportDescriptor = 3;

/// A child process and a pipe from it. If the parent ends for any reason, the system kills the child. The child ignores
/// SIGINT, SIGTERM, SIGHUP and SIGQUIT, which the parent handles.
class Child {
  public:
    /// Runs `arguments`, which start with the program: a path, or a name that is searched in PATH. The child writes
    /// into the pipe through its descriptor `descriptor`, and inherits the other standard streams. If exec fails, it
    /// ends with kNotStarted. Throws std::runtime_error if there can be no new process.
    explicit Child(std::vector<std::string> arguments, int descriptor = kReportDescriptor);
    Child(const Child&) = delete;
    Child& operator=(const Child&) = delete;
    /// Kills the child if it still runs.
    ~Child();

    /// Reads up to `count` bytes from the pipe as soon as there are any. Returns their number: 0 if the child has ended
    /// or closed the pipe. Empty: there were none within `wait`.
    std::optional<std::size_t> read(char* bytes, std::size_t count, std::chrono::milliseconds wait);

    /// Waits for the child to end and returns its waitpid() status.
    int wait();

  private:
    pid_t child_ = -1;  // -1: it has ended with status_
    int pipe_ = -1;
    int status_ = 0;
};

/// Returns a text for a waitpid() status: "signal 11 (SIGSEGV)" or "exit code 1".
std::string ending_text(int status);

/// Runs a worker. Calls `take` with each JSON object that the worker sends, and with null after each fifth of a second
/// without one. If `take` returns false, kills the worker. Returns the worker's waitpid() status; nothing if it was
/// killed. If the worker reports an error, {"error": TEXT, "kind": "user" or "device" or "internal"}, throws it as
/// UserError, DeviceError or std::runtime_error.
std::optional<int> run_child(const char* task, const Json& settings, const std::function<bool(const Json& sent)>& take);

/// The task of a worker, parsed from its command line:
///
///     raya --worker '{"task": TASK, "verbosity": level - kErrorsOnly, "settings": {...}}'
struct WorkerRequest {
    std::string task;
    int pipe = kReportDescriptor;
    Json settings;
};

/// Call this function at the start of main(). In a worker it returns the task, sets the verbosity that the parent
/// passed, and marks the pipe close-on-exec, so that programs that the worker starts, such as a driver's compiler, do
/// not inherit the pipe. In any other process it returns nothing. Throws UserError for an invalid command line.
std::optional<WorkerRequest> worker_request(int argc, const char* const* argv);

/// In the worker: sends `object` through the descriptor in WorkerRequest. Sends nothing if the parent has closed its
/// end of the pipe.
void send_line(int pipe, const Json& object);

}  // namespace raya
