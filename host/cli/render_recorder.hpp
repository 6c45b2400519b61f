// Records the host's spans and clock offsets of a render for --profile and --trace, and writes the trace.
#pragma once
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
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
    std::size_t events = 1'000'000;  // maximum number of events
    std::size_t pes = 16;            // number of PEs or nodes that get a track
};

/// Adds --trace, --trace-events and --trace-pes.
void add_trace_options(CLI::App& command, TraceOptions& trace);

/// Throws UserError if the file's name does not end in .json or .json.gz, if --trace-events is 0, or if one of
/// --trace-events and --trace-pes is given without --trace.
void check_trace(const CLI::App& command, const TraceOptions& trace);

class RenderRecorder {
  public:
    /// `profile`: records the time of each build. Without trace and profile, the recorder has only the spans that its
    /// owner adds to spans(). `counters`: counts the host's events during kernels; construct the recorder before the
    /// first call of an OpenCL driver.
    RenderRecorder(const TraceOptions& trace, bool profile, bool counters);

    bool traces() const { return !trace_.file.empty(); }
    SpanLog& spans() { return spans_; }

    /// Returns null unless the recorder counts the host's events.
    const HostCounters* host_counters() const { return host_counters_ ? &*host_counters_ : nullptr; }

    /// Records the session's spans from now on, and counts the host's events. For a trace, measures the offset of the
    /// device's clock to the host's, and of this rank's clock to rank 0's.
    void observe(Session& session, Ranks& ranks);

    /// Sends the records of the other ranks to rank 0. Every rank must call gather().
    void gather(Session& session, Ranks& ranks);

    /// Returns the build time of each program, in order of the builds.
    std::vector<ProgramBuild> builds() const;

    /// With --trace: writes the host's spans, the commands in the session's profile, and the events that `add_machine`
    /// adds. Warns if events beyond --trace-events are omitted.
    void write(Session& session, const std::function<void(TraceFile&)>& add_machine);

  private:
    void align_clocks(Ranks& ranks);
    void add_measured_events(TraceFile& file, Session& session, std::uint32_t rank);

    const TraceOptions& trace_;
    bool profile_;
    std::optional<HostCounters> host_counters_;
    std::uint64_t begin_ns_ = host_clock_ns();  // host's clock at time 0 of the trace
    SpanLog spans_;
    ClockOffset device_clock_offset_;  // offset of the device's clock to the host's
    RankClock rank_clock_;             // offset of this rank's clock to rank 0's
    bool has_several_ranks_ = false;
    std::vector<TraceFile::Part> parts_of_other_ranks_;  // on rank 0: events of the other ranks
    Json all_rank_clocks_ = Json::array();               // offset and uncertainty of each rank's clock
};

}  // namespace raya
