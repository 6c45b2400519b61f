// This program once more, as a process of its own that does one task and tells the first one of it.
#pragma once
#include <sys/types.h>

#include <chrono>
#include <optional>
#include <string>

#include "host/base/json.hpp"

namespace raya {

/// Exit code of a process that could not become this program.
inline constexpr int kNotStarted = 127;

/// A child that runs this program for one task and writes lines into a pipe, a JSON object each. It ends when this
/// object does, and when this process does, however that ends; signals that end a program (Ctrl-C) it leaves to this
/// process. Its command line is not the user's:
///
///     raya --worker '{"task": TASK, "lines": the pipe's number there, "verbosity": above kSilent, "settings": {...}}'
class OwnProcess {
  public:
    /// Starts it. std::runtime_error where that fails.
    OwnProcess(const char* task, const Json& settings);
    OwnProcess(const OwnProcess&) = delete;
    OwnProcess& operator=(const OwnProcess&) = delete;
    ~OwnProcess();

    enum class Read { kLine, kNothing, kEnd };

    /// The next line, nothing within `wait`, or the end: the child is gone, or has closed the pipe.
    Read read(std::string& line, std::chrono::milliseconds wait);

    /// Waits for its end; its status as waitpid() gives it.
    int wait();

  private:
    bool has_line(std::string& line);
    bool has_ended();

    pid_t child_ = -1;
    int pipe_ = -1;
    int status_ = 0;
    bool ended_ = false;  // and waited for
    std::string text_;    // read and not yet given
};

/// "signal 11 (SIGSEGV)" or "exit code 1", of a status as waitpid() gives it.
std::string ending_text(int status);

/// What the child is to do.
struct WorkerOrder {
    std::string task;
    int lines = -1;  // the pipe
    Json settings;
};

/// In the child, before anything else: its order, and the verbosity of the process that gave it. The pipe is not for
/// programs that the child starts, such as a driver's compiler. Empty in any other process. UserError.
std::optional<WorkerOrder> worker_order(int argc, const char* const* argv);

/// In the child: writes a line into the pipe. A line that nobody reads is lost.
void send_line(int lines, const Json& object);

}  // namespace raya
