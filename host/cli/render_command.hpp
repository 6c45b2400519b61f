// The options of `raya render`, and the steps of a render that are the same for all machines: checks, report, output.
#pragma once
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "host/array/render.hpp"
#include "host/base/checkpoint.hpp"
#include "host/base/log.hpp"
#include "host/base/whole_file.hpp"
#include "host/cl/commands.hpp"
#include "host/cli/options.hpp"
#include "host/cli/render_options.hpp"
#include "host/image/image_io.hpp"
#include "host/ranks/ranks.hpp"
#include "host/report/render_report.hpp"
#include "host/report/trace_file.hpp"
#include "host/ring/ring_result.hpp"
#include "host/torus/history.hpp"
#include "host/torus/torus_result.hpp"

namespace raya {

/// The options as given on the command line. An empty `file` means no trace.
struct TraceOptions {
    std::string file;
    std::size_t events = 1'000'000;  // maximum number of events
    std::size_t pes = 16;            // number of PEs or nodes that get a track
};

/// Records the host's spans and clock offsets of a render for --profile and --trace, and writes the trace.
class RenderRecorder {
  public:
    /// `profile`: records the time of each build. Without trace and profile, the recorder has only the spans that its
    /// owner adds to spans().
    RenderRecorder(const TraceOptions& trace, bool profile) : trace_(trace), profile_(profile) {}

    bool traces() const { return !trace_.file.empty(); }
    SpanLog& spans() { return spans_; }

    /// Records the session's spans from now on. For a trace, measures the offset of the
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

struct RenderCommand {
    RenderOptions render;
    TorusOptions torus;
    std::string image, cost, mask, report, page;  // names of output files; empty: not requested
    std::optional<double> exposure;               // stops: colours are multiplied by 2^exposure
    CheckpointOptions checkpoint;
    TraceOptions trace;
    bool profile = false;
    bool prints = true;           // print the report's summary and the table of --profile
    ProgressCallback progress{};  // empty: progress bar on a terminal
    PixelSubset pixels{};         // torus: pixels for which primary rays are traced
    bool counts = false;          // count all events, even if nothing else needs them, see needs_counts()
    bool record_costs = false;    // ring: store the cost of each pixel in Render::ring
    bool keep_packets = false;    // torus: store packets, cycles and link_words in Render

    /// Returns kOn only if times of device commands are printed or written, because timing slows down a GPU's queue.
    Timing timing() const { return profile || needs_report() || !trace.file.empty() ? Timing::kOn : Timing::kOff; }
    /// Returns true if a report is needed: for --report, or for --page, which is made from a report.
    bool needs_report() const { return !report.empty() || !page.empty(); }
    /// Returns true if all events must be counted, not only rays. On the machine `grande`, which is no model of a
    /// machine, they are counted only for options that need them.
    bool needs_counts() const {
        return counts || render.machine != "grande" || needs_report() || needs_roofline() || record_costs ||
               !cost.empty() || !trace.file.empty() || !checkpoint.file.empty();
    }
    /// Returns true if the report compares kernels with the device's peak.
    bool needs_roofline() const { return profile || !page.empty(); }
};

/// Returns the settings of a render on a ring machine. `options`: those of the command, possibly changed.
RingSettings ring_settings_of(const RenderCommand& command, const RenderOptions& options, const Scene& scene);

/// The results of a render on a ring machine (`ring`) or on the torus (`torus`).
struct Render {
    RenderReport report{};
    std::optional<RingResult> ring{};
    std::optional<TorusResult> torus{};
    std::vector<PacketRecord> packets{};  // with keep_packets: every packet between nodes
    std::optional<TorusSettings> torus_settings{};
    std::uint32_t lights = 0;                 // number of the scene's lights
    std::optional<History> history{};         // history of the torus's messages, with --async
    std::vector<std::uint64_t> cycles{};      // with keep_packets: [superstep][node]: modelled cycles
    std::vector<std::uint64_t> link_words{};  // with keep_packets: [superstep][node][RAYA_LINKS]: number of words sent

    const RenderResult& result() const {
        if (ring) return *ring;
        return *torus;
    }
    const Image& image() const { return result().image; }
};

/// Renders on a ring machine or on the torus machine and writes the command's files. Returns an empty result on ranks
/// other than 0.
std::optional<Render> render_on_ring(const RenderCommand& command, RenderRun& run);
std::optional<Render> render_on_torus(const RenderCommand& command, RenderRun& run);

inline bool is_torus(const RenderCommand& command) {
    return machine_named(command.render.machine).kind == MachineKind::kTorus;
}

/// Calls render_on_torus() or render_on_ring(), as the command's machine requires.
std::optional<Render> render_image(const RenderCommand& command, RenderRun& run);

/// Adds all options of `raya render` except SCENE.
void add_render_command_options(CLI::App& command, RenderCommand& options);

/// Throws UserError if options are incompatible or a file is not writable.
void check_render(const RenderCommand& command);

/// Adds a small copy of `image` to the report, with the command's exposure.
void add_preview(RenderReport& report, const RenderCommand& command, const Image& image);

/// What a machine contributes to the end of a render.
struct MachineOutputs {
    std::function<void(RenderReport&)> describe;  // sets the machine's part of the report
    std::function<void()> write_files;            // writes the machine's own files; empty: none
    std::function<void(TraceFile&)> add_trace;    // adds the modelled machine to the trace
    std::vector<KernelWork> work;                 // of the kernels, for the roofline
};

/// Collective: writes the image, the machine's files, report and trace, prints the summary, and removes the checkpoint.
/// Returns the report; nothing on ranks other than 0.
std::optional<RenderReport> finish_render(const RenderCommand& command, RenderRun& run, const RenderSettings& settings,
                                          const RenderResult& result, const MachineOutputs& outputs);

/// Returns the JSON Schema of the report.
Json render_schema();

}  // namespace raya
