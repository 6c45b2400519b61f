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
        std::uint64_t events = 0;
        for (const Document& event : trace.at("traceEvents")) {
            try {
                if (event.at("ph") == "M" && events > 0) fault("a name after other events", event);
                events += event.at("ph") != "M";
                read(event);
            } catch (const Document::exception& error) {
                fault(error.what(), event);
            }
        }
        for (auto& [track, slices] : slices_) check_nesting(slices);
        if (trace.at("otherData").at("events") != events) faults_.emplace_back("otherData does not count the events");
    }

    const std::vector<std::string>& faults() const { return faults_; }
    const std::map<Track, std::vector<Slice>>& slices() const { return slices_; }
    const std::map<Track, std::string>& tracks() const { return tracks_; }

    /// Returns the slices in all tracks of a process.
    std::vector<Slice> slices_of(std::int64_t pid) const {
        std::vector<Slice> all;
        for (const auto& [track, slices] : slices_)
            if (track.first == pid) all.insert(all.end(), slices.begin(), slices.end());
        return all;
    }

  private:
    void fault(const std::string& rule, const Document& event) { faults_.push_back(rule + ": " + event.dump()); }

    std::int64_t time_of(const Document& event, const char* member) {
        const auto ns = static_cast<std::int64_t>(std::llround(event.at(member).get<double>() * 1000));
        if (ns < 0) fault("a negative time", event);
        return ns;
    }

    void read(const Document& event) {
        const std::string phase = event.at("ph"), name = event.at("name");
        const std::int64_t pid = event.at("pid");
        if (phase == "C") {
            for (const Document& value : event.at("args"))
                if (!std::isfinite(value.get<double>())) fault("a counter that is not a number", event);
            time_of(event, "ts");
            return;
        }
        const Track track = {pid, event.at("tid")};
        if (phase == "M") return read_name(event, name, track);
        for (const char* kind : {"process_name", "process_sort_index", "thread_name", "thread_sort_index"})
            if (!named_.contains({kind, pid, kind[0] == 'p' ? 0 : track.second})) fault("no name", event);
        const std::int64_t start = time_of(event, "ts");
        slices_[track].push_back({start, start + time_of(event, "dur"), name});
    }

    void read_name(const Document& event, const std::string& kind, const Track& track) {
        if (kind.ends_with("_sort_index"))
            event.at("args").at("sort_index").get<std::int64_t>();
        else if (event.at("args").at("name").get<std::string>().empty())
            fault("an empty name", event);
        if (!named_.insert({kind, track.first, kind.starts_with("process_") ? 0 : track.second}).second)
            fault("named twice", event);
        if (kind == "thread_name") tracks_[track] = event.at("args").at("name");
    }

    void check_nesting(std::vector<Slice>& slices) {
        std::stable_sort(slices.begin(), slices.end(), [](const Slice& a, const Slice& b) {
            return std::tuple(a.start, -a.end) < std::tuple(b.start, -b.end);
        });
        std::vector<Slice> open;
        for (const Slice& s : slices) {
            while (!open.empty() && open.back().end <= s.start) open.pop_back();
            if (!open.empty() && s.end > open.back().end)
                faults_.push_back("slices cross: '" + s.name + "' and '" + open.back().name + "'");
            open.push_back(s);
        }
    }

    std::vector<std::string> faults_;
    std::set<std::tuple<std::string, std::int64_t, std::int64_t>> named_;  // kind of name, process ID, thread ID
    std::map<Track, std::string> tracks_;
    std::map<Track, std::vector<Slice>> slices_;
};

inline Document json_of(const TraceFile& trace) { return Document::parse(trace.finish(false)); }

}  // namespace raya
