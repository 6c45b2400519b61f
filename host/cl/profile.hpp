// Structs for timed device commands, timed host spans, and a device's peak rates.
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace raya {

/// A device command. Times are nanoseconds of the device's clock (CL_PROFILING_COMMAND_*), all 0 without profiling.
struct CommandRecord {
    std::string label;
    std::string kind;  // "kernel", "write", "read", "copy" or "fill"
    std::uint64_t queued = 0, submitted = 0, started = 0, ended = 0;
    std::uint64_t bytes = 0;                   // transferred, copied or filled; 0 for a kernel
    std::string target_name{};                 // name of the kernel, of the buffer, or of both buffers of a copy
    std::uint64_t groups = 0, group_size = 0;  // of a kernel launch; group_size in work-items
};

/// Summary of all commands of one label and kind. total_ns, min_ns, mean_ns and max_ns are nanoseconds from start to
/// end on the device.
struct LabelSummary {
    std::string label, kind;
    std::size_t launches = 0;  // number of commands
    std::uint64_t total_ns = 0, min_ns = 0;
    double mean_ns = 0;
    std::uint64_t max_ns = 0;
    std::uint64_t submit_ns = 0, start_ns = 0;  // total delays from queued to submitted, and from submitted to started
    std::uint64_t bytes = 0;                    // total; as CommandRecord::bytes
};

/// The commands of a session in the order in which they were enqueued.
class Profile {
  public:
    /// `timed`: the device records the times of its commands; if false, only counts and bytes are meaningful.
    explicit Profile(bool timed) : timed_(timed) {}

    void add(CommandRecord command) { commands_.push_back(std::move(command)); }
    void clear() { commands_.clear(); }

    bool timed() const { return timed_; }
    const std::vector<CommandRecord>& commands() const { return commands_; }

    /// Returns one entry for each label and kind, in the order of first use.
    std::vector<LabelSummary> summary() const;

  private:
    bool timed_;
    std::vector<CommandRecord> commands_;
};

/// Returns the host's time in nanoseconds of CLOCK_MONOTONIC_RAW, the clock of PoCL's event times.
std::uint64_t host_clock_ns();

/// The offset of a device's clock: device time + `offset_ns` is the same time on the host's clock (host_clock_ns()).
struct ClockOffset {
    bool same_clock = true;  // the device uses the host's clock, so offset_ns is 0
    std::int64_t offset_ns = 0;
    std::uint64_t uncertainty_ns = 0;  // offset_ns is correct within +- uncertainty_ns; 0 for the same clock
};

/// A timed part of the host program's work (a span, in tracing terms). Two spans are either nested or disjoint.
struct HostSpan {
    std::string name;
    std::uint64_t started = 0, ended = 0;  // host_clock_ns()
    std::size_t depth = 0;                 // number of enclosing spans
};

/// The spans of the host, recorded for a trace file.
class SpanLog {
  public:
    /// A span, which lasts as long as this object. When it ends, it is logged at level kVerbose (host/base/log.hpp). It
    /// is recorded in `log`, unless that is a null pointer.
    class Span {
      public:
        Span(SpanLog* log, const std::string& name);
        ~Span();
        Span(const Span&) = delete;
        Span& operator=(const Span&) = delete;

      private:
        SpanLog* log_;
        std::size_t number_ = 0;
        std::string name_;
        std::uint64_t started_;
    };

    /// Runs `action` as a span and returns its result.
    template <class Action>
    decltype(auto) during(const std::string& name, Action&& action) {
        const Span span(this, name);
        return std::forward<Action>(action)();
    }

    /// Returns all spans in the order in which they began. A running span gets the current time as its end.
    std::vector<HostSpan> spans() const;

  private:
    std::vector<HostSpan> spans_;
    std::size_t depth_ = 0;
};

/// Peak rates measured on a device (measure.hpp); 0 if the device does not time its commands.
struct DevicePeak {
    double fp32_per_s = 0;                    // multiply-adds with the default lanes, each counted as one operation
    std::string format;                       // number format of the render
    double multiply_per_s = 0;                // multiply-adds in that format, with the lanes of the render
    double divide_per_s = 0, sqrt_per_s = 0;  // divisions and square roots in that format and lanes
    double copy_bytes_per_s = 0;              // number of bytes that a copy from buffer to buffer reads and writes
    std::uint64_t copy_bytes = 0;             // size of each of the copy's two buffers
    double scatter = 0;                       // (best - worst) / best of three measurements of fp32_per_s
};

}  // namespace raya
