// Checks the rules of Chrome's JSON trace format, as Perfetto applies them, and raya's additional rules.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "host/report/trace_file.hpp"
#include "tests/document.hpp"

namespace raya {

/// Checks a whole trace and lists the violated rules.
class TraceSchema {
  public:
    using Track = std::pair<std::int64_t, std::int64_t>;  // process ID, thread ID

    struct Slice {
        std::int64_t start, end;  // nanoseconds
        std::string name;
    };

    explicit TraceSchema(const Document& trace) {
        if (!trace.is_object() || !trace.contains("traceEvents") || !trace["traceEvents"].is_array()) {
            faults_.emplace_back("no traceEvents");
            return;
        }
        for (const Document& event : trace["traceEvents"]) check_event(event);
        check_names();
        for (auto& [track, slices] : slices_) check_nesting(track, slices);
        check_flows();
        check_counts(trace);
    }

    const std::vector<std::string>& faults() const { return faults_; }
    const std::map<Track, std::vector<Slice>>& slices() const { return slices_; }
    const std::map<Track, std::string>& tracks() const { return tracks_; }
    std::size_t flows() const { return begins_.size(); }
    std::size_t counters() const { return counters_; }

    /// Returns the slices in all tracks of a process.
    std::vector<Slice> slices_of(std::int64_t pid) const {
        std::vector<Slice> all;
        for (const auto& [track, slices] : slices_)
            if (track.first == pid) all.insert(all.end(), slices.begin(), slices.end());
        return all;
    }

  private:
    struct FlowEnd {
        Track track;
        std::int64_t at_ns;
        std::string name;
    };

    static std::int64_t ns(const Document& us) { return std::llround(us.get<double>() * 1000); }
    void fault(const std::string& rule, const Document& event) { faults_.push_back(rule + ": " + event.dump()); }

    bool is_time(const Document& event, const char* key) {
        const bool valid = event.contains(key) && event[key].is_number() && event[key].get<double>() >= 0;
        if (!valid) fault(std::string("no time ") + key, event);
        return valid;
    }

    void check_event(const Document& event) {
        const std::string phase = event.is_object() ? event.value("ph", "") : "";
        const bool counter = phase == "C";
        if (phase.size() != 1 || std::string("MXCsf").find(phase) == std::string::npos)
            return fault("unknown phase", event);
        if (!event.contains("name") || !event["name"].is_string() || event["name"] == "")
            return fault("no name", event);
        if (!event.contains("pid") || !event["pid"].is_number_integer()) return fault("pid is not an integer", event);
        if (!counter && (!event.contains("tid") || !event["tid"].is_number_integer()))
            return fault("tid is not an integer", event);
        const Track track = {event["pid"], counter ? Document(0) : event["tid"]};
        if (phase == "M") return check_name(event, track);
        has_events_ = true;
        ++events_;
        used_processes_.insert(track.first);
        if (!counter) used_tracks_.insert(track);
        if (!is_time(event, "ts")) return;
        if (phase == "X") check_slice(event, track);
        if (counter) check_counter(event);
        if (phase == "s" || phase == "f") check_flow(event, track, phase);
    }

    void check_name(const Document& event, const Track& track) {
        if (has_events_) fault("a name after other events", event);
        const std::string name = event["name"];
        const bool sort = name.ends_with("_sort_index"), process = name.starts_with("process_");
        const char* key = sort ? "sort_index" : "name";
        if (!event.contains("args") || !event["args"].contains(key)) return fault("a name without its value", event);
        const Document& value = event["args"][key];
        if (sort ? !value.is_number_integer() : !value.is_string() || value == "")
            return fault("a name of the wrong kind", event);
        if (!named_.insert({name, track.first, process ? 0 : track.second}).second) fault("named twice", event);
        if (name == "thread_name") tracks_[track] = value;
    }

    void check_slice(const Document& event, const Track& track) {
        if (!is_time(event, "dur")) return;
        if (event.contains("args") && !event["args"].is_object()) fault("args are not an object", event);
        const std::int64_t start = ns(event["ts"]);
        slices_[track].push_back({start, start + ns(event["dur"]), event["name"]});
    }

    void check_counter(const Document& event) {
        ++counters_;
        if (!event.contains("args") || !event["args"].is_object() || event["args"].empty())
            return fault("a counter without values", event);
        for (const Document& value : event["args"])
            if (!value.is_number() || !std::isfinite(value.get<double>()))
                fault("a counter that is not a number", event);
    }

    void check_flow(const Document& event, const Track& track, const std::string& phase) {
        if (!event.contains("id") || !event["id"].is_number_integer()) return fault("a flow without id", event);
        if (phase == "f" && event.value("bp", "") != "e") fault("a flow's end that binds to the next slice", event);
        auto& ends = phase == "s" ? begins_ : ends_;
        const bool is_new = ends.try_emplace(event["id"], FlowEnd{track, ns(event["ts"]), event["name"]}).second;
        if (!is_new) fault("a flow with two beginnings or two ends", event);
    }

    void check_names() {
        for (const std::int64_t pid : used_processes_)
            for (const char* name : {"process_name", "process_sort_index"})
                if (!named_.contains({name, pid, 0}))
                    faults_.push_back("process " + std::to_string(pid) + " has no " + name);
        for (const auto& [pid, tid] : used_tracks_)
            for (const char* name : {"thread_name", "thread_sort_index"})
                if (!named_.contains({name, pid, tid}))
                    faults_.push_back("track " + std::to_string(tid) + " of process " + std::to_string(pid) +
                                      " has no " + name);
    }

    void check_nesting(const Track& track, std::vector<Slice>& slices) {
        std::stable_sort(slices.begin(), slices.end(), [](const Slice& a, const Slice& b) {
            return std::tuple(a.start, -a.end) < std::tuple(b.start, -b.end);
        });
        std::vector<Slice> open;
        for (const Slice& s : slices) {
            while (!open.empty() && open.back().end <= s.start) open.pop_back();
            if (!open.empty() && s.end > open.back().end)
                faults_.push_back("slices cross: '" + s.name + "' and '" + open.back().name + "' of track " +
                                  std::to_string(track.second));
            open.push_back(s);
        }
    }

    bool in_slice(const FlowEnd& end) const {
        const auto found = slices_.find(end.track);
        return found != slices_.end() && std::any_of(found->second.begin(), found->second.end(), [&](const Slice& s) {
                   return s.start <= end.at_ns && end.at_ns <= s.end;
               });
    }

    void check_flows() {
        for (const auto& [id, begin] : begins_) {
            const auto end = ends_.find(id);
            const std::string flow = "flow " + std::to_string(id);
            if (end == ends_.end())
                faults_.push_back(flow + " has no end");
            else if (end->second.name != begin.name || end->second.at_ns < begin.at_ns)
                faults_.push_back(flow + ": its ends do not agree");
            if (!in_slice(begin) || (end != ends_.end() && !in_slice(end->second)))
                faults_.push_back(flow + " has an end outside all slices");
        }
        for (const auto& [id, end] : ends_)
            if (!begins_.contains(id)) faults_.push_back("flow " + std::to_string(id) + " has no beginning");
    }

    void check_counts(const Document& trace) {
        const Document about = trace.value("otherData", Document());
        if (!about.is_object() || about.value("events", Document()) != events_ || !about.contains("events_left_out"))
            faults_.emplace_back("otherData does not count the events");
    }

    std::vector<std::string> faults_;
    bool has_events_ = false;  // true after the first event that is not a name
    std::uint64_t events_ = 0;
    std::size_t counters_ = 0;
    std::set<std::tuple<std::string, std::int64_t, std::int64_t>> named_;  // kind of name, process ID, thread ID
    std::set<std::int64_t> used_processes_;
    std::set<Track> used_tracks_;
    std::map<Track, std::string> tracks_;
    std::map<Track, std::vector<Slice>> slices_;
    std::map<std::int64_t, FlowEnd> begins_, ends_;  // [flow ID]
};

inline Document json_of(const TraceFile& trace) { return Document::parse(trace.finish(false)); }

}  // namespace raya
