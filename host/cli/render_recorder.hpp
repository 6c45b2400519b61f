// Records the host's steps and the clocks of a render for --profile and --trace, and writes the trace.
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

/// As given on the command line; no trace if `file` is empty.
struct TraceOptions {
    std::string file;
    std::size_t events = 1'000'000, pes = 16;
};

/// Adds --trace, --trace-events and --trace-pes.
void add_trace_options(CLI::App& command, TraceOptions& trace);

/// Refuses a file whose name does not end in .json or .json.gz, and options of a trace without --trace. UserError.
void check_trace(const CLI::App& command, const TraceOptions& trace);

class RenderRecorder {
  public:
    /// `profile`: times each build. With neither trace nor profile it records only the steps of steps().
    RenderRecorder(const TraceOptions& trace, bool profile);

    bool traces() const { return !trace_.file.empty(); }
    StepLog& steps() { return steps_; }

    /// Records the session's steps from now on. Compares its device's clock with the host's, and this rank's clock with
    /// rank 0's.
    void observe(Session& session, Ranks& ranks);

    /// Sends the records of the other ranks to rank 0.
    void gather(Session& session, Ranks& ranks);

    /// Seconds of each program's build, in order.
    std::vector<ProgramBuild> builds() const;

    /// With --trace: writes the steps, the commands of the session's profile, and the events of `add_machine`. Warns of
    /// events beyond --trace-events.
    void write(Session& session, const std::function<void(TraceFile&)>& add_machine);

  private:
    void compare_clocks(Ranks& ranks);
    void add_measured(TraceFile& file, Session& session, std::uint32_t rank);

    const TraceOptions& trace_;
    bool profile_;
    std::uint64_t begin_ = host_clock_ns();
    StepLog steps_;
    ClockAnchor anchor_;
    RankClock clock_;
    bool many_ = false;
    std::vector<TraceFile::Part> others_;
    Json clocks_ = Json::list();
};

}  // namespace raya
