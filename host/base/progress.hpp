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

/// Called from time to time with the completed share of the work, 0..1.
using ProgressCallback = std::function<void(double)>;

/// The completed share of the work, 0..1, and the seconds that it took.
struct Done {
    double share = 0, seconds = 0;
};

/// The progress line of the stage `what`, which began `seconds` ago: with a bar and the remaining time if `done` is
/// known.
std::string progress_line(const std::string& what, const std::optional<Done>& done, double seconds);

/// Prints on stderr, unless --quiet is given, that kernels are being compiled for the device, once this takes longer
/// than loading cached kernels. `patience` later it prints remedies. When the returned thread goes out of scope, it
/// prints the time that compilation took.
[[nodiscard]] std::jthread announce_compiling(const std::string& device,
                                              std::chrono::milliseconds patience = std::chrono::seconds(59));

/// Draws the current stage and its elapsed time on stderr if that is a terminal; if the completed share is known, a bar
/// and the remaining time. Starts after 0.7 s and draws five times a second. The destructor erases it; print_log()
/// (log.hpp) clears it before printing.
class ProgressBar {
  public:
    ProgressBar(bool wanted, const std::string& what);
    ~ProgressBar();
    ProgressBar(const ProgressBar&) = delete;
    ProgressBar& operator=(const ProgressBar&) = delete;

    /// Returns true if the bar is drawn.
    bool active() const { return drawer_.joinable(); }

    /// Starts a stage, whose completed share is unknown.
    void stage(const std::string& what);

    /// Sets the completed share of the stage, 0..1. Smaller values than before are ignored.
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
