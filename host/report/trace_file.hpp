// Writes a trace in the Trace Event Format (JSON) of Chrome, which Perfetto and chrome://tracing read.
//
// Rules of the format that the writer follows: processes and tracks are integers, named by records before all events;
// times are microseconds with three decimals; slices of a track are nested or disjoint; both ends of a flow lie in
// slices.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "host/base/json.hpp"

namespace raya {

/// Processes of a raya trace in display order: host and device of rank 0, the modelled machine, then host and device of
/// the other ranks.
enum TraceProcess : std::uint32_t { kTraceHost = 1, kTraceDevice = 2, kTraceMachine = 3 };
inline constexpr std::uint32_t kTraceProcesses = 3;  // numbers reserved for a rank

/// A row of slices.
struct TraceTrack {
    std::uint32_t process = 0, thread = 0;
    auto operator<=>(const TraceTrack&) const = default;
};

inline std::uint64_t nanoseconds(double ms) { return static_cast<std::uint64_t>(std::llround(ms * 1e6)); }

/// All times are nanoseconds since the start of the trace. Throws std::logic_error for a track without a name, and for
/// a slice that ends before it starts or overlaps another one. Keeps the text in memory: about 150 bytes for each
/// event.
class TraceFile {
  public:
    /// `max_events`: limit for slices, counters and ends of flows; further events are dropped and counted.
    explicit TraceFile(std::size_t max_events) : max_events_(max_events) {}

    /// Numbers of processes and tracks define the display order.
    void name_process(std::uint32_t process, const std::string& name);
    void name_track(TraceTrack track, const std::string& name);

    /// Slices of a track must be added by start time, outer slices first.
    void slice(TraceTrack track, const std::string& name, std::uint64_t start, std::uint64_t end,
               const Json& arguments = {});

    /// Sets the values of a counter's series from time `at` on.
    void counter(std::uint32_t process, const std::string& name, std::uint64_t at,
                 const std::vector<std::pair<std::string, double>>& values);

    /// Adds an arrow from the slice at `from_at` on track `from` to the slice at `to_at` on track `to`.
    void flow(const std::string& name, TraceTrack from, std::uint64_t from_at, TraceTrack to, std::uint64_t to_at);

    /// Member "otherData" of the trace.
    Json& metadata() { return metadata_; }

    /// Contents of a trace, to be added to another one. The two must have different processes and tracks, and the part
    /// must have no flows.
    struct Part {
        std::string names, text;
        std::uint64_t events = 0, left_out = 0;
    };
    Part part() const { return {names_, text_, events_, left_out_}; }
    void add(const Part& part);

    std::size_t events() const { return events_; }
    std::size_t left_out() const { return left_out_; }

    /// Returns the text of the file, compressed with gzip if `compressed`.
    std::string finish(bool compressed) const;

  private:
    bool reserve(std::size_t events);
    void check_named(TraceTrack track) const;
    void add(const std::string& event);
    std::string head() const;
    std::string tail() const;

    std::size_t max_events_, events_ = 0, left_out_ = 0, flows_ = 0;
    std::map<TraceTrack, std::vector<std::uint64_t>> open_;  // ends of each track's open slices
    std::map<TraceTrack, std::uint64_t> last_start_;
    std::string names_, text_;
    Json metadata_ = Json::object();
};

struct TracedPe {
    std::uint32_t pe = 0;
    std::string remark;  // "busiest", "idlest" or empty
};

/// Selects at most `max_count` PEs, sorted by number: a quarter are the busiest, a quarter the idlest (lower numbers
/// first among equal loads), the others evenly spaced from PE 0 on. Returns all PEs if they are no more than that.
std::vector<TracedPe> traced_pes(const std::vector<std::uint64_t>& loads, std::size_t max_count);

/// "PE 17 (busiest)"; `kind` is "PE" or "node".
std::string traced_pe_name(const std::string& kind, const TracedPe& traced);

}  // namespace raya
