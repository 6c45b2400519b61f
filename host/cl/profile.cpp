#include "cl/profile.hpp"

#include <algorithm>
#include <map>
#include <utility>

namespace raya {

std::vector<LabelSummary> Profile::summary() const {
    std::vector<LabelSummary> lines;
    std::map<std::pair<std::string, std::string>, std::size_t> line_of;  // (label, kind) -> index into lines
    for (const CommandRecord& command : commands_) {
        const std::uint64_t duration = command.ended - command.started;
        const auto [place, is_new] = line_of.try_emplace({command.label, command.kind}, lines.size());
        if (is_new) lines.push_back({.label = command.label, .kind = command.kind, .min_ns = duration});
        LabelSummary& line = lines[place->second];
        line.launches += 1;
        line.total_ns += duration;
        line.min_ns = std::min(line.min_ns, duration);
        line.max_ns = std::max(line.max_ns, duration);
        line.submit_ns += command.submitted - command.queued;
        line.start_ns += command.started - command.submitted;
        line.bytes += command.bytes;
    }
    for (LabelSummary& line : lines) line.mean_ns = double(line.total_ns) / double(line.launches);
    return lines;
}

}  // namespace raya
