#include "host/cli/render_recorder.hpp"

#include <fmt/core.h>

#include <algorithm>

#include "host/base/log.hpp"
#include "host/base/standard_streams.hpp"
#include "host/base/whole_file.hpp"
#include "host/cl/measure.hpp"
#include "host/cli/file_options.hpp"
#include "host/cli/options.hpp"
#include "host/error.hpp"
#include "host/report/session_trace.hpp"
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
             "modelled time; -: stdout");
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

}  // namespace raya
