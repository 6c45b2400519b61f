// Records the host's spans and clock offsets of a render for --profile and --trace, and writes the trace.
#pragma once
#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "host/cl/commands.hpp"
#include "host/ranks/ranks.hpp"
#include "host/report/render_report.hpp"
#include "host/report/trace_file.hpp"

namespace CLI {
class App;
}

namespace raya {

/// The options as given on the command line. An empty `file` means no trace.
struct TraceOptions {
    std::string file;
    std::size_t events = 1'000'000, pes = 16;  // maximum number of events; number of PEs with a track
};

/// Adds --trace, --trace-events and --trace-pes.
void add_trace_options(CLI::App& command, TraceOptions& trace);

/// Throws UserError if the file's name does not end in .json or .json.gz, or for other trace options without --trace.
void check_trace(const CLI::App& command, const TraceOptions& trace);

class RenderRecorder {
  public:
    /// `profile`: records the time of each build. Without trace and profile only the spans run by spans() are recorded.
    RenderRecorder(const TraceOptions& trace, bool profile);

    bool traces() const { return !trace_.file.empty(); }
    SpanLog& spans() { return spans_; }

    /// Records the session's spans from now on. For a trace, measures the offset of the device's clock to the host's,
    /// and of this rank's clock to rank 0's.
    void observe(Session& session, Ranks& ranks);

    /// Sends what the other ranks recorded to rank 0. Every rank calls it.
    void gather(Session& session, Ranks& ranks);

    /// Returns the seconds of each program's build, in order.
    std::vector<ProgramBuild> builds() const;

    /// With --trace: writes the host's spans, the commands in the session's profile, and the events that `add_machine`
    /// adds. Warns if events beyond --trace-events are omitted.
    void write(Session& session, const std::function<void(TraceFile&)>& add_machine);

  private:
    void compare_clocks(Ranks& ranks);
    void add_measured(TraceFile& file, Session& session, std::uint32_t rank);

    const TraceOptions& trace_;
    bool profile_;
    std::uint64_t begin_ = host_clock_ns();  // time 0 of the trace
    SpanLog spans_;
    ClockOffset clock_offset_;             // offset of the device's clock
    RankClock clock_;                      // offset of this rank's clock to rank 0's
    bool many_ = false;                    // several ranks
    std::vector<TraceFile::Part> others_;  // on rank 0: the events of the other ranks
    Json clocks_ = Json::array();          // offset and uncertainty of each rank's clock
};

}  // namespace raya
