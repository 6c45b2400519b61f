// How far a command has come, for a person at a terminal.
#pragma once
#include <condition_variable>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "host/base/clock.hpp"

namespace raya {

/// Called now and then with the share of the work that is done, 0..1.
using ProgressCallback = std::function<void(double)>;

/// What of the work was done, and in how many seconds.
struct Done {
    double share = 0, seconds = 0;
};

/// What is drawn of `what` that began `seconds` ago, of which something is done where that is known.
std::string progress_line(const std::string& what, const std::optional<Done>& done, double seconds);

/// Says on stderr, unless --quiet is given, that kernels are compiled for the device once this has lasted longer than
/// to load compiled ones takes, and at the end, when what is returned goes out of scope, for how long it lasted.
/// `patience` later it says what may help.
[[nodiscard]] std::jthread announce_compiling(const std::string& device,
                                              std::chrono::milliseconds patience = std::chrono::seconds(59));

/// Draws on stderr, only if that is a terminal: within a second, five times a second, whatever the command is about.
/// What runs and for how long; where a share is known, a bar and the time that is left. Erased when it goes out of
/// scope; who prints before that clears it (say.hpp).
class ProgressBar {
  public:
    ProgressBar(bool wanted, const std::string& what);
    ~ProgressBar();
    ProgressBar(const ProgressBar&) = delete;
    ProgressBar& operator=(const ProgressBar&) = delete;

    /// Whether there is anybody to show it to.
    bool active() const { return drawer_.joinable(); }

    /// What runs from now on, of which no share is known yet.
    void stage(const std::string& what);

    /// `done`: share of the stage, 0..1; less than before changes nothing.
    void update(double done);

  private:
    void draw_until_ended();
    double stage_seconds() const;

    std::mutex mutex_;  // of all below
    std::condition_variable end_;
    bool ended_ = false;
    std::string what_;
    Clock::time_point stage_began_ = Clock::now();
    std::optional<Done> done_;
    std::thread drawer_;
};

}  // namespace raya
