#include "host/files/progress.hpp"

#include <fmt/core.h>
#include <unistd.h>

#include <algorithm>
#include <string>

namespace raya {

ProgressBar::ProgressBar(bool wanted)
    : start_(std::chrono::steady_clock::now()), active_(wanted && isatty(STDERR_FILENO) != 0) {}

ProgressBar::~ProgressBar() {
    if (drawn_) fmt::print(stderr, "\r\033[K");
}

void ProgressBar::update(double done) {
    constexpr double kQuietSeconds = 1;
    constexpr int kWidth = 40;
    const double elapsed = std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
    if (!active_ || elapsed < kQuietSeconds) return;
    const int filled = std::clamp(static_cast<int>(done * kWidth), 0, kWidth);
    const double left = done > 0 ? elapsed * (1 - done) / done : 0;
    fmt::print(stderr, "\r[{}{}] {:3.0f} %  {:.0f} s left\033[K", std::string(filled, '#'),
               std::string(kWidth - filled, '.'), 100 * done, left);
    std::fflush(stderr);
    drawn_ = true;
}

}  // namespace raya
