// What was done on the device and by the host, when, and how long it took; and what a device can do at most: plain
// records.
#pragma once
#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace raya {

/// An argument of a kernel, to be read.
struct ArgumentText {
    std::string name, value;
};

/// One command. Times are nanoseconds of the device's own clock (CL_PROFILING_COMMAND_*), all 0 where it has none.
struct CommandRecord {
    std::string label;
    std::string kind;  // "kernel", "write", "read", "copy" or "fill"
    std::uint64_t queued = 0, submitted = 0, started = 0, ended = 0;
    std::uint64_t bytes = 0;                   // moved or filled; 0 for a kernel
    std::string object{};                      // the kernel; of a transfer its buffer, of a copy both
    std::uint64_t groups = 0, group_size = 0;  // of a kernel
    std::vector<ArgumentText> arguments{};     // of a kernel, only if Session::observe() asks for them
};

/// All commands of one label and kind. Times are from start to end on the device, nanoseconds.
struct LabelSummary {
    std::string label, kind;
    std::size_t launches = 0;
    std::uint64_t total_ns = 0, min_ns = 0;
    double mean_ns = 0;
    std::uint64_t max_ns = 0;
    std::uint64_t submit_ns = 0, start_ns = 0;  // in all, from queued to submitted, from there to start
    std::uint64_t bytes = 0;                    // moved or filled, in all
};

/// The commands of a session in the order in which they were given.
class Profile {
  public:
    /// `timed`: whether the device measures its commands; if not, only counts and bytes mean anything.
    explicit Profile(bool timed) : timed_(timed) {}

    void add(CommandRecord command) { commands_.push_back(std::move(command)); }
    void clear() { commands_.clear(); }

    bool timed() const { return timed_; }
    const std::vector<CommandRecord>& commands() const { return commands_; }

    /// One entry for each label and kind, in the order of first use.
    std::vector<LabelSummary> summary() const;

  private:
    bool timed_;
    std::vector<CommandRecord> commands_;
};

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
    /// A step: from its making to the end of its scope, and told then to who wants to know (host/base/say.hpp).
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

/// What a small program reached on this device; 0 where the device does not time its commands.
struct DevicePeak {
    double fp32_per_s = 0;      // multiply-adds of the widest lanes, one operation each
    std::string format;         // of the render
    double multiply_per_s = 0;  // multiply-adds in that format, with the lanes of the render
    double divide_per_s = 0, root_per_s = 0;
    double copy_bytes_per_s = 0;   // read and written by copies from buffer to buffer
    std::uint64_t copy_bytes = 0;  // of each of these buffers
    double scatter = 0;            // share by which the least of three measurements of fp32_per_s lies below the best
};

}  // namespace raya
