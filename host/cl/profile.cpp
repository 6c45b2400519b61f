#include "host/cl/profile.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <ctime>
#include <map>

#include "host/base/log.hpp"

namespace raya {
namespace {

// Returns end - start, or 0 if the end is before the start: some drivers report such times.
std::uint64_t duration_ns(std::uint64_t start, std::uint64_t end) { return end > start ? end - start : 0; }

}  // namespace

std::vector<LabelSummary> Profile::summary() const {
    std::vector<LabelSummary> lines;
    std::map<std::pair<std::string, std::string>, std::size_t> line_index;  // (label, kind) -> index into lines
    for (const CommandRecord& command : commands_) {
        const std::uint64_t duration = duration_ns(command.started, command.ended);
        const auto [entry, is_new] = line_index.try_emplace({command.label, command.kind}, lines.size());
        if (is_new) lines.push_back({.label = command.label, .kind = command.kind, .min_ns = duration});
        LabelSummary& line = lines[entry->second];
        line.launches += 1;
        line.total_ns += duration;
        line.min_ns = std::min(line.min_ns, duration);
        line.max_ns = std::max(line.max_ns, duration);
        line.submit_ns += duration_ns(command.queued, command.submitted);
        line.start_ns += duration_ns(command.submitted, command.started);
        line.bytes += command.bytes;
    }
    for (LabelSummary& line : lines) line.mean_ns = double(line.total_ns) / double(line.launches);
    return lines;
}

std::uint64_t host_clock_ns() {
    timespec time{};
    ::clock_gettime(CLOCK_MONOTONIC_RAW, &time);
    return std::uint64_t{1'000'000'000} * static_cast<std::uint64_t>(time.tv_sec) +
           static_cast<std::uint64_t>(time.tv_nsec);
}

SpanLog::Span::Span(SpanLog* log, const std::string& name) : log_(log), name_(name), started_(host_clock_ns()) {
    if (log_ == nullptr) return;
    number_ = log_->spans_.size();
    log_->spans_.push_back({name, started_, 0, log_->depth_++});
}

SpanLog::Span::~Span() {
    const std::uint64_t ended = host_clock_ns();
    log_message(kVerbose, fmt::format("{}: {:.3f} s", name_, 1e-9 * static_cast<double>(ended - started_)));
    if (log_ == nullptr) return;
    log_->spans_[number_].ended = ended;
    --log_->depth_;
}

std::vector<HostSpan> SpanLog::spans() const {
    std::vector<HostSpan> all = spans_;
    const std::uint64_t now = host_clock_ns();
    for (HostSpan& span : all)
        if (span.ended == 0) span.ended = now;
    return all;
}

}  // namespace raya
