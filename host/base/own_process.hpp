// This program once more, as a process of its own that tells the first one what it does.
#pragma once
#include <sys/types.h>

#include <chrono>
#include <string>
#include <string_view>
#include <vector>

namespace raya {

/// Exit code of a process that could not become this program.
inline constexpr int kNotStarted = 127;

/// A child that runs this program with other arguments and writes lines into a pipe. It ends when this object does, and
/// when this process does, however that ends; signals that end a program (Ctrl-C) it leaves to this process.
class OwnProcess {
  public:
    /// Starts it; "--lines", N, the pipe's number there, follow the arguments. std::runtime_error where that fails.
    explicit OwnProcess(std::vector<std::string> arguments);
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

/// In the child, before anything else: its lines go into the pipe `lines`, which programs that it starts, such as a
/// driver's compiler, do not get.
void keep_lines_to_oneself(int lines);

/// In the child: writes a line into the pipe. A line that nobody reads is lost.
void send_line(int lines, std::string_view line);

}  // namespace raya
