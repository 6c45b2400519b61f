// What was done on the device and how long it took: one record for each command, one line for each label.
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

}  // namespace raya
