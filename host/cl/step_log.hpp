// What the host did and when, by a clock that traces can lay beside the device's own.
#pragma once
#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace raya {

/// Nanoseconds of CLOCK_MONOTONIC_RAW, the clock from which PoCL takes its event times.
std::uint64_t host_clock_ns();

/// How the clock of a device lies against the host's: adding `offset_ns` to a time of the device gives host_clock_ns().
struct ClockAnchor {
    bool same_clock = true;  // what the device says lies between the host's times around it: nothing is added
    std::int64_t offset_ns = 0;
    std::uint64_t uncertainty_ns = 0;  // either way; 0 where the clock is the same
};

/// One step of the host. Steps lie within each other, or one after another.
struct HostStep {
    std::string name;
    std::uint64_t started = 0, ended = 0;  // host_clock_ns()
    std::size_t depth = 0;                 // steps around it
};

class StepLog {
  public:
    /// A step: from its making to the end of its scope, and told then to who wants to know (host/base/verbosity.hpp).
    /// Without a log it does nothing else.
    class Step {
      public:
        Step(StepLog* log, const std::string& name);
        ~Step();
        Step(const Step&) = delete;
        Step& operator=(const Step&) = delete;

      private:
        StepLog* log_;
        std::size_t number_ = 0;
        std::string told_{};  // its name, where it will be told
        std::uint64_t started_ = 0;
    };

    /// What `action` returns; the step is all that it does.
    template <class Action>
    decltype(auto) during(const std::string& name, Action&& action) {
        const Step step(this, name);
        return std::forward<Action>(action)();
    }

    /// In the order in which they began; those that have not ended yet end now.
    std::vector<HostStep> steps() const;

  private:
    std::vector<HostStep> steps_;
    std::size_t depth_ = 0;
};

}  // namespace raya
