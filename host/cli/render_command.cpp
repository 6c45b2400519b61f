#include "host/cli/render_command.hpp"

#include <fmt/core.h>

#include <algorithm>

#include "host/base/json.hpp"
#include "host/base/whole_file.hpp"
#include "host/cl/device.hpp"
#include "host/cl/measure.hpp"
#include "host/cli/commands.hpp"
#include "host/cli/help.hpp"
#include "host/cli/options.hpp"
#include "host/cli/page.hpp"
#include "host/cli/parse.hpp"
#include "host/error.hpp"
#include "host/image/image_io.hpp"
#include "host/ranks/ranks.hpp"
#include "host/report/scene_report.hpp"
#include "host/report/table.hpp"
#include "host/version.hpp"

namespace raya {
namespace {

// Prefix of the names of the spans in which Session builds programs.
constexpr std::string_view kBuildPrefix = "build ";

void add_checkpoint_options(CLI::App& command, CheckpointOptions& options) {
    const OptionGroup group(command, kFiles);
    CLI::Option* const file = add_file(
        command, FileUse::kWritten, "--checkpoint FILE.rst", options.file,
        "Save the progress of a long render to this file, for --resume; the file is removed when the render is "
        "complete. The image and its hash do not change; the number of MPI ranks may",
        "Save the progress of a long render, for --resume");
    command
        .add_flag("--resume", options.resume,
                  "Continue the same render from the file of --checkpoint; start anew if this file does not exist")
        ->needs(file);
    in_range(add_value(command, "--checkpoint-every SECONDS", options.every_s,
                       "Minimum seconds between two checkpoints, 0..86400; raya waits longer if saving would take over "
                       "5 % of the time; 0: a checkpoint after every band of pixels, or in every superstep"),
             0, 86'400, "seconds")
        ->capture_default_str()
        ->needs(file);
}

void add_trace_options(CLI::App& command, TraceOptions& trace) {
    const OptionGroup group(command, kDiagnostics);
    CLI::Option* const file = add_file(
        command, FileUse::kWritten, "--trace FILE.json[.gz]", trace.file,
        "Write a trace for ui.perfetto.dev: the host's steps, the device's commands, and the modelled machine in "
        "modelled time; -: stdout");
    in_range(
        add_value(command, "--trace-events N", trace.events,
                  "Maximum number of events in the trace, 1 or more; a warning gives the number of omitted events"),
        1)
        ->capture_default_str()
        ->needs(file);
    add_value(
        command, "--trace-pes N", trace.pes,
        "Number N of PEs or nodes of the modelled machine that get a track: the N/4 busiest, the N/4 idlest, and N/2 "
        "with numbers at even distances; 0 omits the modelled machine")
        ->capture_default_str()
        ->needs(file);
}

void check_trace(const TraceOptions& trace) {
    const bool has_json_name = trace.file.ends_with(".json") || trace.file.ends_with(".json.gz");
    if (!trace.file.empty() && !has_json_name && !trace.file.starts_with("/dev/") && !is_standard_stream(trace.file))
        throw UserError(
            fmt::format("--trace {}: choose a name that ends in .json, or in .json.gz for compression", trace.file));
}

// Rank 0 reads the scene and applies the view options. Other ranks get the scene's name and resolution, without
// objects. With several ranks and a ring machine, sets `options.accel` on all ranks to rank 0's choice.
SceneInput read_scene_on_rank_0(RenderRecorder& recorder, RenderOptions& options, Ranks& ranks) {
    SceneInput input;
    if (ranks.is_first()) {
        input = recorder.spans().during("read scene", [&] { return read_scene(options.scene, options.strict); });
        change_view(options.view, input.scene);
    }
    if (!ranks.has_several()) return input;
    const bool ring = machine_named(options.machine).kind == MachineKind::kRing;
    if (ranks.is_first() && ring) options.accel = accel_text(ring_settings(options, input.scene).accel);
    ranks.broadcast(input.scene.name);
    ranks.broadcast(input.scene.view.width);
    ranks.broadcast(input.scene.view.height);
    ranks.broadcast(options.accel);
    return input;
}

}  // namespace

void RenderRecorder::observe(Session& session, Ranks& ranks) {
    if (!traces() && !profile_) return;
    session.observe(spans_);
    if (traces() && session.profile().timed()) device_clock_offset_ = measure_clock_offset(session);
    if (traces() && ranks.has_several()) align_clocks(ranks);
}

// Measures the offsets of the ranks' clocks. Sets the beginning of the trace to the earliest beginning on any rank.
void RenderRecorder::align_clocks(Ranks& ranks) {
    has_several_ranks_ = true;
    rank_clock_ = rank_clock(ranks, host_clock_ns);
    const auto offset =
        static_cast<std::uint64_t>(rank_clock_.offset_ns);  // if negative, the sums below wrap modulo 2^64
    const std::vector<std::uint64_t> begins = ranks.all_gather(begin_ns_ + offset);
    begin_ns_ = *std::min_element(begins.begin(), begins.end()) - offset;
    for (const RankClock& c : ranks.all_gather(rank_clock_))
        all_rank_clocks_.push_back({{"offset_ns", c.offset_ns}, {"uncertainty_ns", c.uncertainty_ns}});
}

void RenderRecorder::gather(Session& session, Ranks& ranks) {
    if (!traces() || !ranks.has_several()) return;
    TraceFile this_rank(trace_.events / ranks.count());
    if (!ranks.is_first()) add_measured_events(this_rank, session, ranks.rank());
    const TraceFile::Part part = this_rank.part();
    const std::vector<std::string> names = ranks.gather(part.names), event_texts = ranks.gather(part.text);
    const std::vector<std::uint64_t> events = ranks.all_gather(part.events), left_out = ranks.all_gather(part.left_out);
    for (std::size_t rank = 1; rank < event_texts.size(); ++rank)
        parts_of_other_ranks_.push_back({names[rank], event_texts[rank], events[rank], left_out[rank]});
}

void RenderRecorder::add_measured_events(TraceFile& file, Session& session, std::uint32_t rank) {
    add_host_spans(file, spans_.spans(), begin_ns_, {rank, has_several_ranks_});
    add_device_commands(file, session.device().name, session.profile(), device_clock_offset_, begin_ns_,
                        {rank, has_several_ranks_});
}

std::vector<ProgramBuild> RenderRecorder::builds() const {
    std::vector<ProgramBuild> builds;
    for (const HostSpan& s : spans_.spans())
        if (s.name.starts_with(kBuildPrefix))
            builds.push_back({s.name.substr(kBuildPrefix.size()), 1e-9 * static_cast<double>(s.ended - s.started)});
    return builds;
}

void RenderRecorder::write(Session& session, const std::function<void(TraceFile&)>& add_machine) {
    if (!traces()) return;
    TraceFile file(trace_.events / (1 + parts_of_other_ranks_.size()));
    file.metadata()["program"] = name_and_version();
    if (has_several_ranks_) file.metadata()["rank_clocks"] = all_rank_clocks_;
    add_measured_events(file, session, 0);
    add_machine(file);
    for (const TraceFile::Part& part : parts_of_other_ranks_) file.add(part);
    write_whole_file(trace_.file, file.finish(trace_.file.ends_with(".gz")));
    if (file.left_out() > 0)
        warn(fmt::format("{}: {} of {} events omitted; remedy: --trace-events {}, or fewer --trace-pes", trace_.file,
                         file.left_out(), file.events() + file.left_out(), file.events() + file.left_out()));
}

ProgressCallback RenderProgress::callback() {
    if (!bar_ || !bar_->active()) return callback_;
    return [this](double fraction) { bar_->update(fraction); };
}

RenderRun::RenderRun(const RenderCommand& command, Ranks& all_ranks)
    : ranks(all_ranks),
      recorder(command.trace, command.needs_roofline()),
      progress(all_ranks.is_first(), "reading the scene"),
      options(command.render),
      input(read_scene_on_rank_0(recorder, options, all_ranks)),
      timing_(command.timing()),
      image_files_{command.image, command.cost, command.mask} {}

RenderRun::RenderRun(const RenderCommand& command, SceneInput scene, const cl::Device& device, Session& session)
    : ranks(Ranks::single()),
      recorder(command.trace, command.needs_roofline()),
      progress(command.progress),
      options(command.render),
      input(std::move(scene)),
      timing_(command.timing()),
      device_(device),
      session_(&session) {
    change_view(options.view, input.scene);
    tuned_.reset(new ScopedTunedSource(use_tuned(options.no_tuned, &input.warnings)));
    warn_of_build_options(input.warnings);
    recorder.observe(session, ranks);
}

Session& RenderRun::session() {
    if (session_ != nullptr) return *session_;
    tuned_.reset(new ScopedTunedSource(use_tuned(options.no_tuned, &input.warnings)));
    if (ranks.is_first()) warn_of_build_options(input.warnings);
    progress.stage("preparing");
    device_ =
        recorder.spans().during("choose device", [&] { return choose_device(options.device, ranks.rank_on_host()); });
    // OpenImageIO must be loaded after the OpenCL drivers: both use TBB, a process keeps the first TBB that it loads,
    // and Intel's OpenCL runtime needs a newer TBB than OpenImageIO.
    for (const std::string& file : image_files_)
        if (ranks.is_first() && !file.empty()) load_encoder(file);
    opened_session_.emplace(recorder.spans().during("open device", [&] { return Session(device_, timing_); }));
    session_ = &*opened_session_;
    if (ranks.is_first()) session_->announce_compiling();
    recorder.observe(*session_, ranks);
    return *session_;
}

namespace {

void render(const CLI::App& parser, const RenderCommand& command, Ranks& ranks) {
    refuse_options_of_other_machines(parser, machine_named(command.render.machine));
    if (ranks.is_first()) check_render(command);  // only rank 0 writes files
    RenderRun run(command, ranks);
    render_image(command, run);
}

}  // namespace

std::optional<Render> render_image(const RenderCommand& command, RenderRun& run) {
    return is_torus(command) ? render_on_torus(command, run) : render_on_ring(command, run);
}

void add_render_command_options(CLI::App& command, RenderCommand& options) {
    OptionGroup group(command, kFiles);
    add_file(command, FileUse::kWritten, "-o,--output IMAGE", options.image,
             "Image to write: .png, .tif, .ppm or .jpg (8-bit; JPEG with quality 95, lossy), .exr or .pfm (linear); -: "
             "stdout, as PPM. If a file goes to stdout, the summary goes to stderr",
             "Image to write: .png, .tif, .ppm, .jpg, .exr or .pfm");
    add_render_options(command, options.render);
    group.next(kImageGroup);
    in_range(add_value(command, "--exposure EV", options.exposure,
                       "8-bit images: multiply colours by 2^EV, -64..64 stops; the report's hash does not change"),
             -64, 64, "stops")
        ->default_str("0");
    add_checkpoint_options(command, options.checkpoint);
    add_torus_options(command, options.torus);
    group.next(kDiagnostics);
    ring_only(add_file(command, FileUse::kWritten, "--cost FILE.exr", options.cost,
                       "Write the modelled cycles of each pixel as an image, .exr or .pfm; -: stdout, as PFM",
                       "Write the modelled cycles of each pixel"));
    ring_only(add_file(command, FileUse::kWritten, "--mask IMAGE", options.mask,
                       "Write the mask of the supersampled pixels, white on black"));
    add_file(command, FileUse::kWritten, "--report FILE.json", options.report,
             "Write all counts and measurements as JSON; -: stdout", "Write all counts and measurements; -: stdout");
    add_file(command, FileUse::kWritten, "--page FILE.html", options.page,
             "Write an HTML page: image, owners of pixels, loads, times by label, roofline, modelled and measured "
             "times, build options; raya page makes the same page from a report. Like --profile, measures the device's "
             "peak",
             "Write the report as an HTML page");
    attach_note(command.add_flag("--profile", options.profile,
                                 "Print the number of launches and the times of each labelled command, the build "
                                 "times, and which fraction of the device's measured peak each kernel reaches (the "
                                 "roofline)"),
                kBriefNote, "Print times by kernel and the roofline");
    add_trace_options(command, options.trace);
}

void add_render_command(CLI::App& program, Ranks& ranks) {
    const auto options = std::make_shared<RenderCommand>();
    CLI::App* const command = program.add_subcommand(
        "render", "Render a scene (NFF, OBJ, PLY, glTF or STL) on a ring machine or the torus machine");
    add_examples(*command, {{"raya render scenes/centre.nff -o centre.png",
                             "Render on a ring of 256 PEs, in the scene's resolution"},
                            {"raya render scenes/glass.nff --machine torus --size 64 --report glass.json -o glass.png",
                             "Render a small image on a torus of 64 nodes, with a report"}});
    const OptionGroup group(*command, kFiles);
    add_file(*command, FileUse::kRead, "SCENE SCENE", options->render.scene, kSceneHelp)->required();
    add_render_command_options(*command, *options);
    command->get_option("--output")->required();
    command->callback([command, options, &ranks] { render(*command, *options, ranks); });
}

namespace {

void check_exposure(const RenderCommand& command) {
    if (command.exposure && !stores_8bit_codes(command.image))
        throw UserError(
            fmt::format("--exposure applies to 8-bit images, and {} has linear colours; leave it out, or name a .png, "
                        ".ppm, .tif or .jpg file",
                        command.image));
}

// Throws UserError for an unsupported name of an output file, and for options that do not apply to the output files.
void check_output_files(const RenderCommand& command) {
    if (!find_launch())  // under mpirun, stdout may be a pseudoterminal although the output goes to a file
        for (const std::string& file : {command.image, command.cost, command.mask}) refuse_bytes_on_terminal(file);
    check_exposure(command);
    if (!command.page.empty()) check_page_name("--page", command.page);
    if (!command.image.empty()) check_image_name(command.image, kImageExtensions);
    if (!command.cost.empty()) check_image_name(command.cost, kGreyImageExtensions);
    if (!command.mask.empty()) check_image_name(command.mask, kImageExtensions);
    if (!command.mask.empty() && command.render.antialias != AntialiasMethod::kSupersample)
        throw UserError("--mask requires supersampling: add --antialias supersample");
}

}  // namespace

void check_render(const RenderCommand& command) {
    check_trace(command.trace);
    check_checkpoint_options(command.checkpoint);
    check_output_files(command);
}

void add_preview(RenderReport& report, const RenderCommand& command, const Image& image) {
    const double exposure = command.exposure.value_or(0);
    const Image preview = preview_of(exposure == 0 ? image : as_displayed(image, exposure));
    report.image.preview = {preview.width, preview.height, plain_png(preview)};
}

namespace {

// Returns a report with the members that reports of all machines have.
RenderReport common_report(const RenderCommand& command, const SceneInput& input, const DeviceInfo& device,
                           const RenderSettings& settings, const RenderResult& result) {
    RenderReport report;
    report.raya = raya_version();
    report.scene = input_name(command.render.scene);
    report.view = view_of(input.scene);
    report.skipped = input.remarks;
    report.image = {result.image.width, result.image.height, output_name(command.image), pixel_hash(result.image),
                    stores_8bit_codes(command.image) ? std::optional(command.exposure.value_or(0)) : std::nullopt};
    if (command.needs_report()) add_preview(report, command, result.image);
    report.machine.name = settings.machine.name;
    report.machine.format = format_name(settings.format);
    report.machine.bounces = settings.bounces;
    report.machine.length_exponent = result.scale.exponent;
    report.device = {device.name,          device.platform, device.version,    device.driver,
                     result.build_options, result.lanes,    result.group_size, result.tuned};
    report.events = result.events;
    report.load = result.load;
    report.measured = {result.build_s, result.render_s, result.commands, {}, {}};
    return report;
}

void write_report(const RenderCommand& command, const RenderReport& report) {
    if (command.needs_report()) write_report_and_page({command.report, command.page}, to_json(report));
    if (!is_quiet() && command.prints) fmt::print("{}", printable(summary_text(report)));
    if (!command.profile || !command.prints) return;
    const auto& measured = report.measured;
    fmt::print("\n{}\n", profile_table(measured.build_s, measured.builds, measured.commands));
    if (report.ranks.empty()) fmt::print("{}", roofline_table(*measured.roofline));
    for (const std::string& text : report.rank_rooflines) fmt::print("{}", text);
}

// Measures the peak of this rank's device, and returns the roofline of the rank's kernels.
Roofline measured_roofline(RenderRun& run, const NumberFormat& format, const RenderResult& result,
                           const std::vector<KernelWork>& kernels) {
    Roofline none;
    none.unavailable = "the counts include those of earlier runs, the times do not";
    if (result.earlier_s > 0) return none;
    run.progress.stage("measuring the device's peak");
    try {
        const DevicePeak peak = run.recorder.spans().during(
            "measure peak", [&] { return device_peak(run.device(), format, result.lanes); });
        if (run.ranks.is_first() && peak.scatter > kMaxScatter)
            run.input.warnings.add(
                fmt::format("three measurements of the device's peak differ by {:.0f} %: another program uses the "
                            "device; fractions of the peak are unreliable",
                            100 * peak.scatter));
        Roofline measured = roofline(peak, kernels, result.commands);
        return measured;
    } catch (const DeviceError& error) {  // not rethrown: the render's figures are valid without a roofline
        none.unavailable = error.what();
        return none;
    }
}

void add_measured(RenderReport& report, const RenderCommand& command, RenderRun& run, const NumberFormat& format,
                  const RenderResult& result, const std::vector<KernelWork>& kernels) {
    Ranks& ranks = run.ranks;
    Session& session = run.session();
    std::optional<Roofline>& roofline = report.measured.roofline;
    if (command.needs_roofline()) roofline = measured_roofline(run, format, result, kernels);
    report.measured.builds = run.recorder.builds();
    report.measured.earlier_s = result.earlier_s;
    run.recorder.gather(session, ranks);
    if (!ranks.has_several()) return;
    const RankReport rank{.rank = ranks.rank(),
                          .host = ranks.host(),
                          .torus = is_torus(command),
                          .parts = result.parts_of_rank,
                          .device = session.device(),
                          .lanes = result.lanes,
                          .group_size = result.group_size,
                          .bytes_taken = session.bytes_taken(),
                          .build_s = result.build_s,
                          .render_s = result.render_s,
                          .messages_sent = result.traffic.messages,
                          .bytes_sent = result.traffic.bytes,
                          .waiting_s = result.traffic.waiting_s,
                          .commands = result.commands,
                          .roofline = roofline};
    for (const std::string& text : ranks.gather(json_dump(to_json(rank))))
        report.ranks.push_back({parse_json(text, {"the report of a rank"})});
    if (roofline)
        report.rank_rooflines = ranks.gather(fmt::format("rank {} on {}, {}\n{}", ranks.rank(), ranks.host(),
                                                         session.device().name, roofline_table(*roofline)));
}

}  // namespace

Json render_schema() {
    const auto schema = [](auto list_machine) {
        Members machine(Members::Mode::kDescribe);
        list_machine(machine);
        RenderReport report;
        report.of_machine.json = machine.json();
        return schema_of("raya render --report",
                         "Counted, modelled and measured figures of one render. `raya page` shows the report as a web "
                         "page. The members of `budget` and `modelled_ms` differ between ring and torus.",
                         report);
    };
    return schema_of_either(schema([](Members& m) { ring_members(m, {}, {}, {}); }),
                            schema([](Members& m) { torus_members(m, {}, {}, {}); }));
}

std::optional<RenderReport> finish_render(const RenderCommand& command, RenderRun& run, const RenderSettings& settings,
                                          const RenderResult& result, const MachineOutputs& outputs) {
    SpanLog& spans = run.recorder.spans();
    RenderReport report;
    if (run.ranks.is_first()) {
        run.progress.stage("writing");
        report = common_report(command, run.input, run.session().device(), settings, result);
        outputs.describe(report);
        const SpanLog::Span span(&spans, "write images");
        if (!command.image.empty()) write_image(command.image, result.image, command.exposure.value_or(0));
        if (outputs.write_files) outputs.write_files();
    }
    add_measured(report, command, run, settings.format, result, outputs.work);
    if (!run.ranks.is_first()) return {};
    run.progress.end();
    report.warnings = run.input.warnings.texts();
    spans.during("write report", [&] { write_report(command, report); });
    remove_checkpoint(command.checkpoint);
    const ProgressBar tracing(run.recorder.traces(), "writing the trace");
    run.recorder.write(run.session(), outputs.add_trace);
    return report;
}

}  // namespace raya
