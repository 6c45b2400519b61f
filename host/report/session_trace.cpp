#include "host/report/session_trace.hpp"

#include <fmt/core.h>

#include <algorithm>

namespace raya {
namespace {

std::uint32_t process_of(TraceProcess process, const TraceRank& rank) {
    return process + kTraceProcesses * rank.number;
}

std::string name_of(const std::string& process, const TraceRank& rank) {
    return rank.named ? fmt::format("rank {} {}", rank.number, process) : process;
}

// Converts times on the device's clock to nanoseconds since the start of the trace.
class DeviceTimes {
  public:
    DeviceTimes(const ClockOffset& offset, std::uint64_t begin)
        : shift_(offset.offset_ns - static_cast<std::int64_t>(begin)) {}

    // Returns the converted time `device_ns`, or `not_before` if that is later; counts the latter as moved.
    std::uint64_t trace_ns(std::uint64_t device_ns, std::uint64_t not_before) {
        const std::int64_t shifted = static_cast<std::int64_t>(device_ns) + shift_;
        if (shifted >= static_cast<std::int64_t>(not_before)) return static_cast<std::uint64_t>(shifted);
        ++moved_count_;
        return not_before;
    }
    std::uint64_t moved_count() const { return moved_count_; }

  private:
    std::int64_t shift_;
    std::uint64_t moved_count_ = 0;
};

Json arguments_of(const CommandRecord& c) {
    Json json = {{"kind", c.kind}};
    json[c.kind == "kernel" ? "kernel" : "buffer"] = c.target_name;
    if (c.kind == "kernel") {
        json["groups"] = c.groups;
        json["group_size"] = c.group_size;
        for (const ArgumentText& a : c.arguments) json["arguments"][a.name] = a.value;
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
    const auto found =
        std::find_if(busy_until.begin(), busy_until.end(), [&](std::uint64_t end) { return end <= start; });
    const auto track = static_cast<std::uint32_t>(found - busy_until.begin()) + 1;
    if (found == busy_until.end()) {
        busy_until.push_back(0);
        trace.name_track({process, track}, track == 1 ? "queue" : fmt::format("queue, overlapping {}", track));
    }
    return track;
}

Json clock_json(const ClockOffset& offset) {
    return {
        {"same_as_host", offset.same_clock},
        {"offset_ns", offset.offset_ns},
        {"uncertainty_ns", offset.uncertainty_ns},
        {"note", offset.same_clock ? "device times are on the host's clock (CLOCK_MONOTONIC_RAW)"
                                   : "host time = device time + offset; offset measured with one command between two "
                                     "readings of the host's clock; drift is not corrected"}};
}

}  // namespace

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
    DeviceTimes times(offset, begin);
    std::vector<std::uint64_t> busy_until;
    for (const CommandRecord& c : profile.commands()) {
        const std::uint64_t start = times.trace_ns(c.started, 0), end = times.trace_ns(c.ended, start);
        const std::uint32_t track = free_track(trace, process, busy_until, start);
        trace.slice({process, track}, c.label, start, end, arguments_of(c));
        busy_until[track - 1] = end;
    }
    trace.metadata()["device_clock"] = clock_json(offset);
    if (times.moved_count() > 0) trace.metadata()["device_times_moved"] = times.moved_count();
}

}  // namespace raya
