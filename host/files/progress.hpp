// How far a render has come, and a progress bar for a person at a terminal.
#pragma once
#include <chrono>
#include <cstdio>
#include <functional>

namespace raya {

/// Called now and then with the share of the pixels that are done, 0..1.
using ProgressCallback = std::function<void(double)>;

/// Draws on stderr, only if that is a terminal, and only from one second on. Erased when it goes out of scope.
class ProgressBar {
  public:
    explicit ProgressBar(bool wanted);
    ~ProgressBar();
    ProgressBar(const ProgressBar&) = delete;
    ProgressBar& operator=(const ProgressBar&) = delete;

    /// Whether there is anybody to show it to.
    bool active() const { return active_; }

    /// `done`: share of the work, 0..1.
    void update(double done);

  private:
    std::chrono::steady_clock::time_point start_;
    bool active_ = false, drawn_ = false;
};

}  // namespace raya
