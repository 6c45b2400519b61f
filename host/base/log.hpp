// Log messages and the status line on stderr, and the verbosity, which is global.
#pragma once
#include <chrono>
#include <condition_variable>
#include <ctime>
#include <functional>
#include <mutex>
#include <string>
#include <string_view>
#include <thread>

namespace raya {

// Elapsed time, and the current date and time as text.

using Clock = std::chrono::steady_clock;

/// Returns the time from `start` to now, in seconds.
inline double seconds_since(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
}

/// Returns the current time in UTC, formatted by std::strftime(`format`); empty if the text would have more than 63
/// characters.
inline std::string utc_text(const char* format) {
    const std::time_t now = std::time(nullptr);
    std::tm parts{};
    char text[64];
    return {text, std::strftime(text, sizeof text, format, gmtime_r(&now, &parts))};
}

/// Returns `text` with each control character except \n and \t escaped ("\x1b"), so that the name of a file cannot send
/// commands to the terminal. Call it for output to stdout; print_log() and show_status() call it themselves.
std::string printable(std::string_view text);

/// Erases the status line and prints `text`, which consists of whole lines, on stderr.
void print_log(std::string_view text);

/// Replaces the status line on stderr, which must be a terminal, by `line`. print_log(), clear_status() or the next
/// call erases the line.
void show_status(std::string_view line);
void clear_status();

// Levels of verbosity, and the messages that raya prints at each.
inline constexpr int kErrorsOnly = -2;       // errors
inline constexpr int kQuiet = -1;            // errors, warnings
inline constexpr int kDefaultVerbosity = 0;  // errors, warnings, progress, summary
inline constexpr int kVerbose = 1;           // also the steps of the host, with their times
inline constexpr int kDetailed = 2;          // also kernel builds

/// Sets the level, clamped to kErrorsOnly..kDetailed.
void set_verbosity(int level);
int verbosity();

inline bool is_quiet() { return verbosity() <= kQuiet; }

/// Returns true if stderr is a terminal and the level allows progress output.
bool shows_progress();

/// Prints every line of `text` on stderr, each with the prefix "raya: ", if the verbosity is `level` or higher.
void log_message(int level, std::string_view text);

/// Prints "raya: TEXT" on stderr unless the verbosity is kErrorsOnly. For problems that do not end the command.
void warn(std::string_view text);

// Progress of a command on a terminal.

/// Called repeatedly with the completed fraction of the work, 0..1.
using ProgressCallback = std::function<void(double)>;

/// Returns the progress line of a stage, which began `seconds` ago and whose work is completed to `fraction`, 0..1.
/// From 0.1 % on, the line contains a bar and an estimate of the remaining time.
std::string progress_line(const std::string& stage, double fraction, double seconds);

/// The build budget: a program that compiles for longer counts as slow. tools/portability has its own budget for each
/// implementation.
inline constexpr std::chrono::seconds kBuildBudget{60};

/// Starts a thread that reports the compilation of kernels on stderr, unless --quiet is given: after 1 s, which is
/// longer than loading cached kernels takes, that kernels are being compiled for the device, and when the returned
/// thread is destroyed the time that it took.
[[nodiscard]] std::jthread announce_compiling(const std::string& device);

/// A thread that draws progress_line() of the current stage as the status line (log.hpp), if stderr is a terminal and
/// --quiet is not given. It draws first after 0.7 s, then five times a second. The destructor erases the line.
class ProgressBar {
  public:
    /// Starts the first stage, `name`. Draws nothing if `wanted` is false.
    ProgressBar(bool wanted, const std::string& name);

    /// Returns true if the bar is drawn.
    bool active() const { return draw_thread_.joinable(); }

    /// Starts the next stage.
    void stage(const std::string& name);

    /// Sets the completed fraction of the stage, 0..1. Ignores values that are smaller than a previous one.
    void update(double fraction);

  private:
    void draw_until(const std::stop_token& end);

    std::mutex mutex_;  // guards the members below
    std::string stage_name_;
    Clock::time_point stage_began_ = Clock::now();
    double fraction_ = 0;
    std::jthread draw_thread_;  // last, so that it ends first
};

}  // namespace raya
