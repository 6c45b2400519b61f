#include "host/report/trace_file.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <numeric>
#include <stdexcept>

#include "host/base/encoding.hpp"

namespace raya {
namespace {

std::string microseconds(std::uint64_t ns) { return fmt::format("{}.{:03}", ns / 1000, ns % 1000); }

std::string name_record(const char* record_name, TraceTrack track, const Json& arguments) {
    return fmt::format(R"({{"ph":"M","name":"{}","pid":{},"tid":{},"args":{}}})", record_name, track.process,
                       track.thread, json_dump(arguments));
}

std::uint32_t process_of(TraceProcess process, const TraceRank& rank) {
    return process + kTraceProcesses * rank.number;
}

std::string name_of(const std::string& process, const TraceRank& rank) {
    return rank.named ? fmt::format("rank {} {}", rank.number, process) : process;
}

Json arguments_of(const CommandRecord& c) {
    Json json = {{"kind", c.kind}};
    json[c.kind == "kernel" ? "kernel" : "buffer"] = c.target_name;
    if (c.kind == "kernel") {
        json["groups"] = c.groups;
        json["group_size"] = c.group_size;
    } else {
        json["bytes"] = c.bytes;
    }
    json["queued_ns"] = c.queued;
    json["submitted_ns"] = c.submitted;
    json["started_ns"] = c.started;
    json["ended_ns"] = c.ended;
    return json;
}

// Returns the number of the first track in which no slice is open at time `start`; adds a track if there is none.
// `busy_until`[track - 1]: end time of the track's last slice.
std::uint32_t free_track(TraceFile& trace, std::uint32_t process, std::vector<std::uint64_t>& busy_until,
                         std::uint64_t start) {
    const auto found = std::ranges::find_if(busy_until, [&](std::uint64_t end) { return end <= start; });
    const auto track = static_cast<std::uint32_t>(found - busy_until.begin()) + 1;
    if (found == busy_until.end()) {
        busy_until.push_back(0);
        trace.name_track({process, track}, track == 1 ? "queue" : fmt::format("queue, overlapping {}", track));
    }
    return track;
}

}  // namespace

void TraceFile::name_process(std::uint32_t process, const std::string& name) {
    names_ += name_record("process_name", {process, 0}, {{"name", name}}) + ",\n";
    names_ += name_record("process_sort_index", {process, 0}, {{"sort_index", process}}) + ",\n";
}

void TraceFile::name_track(TraceTrack track, const std::string& name) {
    names_ += name_record("thread_name", track, {{"name", name}}) + ",\n";
    names_ += name_record("thread_sort_index", track, {{"sort_index", track.thread}}) + ",\n";
    open_[track];
}

// Returns true and counts an event as written if it does not exceed the limit; otherwise returns false and counts it as
// left out.
bool TraceFile::reserve() {
    const bool fits = events_ < max_events_;
    ++(fits ? events_ : left_out_);
    return fits;
}

void TraceFile::check_named(TraceTrack track) const {
    if (!open_.contains(track))
        throw std::logic_error(fmt::format("trace: track {} of process {} has no name", track.thread, track.process));
}

void TraceFile::add(const std::string& event) { text_ += event + ",\n"; }

void TraceFile::slice(TraceTrack track, const std::string& name, std::uint64_t start, std::uint64_t end,
                      const Json& arguments) {
    check_named(track);
    if (!reserve()) return;
    std::vector<std::uint64_t>& ends = open_.at(track);
    while (!ends.empty() && ends.back() <= start) ends.pop_back();
    std::uint64_t& last = last_start_[track];
    if (end < start || start < last || (!ends.empty() && end > ends.back()))
        throw std::logic_error(fmt::format("trace: slice '{}' from {} to {} overlaps another slice", name, start, end));
    last = start;
    ends.push_back(end);
    add(fmt::format(R"({{"ph":"X","name":{},"pid":{},"tid":{},"ts":{},"dur":{},"args":{}}})", json_dump(name),
                    track.process, track.thread, microseconds(start), microseconds(end - start),
                    arguments.is_null() ? "{}" : json_dump(arguments)));
}

void TraceFile::counter(std::uint32_t process, const std::string& name, std::uint64_t at_ns,
                        const std::vector<std::pair<std::string, double>>& values) {
    if (!reserve()) return;
    Json arguments = Json::object();
    for (const auto& [series, value] : values) {
        if (!std::isfinite(value)) throw std::logic_error(fmt::format("trace: counter '{}' is {}", name, value));
        arguments[series] = value;
    }
    add(fmt::format(R"({{"ph":"C","name":{},"pid":{},"ts":{},"args":{}}})", json_dump(name), process,
                    microseconds(at_ns), json_dump(arguments)));
}

void TraceFile::add(const Part& part) {
    names_ += part.names;
    text_ += part.text;
    events_ += part.events;
    left_out_ += part.left_out;
    max_events_ = std::max(max_events_, events_);
}

std::string TraceFile::finish(bool compressed) const {
    Json about = metadata_;
    about["events"] = events_;
    about["events_left_out"] = left_out_;
    std::string text = "{\"displayTimeUnit\":\"ms\",\"traceEvents\":[\n" + names_ + text_;
    if (text.ends_with(",\n")) text.resize(text.size() - 2);  // no comma follows the last event
    text += "\n],\"otherData\":" + json_dump(about) + "}\n";
    if (!compressed) return text;
    GzipText file;
    file.append(text);
    return file.finish();
}

std::vector<TracedPe> traced_pes(const std::vector<std::uint64_t>& loads, std::size_t max_count) {
    const std::size_t pes = loads.size(), selected = std::min(max_count, pes);
    std::vector<std::uint32_t> by_load(pes);
    std::iota(by_load.begin(), by_load.end(), 0u);
    std::stable_sort(by_load.begin(), by_load.end(), [&](auto a, auto b) { return loads[a] > loads[b]; });
    std::map<std::uint32_t, std::string> chosen;
    for (std::size_t i = 0; i < (selected + 3) / 4; ++i) chosen[by_load[i]] = "busiest";
    std::stable_sort(by_load.begin(), by_load.end(), [&](auto a, auto b) { return loads[a] < loads[b]; });
    for (std::size_t i = 0; i < selected / 4; ++i) chosen.try_emplace(by_load[i], "idlest");
    const std::size_t others = selected - std::min(selected, chosen.size());
    for (std::size_t i = 0; i < others; ++i) chosen.try_emplace(static_cast<std::uint32_t>(i * pes / others), "");
    for (std::uint32_t pe = 0; chosen.size() < selected; ++pe) chosen.try_emplace(pe, "");
    std::vector<TracedPe> traced;
    for (const auto& [pe, remark] : chosen) traced.push_back({pe, remark});
    return traced;
}

std::string traced_pe_name(const std::string& kind, const TracedPe& traced) {
    return fmt::format("{} {}{}", kind, traced.pe, traced.remark.empty() ? "" : fmt::format(" ({})", traced.remark));
}

void add_host_spans(TraceFile& trace, const std::vector<HostSpan>& spans, std::uint64_t begin, const TraceRank& rank) {
    const TraceTrack track = {process_of(kTraceHost, rank), 1};
    trace.name_process(track.process, name_of("host (measured)", rank));
    trace.name_track(track, "steps");
    for (const HostSpan& s : spans) trace.slice(track, s.name, s.started - begin, s.ended - begin);
}

void add_device_commands(TraceFile& trace, const std::string& device, const Profile& profile, const ClockOffset& offset,
                         std::uint64_t begin, const TraceRank& rank) {
    if (!profile.timed()) {
        trace.metadata()["device"] = "left out: the device does not time its commands";
        return;
    }
    const std::uint32_t process = process_of(kTraceDevice, rank);
    trace.name_process(process, name_of(fmt::format("device: {} (measured)", device), rank));
    std::uint64_t moved_count = 0;
    // Converts a time on the device's clock, or returns `not_before` if that is later.
    const auto trace_ns = [&](std::uint64_t device_ns, std::uint64_t not_before) {
        const auto ns = static_cast<std::int64_t>(device_ns - begin) + offset.offset_ns;
        if (ns >= static_cast<std::int64_t>(not_before)) return static_cast<std::uint64_t>(ns);
        ++moved_count;
        return not_before;
    };
    std::vector<std::uint64_t> busy_until;
    for (const CommandRecord& c : profile.commands()) {
        const std::uint64_t start = trace_ns(c.started, 0), end = trace_ns(c.ended, start);
        const std::uint32_t track = free_track(trace, process, busy_until, start);
        trace.slice({process, track}, c.label, start, end, arguments_of(c));
        busy_until[track - 1] = end;
    }
    trace.metadata()["device_clock"] = {{"same_as_host", offset.same_clock},
                                        {"offset_ns", offset.offset_ns},
                                        {"uncertainty_ns", offset.uncertainty_ns},
                                        {"note", "host time (CLOCK_MONOTONIC_RAW) = device time + offset"}};
    if (moved_count > 0) trace.metadata()["device_times_moved"] = moved_count;
}

}  // namespace raya
