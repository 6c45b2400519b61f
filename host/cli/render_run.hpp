// State that all images of one command share: the scene, the device, the progress bar and the recorder.
#pragma once
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "host/base/log.hpp"
#include "host/cl/commands.hpp"
#include "host/cli/options.hpp"
#include "host/cli/render_options.hpp"
#include "host/cli/scene_input.hpp"
#include "host/ranks/ranks.hpp"
#include "host/report/render_report.hpp"
#include "host/report/trace_file.hpp"

namespace CLI {
class App;
}

namespace raya {

// Records the host's spans and clock offsets of a render for --profile and --trace, and writes the trace.

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

struct RenderCommand;

/// The progress bar of a render, or the caller's callback instead of it.
class RenderProgress {
  public:
    RenderProgress(bool shows_bar, const std::string& label) : bar_(std::in_place, shows_bar, label) {}
    /// Calls `callback` with the progress instead of showing a bar.
    explicit RenderProgress(ProgressCallback callback) : callback_(std::move(callback)) {}

    /// Sets the bar's label.
    void stage(const std::string& label) {
        if (bar_) bar_->stage(label);
    }

    /// Returns the callback that shows the progress; empty if the progress is not shown.
    ProgressCallback callback();

    /// Erases the bar, so that the summary can be printed.
    void end() { bar_.reset(); }

  private:
    std::optional<ProgressBar> bar_;
    ProgressCallback callback_;
};

/// A command's scene, session and progress.
class RenderRun {
  public:
    /// Reads the scene on rank 0. Throws UserError.
    RenderRun(const RenderCommand& command, Ranks& ranks);

    /// Uses an existing scene, device and session, on a single rank. Device and session must outlive this object.
    RenderRun(const RenderCommand& command, SceneInput scene, const cl::Device& device, Session& session);

    /// Returns the session on the device. The first call loads tuned values and image encoders, and opens the device.
    Session& session();
    const cl::Device& device() const { return device_; }  // valid after the first call of session()

    Ranks& ranks;
    RenderRecorder recorder;
    RenderProgress progress;
    RenderOptions options;  // `accel`: with several ranks, rank 0's choice for the scene
    SceneInput input;       // input.scene.view: the view of the current image

  private:
    Timing timing_;
    std::vector<std::string> image_files_;  // session() loads the encoders of these files
    std::unique_ptr<ScopedTunedSource> tuned_;
    cl::Device device_;
    std::optional<Session> opened_session_;
    Session* session_ = nullptr;
};

}  // namespace raya
