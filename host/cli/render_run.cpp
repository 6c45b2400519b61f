#include "host/cli/render_run.hpp"

#include <fmt/core.h>

#include <algorithm>

#include "host/base/log.hpp"
#include "host/base/standard_streams.hpp"
#include "host/base/whole_file.hpp"
#include "host/cl/device.hpp"
#include "host/cl/measure.hpp"
#include "host/cli/options.hpp"
#include "host/cli/render_command.hpp"
#include "host/error.hpp"
#include "host/report/trace_file.hpp"
#include "host/version.hpp"

namespace raya {
namespace {

// Prefix of the names of the spans in which Session builds programs.
constexpr std::string_view kBuildPrefix = "build ";

}  // namespace

void add_trace_options(CLI::App& command, TraceOptions& trace) {
    const OptionGroup group(command, kDiagnostics);
    add_file(command, FileUse::kWritten, "--trace", trace.file, "FILE.json[.gz]",
             "Write a trace for ui.perfetto.dev: the host's steps, the device's commands, and the modelled machine in "
             "modelled time; -: stdout",
             "Write a trace for ui.perfetto.dev");
    add_value(command, "--trace-events", trace.events,
              "Maximum number of events in the trace, 1 or more; a warning gives the number of omitted events")
        ->type_name("N")
        ->capture_default_str();
    add_value(
        command, "--trace-pes", trace.pes,
        "Number N of PEs or nodes of the modelled machine that get a track: the N/4 busiest, the N/4 idlest, and N/2 "
        "with numbers at even distances; 0 omits the modelled machine")
        ->type_name("N")
        ->capture_default_str();
}

void check_trace(const CLI::App& command, const TraceOptions& trace) {
    if (trace.file.empty()) {
        for (const char* option : {"--trace-events", "--trace-pes"})
            if (command.count(option) > 0) throw UserError(fmt::format("{} requires --trace FILE.json", option));
        return;
    }
    if (trace.events == 0) throw UserError("--trace-events 0: must be 1 or more");
    const bool has_json_name = trace.file.ends_with(".json") || trace.file.ends_with(".json.gz");
    if (!has_json_name && !trace.file.starts_with("/dev/") && !is_standard_stream(trace.file))
        throw UserError(
            fmt::format("--trace {}: choose a name that ends in .json, or in .json.gz for compression", trace.file));
}

RenderRecorder::RenderRecorder(const TraceOptions& trace, bool profile, bool counters)
    : trace_(trace), profile_(profile) {
    if (counters) host_counters_.emplace();
}

void RenderRecorder::observe(Session& session, Ranks& ranks) {
    if (!traces() && !profile_) return;
    session.observe(spans_, traces() ? trace_.events : 0);
    if (host_counters_) session.count_host_events(*host_counters_);
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

namespace {

void require_host_device(const cl::Device& device) {
    const DeviceInfo info = device_info(device);
    if (info.type != "cpu")
        throw UserError(
            fmt::format("--counters: {} is not a CPU, and only events of the host's processor are counted; remedy: "
                        "--device cpu, or the profiler of the device's vendor (docs/profile.md)",
                        info.name));
}

}  // namespace

ProgressCallback RenderProgress::callback() {
    if (!bar_ || !bar_->active()) return callback_;
    return [this](double fraction) { bar_->update(fraction); };
}

RenderRun::RenderRun(const RenderCommand& command, Ranks& all_ranks)
    : ranks(all_ranks),
      recorder(command.trace, command.needs_roofline(), command.counters),
      progress(all_ranks.is_first(), "reading the scene"),
      options(command.render),
      input(read_scene_on_rank_0(recorder, options, all_ranks)),
      timing_(command.timing()),
      image_files_{command.image, command.cost, command.mask} {}

RenderRun::RenderRun(const RenderCommand& command, SceneInput scene, const cl::Device& device, Session& session)
    : ranks(Ranks::single()),
      recorder(command.trace, command.needs_roofline(), false),
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
    if (recorder.host_counters() != nullptr) require_host_device(device_);
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

}  // namespace raya
