// Writes one trace in Chrome's JSON format, as Perfetto and chrome://tracing read it. Knows nothing of what is traced.
//
// What readers ask for, and what is held here: processes and tracks are whole numbers, named by records that stand
// before all others; times are microseconds, with three decimals; slices of one track lie within each other or one
// after another; either end of a flow lies in a slice.
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

/// The processes of a raya trace, in the order in which they are shown: those of rank 0 with the modelled machine, then
/// host and device of each other rank.
enum TraceProcess : std::uint32_t { kTraceHost = 1, kTraceDevice = 2, kTraceMachine = 3 };
inline constexpr std::uint32_t kTraceProcesses = 3;  // of a rank

/// A row of slices.
struct TraceTrack {
    std::uint32_t process = 0, thread = 0;
    auto operator<=>(const TraceTrack&) const = default;
};

inline std::uint64_t nanoseconds(double ms) { return static_cast<std::uint64_t>(std::llround(ms * 1e6)); }

/// All times are nanoseconds from the trace's beginning. std::logic_error for a track that has no name yet, a slice
/// that ends before it begins or crosses another one. Holds the text in memory: about 150 bytes for each event.
class TraceFile {
  public:
    /// `most_events`: slices, counters and ends of flows; what comes after so many is left out and counted.
    explicit TraceFile(std::size_t most_events) : most_events_(most_events) {}

    /// Processes and tracks are shown in the order of their numbers.
    void name_process(std::uint32_t process, const std::string& name);
    void name_track(TraceTrack track, const std::string& name);

    /// Slices of a track come in the order of their starts, the outer one first.
    void slice(TraceTrack track, const std::string& name, std::uint64_t start, std::uint64_t end,
               const Json& arguments = {});

    /// The values of a counter's series from `at` on.
    void counter(std::uint32_t process, const std::string& name, std::uint64_t at,
                 const std::vector<std::pair<std::string, double>>& values);

    /// An arrow between the slices that lie there on the two tracks at the two times.
    void flow(const std::string& name, TraceTrack from, std::uint64_t from_at, TraceTrack to, std::uint64_t to_at);

    /// What the trace says of itself.
    Json& metadata() { return metadata_; }

    /// What was put in so far, to be added to the trace of another process. Processes and tracks of the two are not the
    /// same; there are no flows in it.
    struct Part {
        std::string names, text;
        std::uint64_t events = 0, left_out = 0;
    };
    Part part() const { return {names_, text_, events_, left_out_}; }
    void add(const Part& part);

    std::size_t events() const { return events_; }
    std::size_t left_out() const { return left_out_; }

    /// The file, compressed with gzip if `compressed`.
    std::string finish(bool compressed) const;

  private:
    bool take(std::size_t events);
    void check_named(TraceTrack track) const;
    void add(const std::string& event);
    std::string head() const;
    std::string tail() const;

    std::size_t most_events_, events_ = 0, left_out_ = 0, flows_ = 0;
    std::map<TraceTrack, std::vector<std::uint64_t>> open_;  // of each track: where the slices end that are open
    std::map<TraceTrack, std::uint64_t> last_start_;
    std::string names_, text_;
    Json metadata_ = Json::object();
};

struct TracedPe {
    std::uint32_t pe = 0;
    std::string remark;  // "busiest", "idlest" or empty
};

/// At most `most` PEs, by number: a quarter of them the busiest, a quarter the idlest, of equals the lowest numbers;
/// the others spread evenly over the numbers, PE 0 first. All PEs where there are no more than that.
std::vector<TracedPe> traced_pes(const std::vector<std::uint64_t>& loads, std::size_t most);

/// "PE 17 (busiest)"; `kind` is "PE" or "node".
std::string traced_pe_name(const std::string& kind, const TracedPe& traced);

}  // namespace raya
