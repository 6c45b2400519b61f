// Writes a trace in Chrome's Trace Event Format (JSON), which Perfetto and chrome://tracing display.
//
// The format requires: the identifiers of processes and tracks are integers, and records before all events give their
// names; times are microseconds (TraceFile writes three decimals); two slices of a track are nested or disjoint.
#pragma once
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "host/base/json.hpp"
#include "host/cl/profile.hpp"

namespace raya {

/// Processes of a raya trace in display order: host and device of rank 0, the modelled machine, then host and device of
/// the other ranks.
enum TraceProcess : std::uint32_t { kTraceHost = 1, kTraceDevice = 2, kTraceMachine = 3 };
inline constexpr std::uint32_t kTraceProcesses = 3;  // number of processes per rank

/// A track: a row of slices in the display.
struct TraceTrack {
    std::uint32_t process = 0, thread = 0;
    auto operator<=>(const TraceTrack&) const = default;
};

inline std::uint64_t nanoseconds(double ms) { return static_cast<std::uint64_t>(std::llround(ms * 1e6)); }

/// A trace in memory, about 150 bytes per event. All times are nanoseconds since the start of the trace. The functions
/// throw std::logic_error for a track without a name, and for a slice that ends before it starts or partly overlaps
/// another slice of its track.
class TraceFile {
  public:
    /// `max_events`: maximum number of events (slices and counters). Further events are counted, but not
    /// written.
    explicit TraceFile(std::size_t max_events) : max_events_(max_events) {}

    /// Names a process or a track. The display is in the order of their numbers.
    void name_process(std::uint32_t process, const std::string& name);
    void name_track(TraceTrack track, const std::string& name);

    /// Slices of a track must be added in the order of their start times, outer slices first.
    void slice(TraceTrack track, const std::string& name, std::uint64_t start, std::uint64_t end,
               const Json& arguments = {});

    /// Sets the values of counter `name` from time `at_ns` on. `values`: name and value of each series.
    void counter(std::uint32_t process, const std::string& name, std::uint64_t at_ns,
                 const std::vector<std::pair<std::string, double>>& values);

    /// Member "otherData" of the trace.
    Json& metadata() { return metadata_; }

    /// Contents of a trace, to be added to another trace. The two traces must not have processes or tracks in common.
    struct Part {
        std::string names, text;
        std::uint64_t events = 0, left_out = 0;
    };
    Part part() const { return {names_, text_, events_, left_out_}; }
    void add(const Part& part);

    std::size_t events() const { return events_; }
    /// Returns the number of events that were left out because they exceeded the maximum.
    std::size_t left_out() const { return left_out_; }

    /// Returns the contents of the file, compressed with gzip if `compressed`.
    std::string finish(bool compressed) const;

  private:
    bool reserve();
    void check_named(TraceTrack track) const;
    void add(const std::string& event);

    std::size_t max_events_, events_ = 0, left_out_ = 0;
    // [track]: end times of the open slices, outer slices first.
    std::map<TraceTrack, std::vector<std::uint64_t>> open_;
    std::map<TraceTrack, std::uint64_t> last_start_;  // [track]: start of the slice added last
    std::string names_, text_;
    Json metadata_ = Json::object();
};

/// A PE that the trace contains.
struct TracedPe {
    std::uint32_t pe = 0;
    std::string remark;  // "busiest", "idlest" or empty
};

/// Selects `max_count` PEs, or all if there are not more, and returns them sorted by number. A quarter of the selected
/// PEs are the busiest, a quarter the idlest; of PEs with equal loads, those with lower numbers are selected. The
/// others are evenly spaced from PE 0 on. `loads`: [PE].
std::vector<TracedPe> traced_pes(const std::vector<std::uint64_t>& loads, std::size_t max_count);

/// Returns a name such as "PE 17 (busiest)". `kind`: "PE" or "node".
std::string traced_pe_name(const std::string& kind, const TracedPe& traced);

// Adds measured times to a trace file: the host's spans as one process, the device's commands as another.

/// MPI rank to which the trace's processes belong.
struct TraceRank {
    std::uint32_t number = 0;
    bool named = false;  // true if there are several ranks: the names of the processes then begin with the rank
};

/// Adds one track with the host's spans. `begin`: host_clock_ns() at the start of the trace; no span starts earlier.
void add_host_spans(TraceFile& trace, const std::vector<HostSpan>& spans, std::uint64_t begin,
                    const TraceRank& rank = {});

/// Adds a slice from start to end for each command. Its arguments are the command's four times on the device's clock
/// and its bytes; a kernel has the launch's groups instead of bytes. The command queue is in order, so
/// one track contains all slices, except commands whose reported times overlap: they are in further tracks. Times that
/// are out of order or before `begin` are moved to the nearest valid time. The metadata contains the number of moved
/// times and the offset between the clocks. For a device that does not time its commands, the function adds only a
/// remark to the metadata.
void add_device_commands(TraceFile& trace, const std::string& device, const Profile& profile, const ClockOffset& offset,
                         std::uint64_t begin, const TraceRank& rank = {});

}  // namespace raya
