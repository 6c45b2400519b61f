#include "host/cl/step_log.hpp"

#include <fmt/core.h>

#include <ctime>

#include "host/base/verbosity.hpp"

namespace raya {

std::uint64_t host_clock_ns() {
    timespec time{};
    ::clock_gettime(CLOCK_MONOTONIC_RAW, &time);
    return std::uint64_t{1'000'000'000} * static_cast<std::uint64_t>(time.tv_sec) +
           static_cast<std::uint64_t>(time.tv_nsec);
}

StepLog::Step::Step(StepLog* log, const std::string& name) : log_(log) {
    if (verbosity() >= kVerbose) {
        told_ = name;
        started_ = host_clock_ns();
    }
    if (log_ == nullptr) return;
    number_ = log_->steps_.size();
    log_->steps_.push_back({name, host_clock_ns(), 0, log_->depth_++});
}

StepLog::Step::~Step() {
    if (!told_.empty())
        tell(kVerbose, fmt::format("{}: {:.3f} s", told_, 1e-9 * static_cast<double>(host_clock_ns() - started_)));
    if (log_ == nullptr) return;
    log_->steps_[number_].ended = host_clock_ns();
    --log_->depth_;
}

std::vector<HostStep> StepLog::steps() const {
    std::vector<HostStep> all = steps_;
    const std::uint64_t now = host_clock_ns();
    for (HostStep& step : all)
        if (step.ended == 0) step.ended = now;
    return all;
}

}  // namespace raya
