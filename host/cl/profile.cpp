#include "host/cl/profile.hpp"

#include <algorithm>
#include <map>
#include <utility>

namespace raya {

namespace {

// Some drivers' clocks have a command end before it started.
std::uint64_t span(std::uint64_t from, std::uint64_t to) { return to > from ? to - from : 0; }

}  // namespace

std::vector<LabelSummary> Profile::summary() const {
    std::vector<LabelSummary> lines;
    std::map<std::pair<std::string, std::string>, std::size_t> line_of;  // (label, kind) -> index into lines
    for (const CommandRecord& command : commands_) {
        const std::uint64_t duration = span(command.started, command.ended);
        const auto [place, is_new] = line_of.try_emplace({command.label, command.kind}, lines.size());
        if (is_new) lines.push_back({.label = command.label, .kind = command.kind, .min_ns = duration});
        LabelSummary& line = lines[place->second];
        line.launches += 1;
        line.total_ns += duration;
        line.min_ns = std::min(line.min_ns, duration);
        line.max_ns = std::max(line.max_ns, duration);
        line.submit_ns += span(command.queued, command.submitted);
        line.start_ns += span(command.submitted, command.started);
        line.bytes += command.bytes;
    }
    for (LabelSummary& line : lines) line.mean_ns = double(line.total_ns) / double(line.launches);
    return lines;
}

}  // namespace raya
