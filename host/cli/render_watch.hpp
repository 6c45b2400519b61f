// Watches a render for --profile and --trace: the host's steps, the clocks, and what is made of them.
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

/// As given on the command line; no trace where `file` is empty.
struct TraceOptions {
    std::string file;
    std::size_t events = 1'000'000, pes = 16;
};

/// Adds --trace and what goes with it, with their help texts.
void add_trace_options(CLI::App& command, TraceOptions& trace);

/// Refuses a file that cannot be written or has another ending than .json and .json.gz, and what says how to trace
/// where nothing is traced. UserError.
void check_trace(const CLI::App& command, const TraceOptions& trace);

class RenderWatch {
  public:
    /// `profile`: builds are timed one by one. With neither it notes nothing but the steps asked for here.
    RenderWatch(const TraceOptions& trace, bool profile);

    bool traces() const { return !trace_.file.empty(); }
    StepLog& steps() { return steps_; }

    /// What the session does from now on is noted, and its device's clock compared with the host's; this rank's clock
    /// with rank 0's.
    void observe(Session& session, Ranks& ranks);

    /// Brings what other ranks have noted so far to rank 0.
    void gather(Session& session, Ranks& ranks);

    /// Seconds of each program's build, in their order.
    std::vector<ProgramBuild> builds() const;

    /// Writes the trace, if there is to be one: steps, the commands in the session's profile, and what `add_machine`
    /// adds. Says on stderr how many events were left out.
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
