// The options of `raya render`, and the steps of a render that are the same for all machines: checks, report, output.
#pragma once
#include <memory>
#include <string>
#include <vector>

#include "host/array/render.hpp"
#include "host/base/log.hpp"
#include "host/base/standard_streams.hpp"
#include "host/cli/checkpoint_options.hpp"
#include "host/cli/render_options.hpp"
#include "host/cli/render_run.hpp"
#include "host/cli/scene_input.hpp"
#include "host/cli/torus_options.hpp"
#include "host/cli/view_options.hpp"
#include "host/image/image_io.hpp"
#include "host/ranks/ranks.hpp"
#include "host/report/render_report.hpp"
#include "host/report/roofline.hpp"
#include "host/ring/ring_result.hpp"
#include "host/torus/history.hpp"
#include "host/torus/torus_result.hpp"

namespace raya {

struct RenderCommand {
    RenderOptions render;
    TorusOptions torus;
    std::string image, cost, mask, report, page;  // names of output files; empty: not requested
    std::optional<double> exposure;               // stops: colours are multiplied by 2^exposure
    CheckpointOptions checkpoint;
    TraceOptions trace;
    bool profile = false, counters = false;
    bool prints = true;           // print the report's summary and the table of --profile
    ProgressCallback progress{};  // empty: progress bar on a terminal
    PixelSubset pixels{};         // torus: pixels for which primary rays are traced
    bool counts = false;          // count all events, even if nothing else needs them, see needs_counts()
    bool record_costs = false;    // ring: store the cost of each pixel in Render::ring
    bool keep_packets = false;    // torus: store packets, cycles and link_words in Render

    /// Returns kOn only if times of device commands are printed or written, because timing slows down a GPU's queue.
    Timing timing() const {
        return profile || needs_report() || !trace.file.empty() || verbosity() >= kDetailed ? Timing::kOn
                                                                                            : Timing::kOff;
    }
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
    std::optional<History> history{};         // history of the torus's messages, with --async or --replay
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

/// Adds the command to the parser without running it: the parser sets `options`.
CLI::App* declare_render_command(CLI::App& program, const std::shared_ptr<RenderCommand>& options);

/// Throws UserError if options are incompatible or a file is not writable.
void check_render(const CLI::App& parser, const RenderCommand& command);

/// Rank 0 reads the scene and applies the view options. Other ranks get the scene's name and resolution, without
/// objects. With several ranks and a ring machine, sets `options.accel` on all ranks to rank 0's choice.
SceneInput read_scene_on_rank_0(RenderRecorder& recorder, RenderOptions& options, Ranks& ranks);

/// Throws UserError for an unsupported name of an output file, and for options that do not apply to the output files.
void check_output_files(const CLI::App& parser, const RenderCommand& command);

/// Adds a small copy of `image` to the report, with the command's exposure.
void add_preview(RenderReport& report, const RenderCommand& command, const Image& image);

/// What a machine contributes to the end of a render.
struct MachineOutputs {
    std::function<void(RenderReport&)> describe;              // sets the machine's part of the report
    std::function<void(const ImageAttributes&)> write_files;  // writes the machine's own files
    std::function<void(TraceFile&)> add_trace;                // adds the modelled machine to the trace
    std::vector<KernelWork> work;                             // of the kernels, for the roofline
};

/// Collective: writes the image, the machine's files, report and trace, prints the summary, and removes the checkpoint.
/// Returns the report; nothing on ranks other than 0.
std::optional<RenderReport> finish_render(const RenderCommand& command, RenderRun& run, const RenderSettings& settings,
                                          const RenderResult& result, const MachineOutputs& outputs);

}  // namespace raya
