#include "host/files/progress.hpp"

#include <fmt/core.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>

#include "host/files/say.hpp"

namespace raya {

ProgressBar::ProgressBar(bool wanted, const std::string& what) : what_(what) {
    if (wanted && ::isatty(STDERR_FILENO) != 0) drawer_ = std::thread([this] { draw_until_ended(); });
}

ProgressBar::~ProgressBar() {
    if (!active()) return;
    {
        const std::lock_guard lock(mutex_);
        ended_ = true;
    }
    end_.notify_one();
    drawer_.join();
}

void ProgressBar::stage(const std::string& what) {
    const std::lock_guard lock(mutex_);
    what_ = what;
    stage_began_ = Clock::now();
    done_.reset();
}

void ProgressBar::update(double done) {
    const std::lock_guard lock(mutex_);
    done_ = std::max(done_.value_or(0), std::clamp(done, 0.0, 1.0));
}

void ProgressBar::draw_until_ended() {
    using namespace std::chrono_literals;
    std::unique_lock lock(mutex_);
    for (auto pause = 1000ms; !end_.wait_for(lock, pause, [this] { return ended_; }); pause = 200ms)
        show_status(line(Clock::now()));
    clear_status();
}

std::string ProgressBar::line(Clock::time_point now) const {
    constexpr int kWidth = 40;
    constexpr double kEnough = 0.001;  // of the work: from less nothing can be said of the rest
    const double elapsed = std::chrono::duration<double>(now - stage_began_).count();
    if (done_.value_or(0) < kEnough) return fmt::format("{} ... {:.0f} s", what_, elapsed);
    const int filled = static_cast<int>(*done_ * kWidth);
    return fmt::format("[{}{}] {:3.0f} %  {:.0f} s left", std::string(filled, '#'), std::string(kWidth - filled, '.'),
                       std::min(99.0, std::floor(100 * *done_)), elapsed * (1 - *done_) / *done_);
}

}  // namespace raya
