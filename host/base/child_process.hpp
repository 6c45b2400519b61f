// A worker: a child process that runs this program for one task and reports to its parent through a pipe.
#pragma once
#include <sys/types.h>

#include <chrono>
#include <optional>
#include <string>

#include "host/base/json.hpp"

namespace raya {

/// Exit code of a child process in which exec failed.
inline constexpr int kNotStarted = 127;

/// A child process that runs this program for one task and writes JSON objects, one per line, into a pipe to its
/// parent. The destructor kills the child. If the parent ends for any reason, the system kills the child. The child
/// ignores SIGINT, SIGTERM, SIGHUP and SIGQUIT, which the parent handles. Command line of the child:
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
    bool has_line(std::string& line);
    bool has_ended();

    pid_t child_ = -1;
    int pipe_ = -1;
    int status_ = 0;
    bool ended_ = false;  // waitpid() has returned status_
    std::string text_;    // read from the pipe, not yet returned by read()
};

/// "signal 11 (SIGSEGV)" or "exit code 1" for a waitpid() status.
std::string ending_text(int status);

/// The task of a child process, parsed from its command line.
struct WorkerOrder {
    std::string task;
    int lines = -1;  // descriptor of the pipe to the parent
    Json settings;
};

/// Call it at the start of the program. In a child process: returns the task, sets the verbosity that the parent
/// passed, and marks the pipe close-on-exec, so that programs that the child starts, such as a driver's compiler, do
/// not inherit it. Returns nothing in any other process. Throws UserError for an invalid command line.
std::optional<WorkerOrder> worker_order(int argc, const char* const* argv);

/// In the child: writes `object` as one line into the pipe `lines`. Writes nothing if the parent has closed its end.
void send_line(int lines, const Json& object);

}  // namespace raya
