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

/// A child process that runs this program for one task and writes JSON objects into a pipe, one per line. The
/// destructor kills it, and so does the end of this process for any reason. It ignores SIGINT, SIGTERM, SIGHUP and
/// SIGQUIT, which this process handles. Its command line:
///
///     raya --worker '{"task": TASK, "lines": descriptor of the pipe, "verbosity": level - kErrorsOnly,
///                     "settings": {...}}'
class ChildProcess {
  public:
    /// Starts the child. std::runtime_error if that fails.
    ChildProcess(const char* task, const Json& settings);
    ChildProcess(const ChildProcess&) = delete;
    ChildProcess& operator=(const ChildProcess&) = delete;
    ~ChildProcess();

    enum class Read { kLine, kNothing, kEnd };

    /// Reads the next line. kNothing: none arrived within `wait`. kEnd: the child ended or closed the pipe.
    Read read(std::string& line, std::chrono::milliseconds wait);

    /// Waits for the child to end and returns its waitpid() status.
    int wait();

  private:
    bool has_line(std::string& line);
    bool has_ended();

    pid_t child_ = -1;
    int pipe_ = -1;
    int status_ = 0;
    bool ended_ = false;  // and reaped
    std::string text_;    // read from the pipe, not yet returned by read()
};

/// "signal 11 (SIGSEGV)" or "exit code 1" for a waitpid() status.
std::string ending_text(int status);

/// The child's task, from its command line.
struct WorkerOrder {
    std::string task;
    int lines = -1;  // the pipe
    Json settings;
};

/// In the child, before anything else: returns its task and sets the parent's verbosity. Programs that the child
/// starts, such as a driver's compiler, do not inherit the pipe. Returns nothing in any other process. UserError.
std::optional<WorkerOrder> worker_order(int argc, const char* const* argv);

/// In the child: writes a line into the pipe. The line is lost if the parent has closed its end.
void send_line(int lines, const Json& object);

}  // namespace raya
