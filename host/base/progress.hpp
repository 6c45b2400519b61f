// Progress of a command on a terminal.
#pragma once
#include <condition_variable>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "host/base/clock.hpp"

namespace raya {

/// Called repeatedly with the completed fraction of the work, 0..1.
using ProgressCallback = std::function<void(double)>;

/// The completed fraction of a stage's work, 0..1, and the seconds that this fraction took.
struct Done {
    double share = 0, seconds = 0;
};

/// The progress line of the stage `what`, which began `seconds` ago. Shows a bar and an estimate of the remaining time
/// if `done` is known and its fraction is at least 0.1 %.
std::string progress_line(const std::string& what, const std::optional<Done>& done, double seconds);

/// Starts a thread that prints messages about the compilation of kernels on stderr, unless --quiet is given. After 1 s,
/// longer than loading cached kernels takes, it prints that kernels are being compiled for the device; `patience` later
/// it prints remedies. When the returned thread is destroyed, it prints the time that compilation took, if that was
/// more than 1 s.
[[nodiscard]] std::jthread announce_compiling(const std::string& device,
                                              std::chrono::milliseconds patience = std::chrono::seconds(59));

/// A thread that draws progress_line() of the current stage as the status line (log.hpp), if stderr is a terminal and
/// --quiet is not given: first after 0.7 s, then five times a second. The destructor erases the line.
class ProgressBar {
  public:
    /// Starts the first stage, `what`. Draws nothing if `wanted` is false.
    ProgressBar(bool wanted, const std::string& what);
    ~ProgressBar();
    ProgressBar(const ProgressBar&) = delete;
    ProgressBar& operator=(const ProgressBar&) = delete;

    /// Returns true if the bar is drawn.
    bool active() const { return drawer_.joinable(); }

    /// Starts the next stage. Its completed fraction is unknown until update() is called.
    void stage(const std::string& what);

    /// Sets the completed fraction of the stage, 0..1. Ignores values that are smaller than a previous one.
    void update(double done);

  private:
    void draw_until_ended();
    double stage_seconds() const;

    std::mutex mutex_;  // guards all members below
    std::condition_variable end_;
    bool ended_ = false;
    std::string what_;
    Clock::time_point stage_began_ = Clock::now();
    std::optional<Done> done_;
    std::thread drawer_;
};

}  // namespace raya
