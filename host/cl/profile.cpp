#include "host/cl/profile.hpp"

#include <fmt/core.h>
#include <linux/perf_event.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <ctime>
#include <limits>
#include <map>
#include <utility>

#include "host/base/log.hpp"

namespace raya {
namespace {

struct EventType {
    const char* name;
    std::uint32_t type;
    std::uint64_t config;
};

constexpr std::array<EventType, kHostEvents> kTypes = {{
    {"cycles", PERF_TYPE_HARDWARE, PERF_COUNT_HW_CPU_CYCLES},
    {"instructions", PERF_TYPE_HARDWARE, PERF_COUNT_HW_INSTRUCTIONS},
    {"cache misses", PERF_TYPE_HARDWARE, PERF_COUNT_HW_CACHE_MISSES},
    {"branch misses", PERF_TYPE_HARDWARE, PERF_COUNT_HW_BRANCH_MISSES},
    {"processor time", PERF_TYPE_SOFTWARE, PERF_COUNT_SW_TASK_CLOCK},
    {"page faults", PERF_TYPE_SOFTWARE, PERF_COUNT_SW_PAGE_FAULTS},
}};

// Opens a counter of this thread and of the threads that it will start. Returns its descriptor, or -1 and sets errno.
int open_counter(const EventType& event) {
    perf_event_attr attributes{};
    attributes.size = sizeof attributes;
    attributes.type = event.type;
    attributes.config = event.config;
    attributes.inherit = 1;
    attributes.exclude_kernel = attributes.exclude_hv = 1;  // counting the kernel's events needs more rights
    attributes.read_format = PERF_FORMAT_TOTAL_TIME_ENABLED | PERF_FORMAT_TOTAL_TIME_RUNNING;
    return static_cast<int>(::syscall(SYS_perf_event_open, &attributes, 0, -1, -1, PERF_FLAG_FD_CLOEXEC));
}

std::string reason(int error) {
    if (error == ENOENT || error == EOPNOTSUPP || error == ENODEV)
        return "the processor, or the virtual machine, does not offer them";
    const std::string text = std::strerror(error);
    if (error != EACCES && error != EPERM) return text;
    return text + "; remedy: as root, sysctl kernel.perf_event_paranoid=2; in a container, the capability PERFMON";
}

}  // namespace

HostCounts operator+(HostCounts a, const HostCounts& b) {
    for (std::size_t i = 0; i < kHostEvents; ++i) a.of[i] += b.of[i];
    return a;
}

HostCounts operator-(HostCounts a, const HostCounts& b) {
    for (std::size_t i = 0; i < kHostEvents; ++i) a.of[i] -= b.of[i];
    return a;
}

HostCounters::HostCounters() {
    std::string names;
    int error = 0;
    for (std::size_t i = 0; i < kHostEvents; ++i) {
        files_[i] = open_counter(kTypes[i]);
        if (files_[i] >= 0) continue;
        error = errno;
        names += fmt::format("{}{}", names.empty() ? "" : ", ", kTypes[i].name);
    }
    if (error != 0) unavailable_ = fmt::format("no {}: {}", names, reason(error));
}

HostCounters::~HostCounters() {
    for (const int file : files_)
        if (file >= 0) ::close(file);
}

HostCounts HostCounters::read() const {
    struct {
        std::uint64_t count, enabled_ns, running_ns;  // running_ns: the part of enabled_ns in which events were counted
    } value{};
    HostCounts counts;
    for (std::size_t i = 0; i < kHostEvents; ++i) {
        counts.of[i] = std::numeric_limits<double>::quiet_NaN();
        if (files_[i] >= 0 && ::read(files_[i], &value, sizeof value) == sizeof value && value.running_ns > 0)
            counts.of[i] = static_cast<double>(value.count) * static_cast<double>(value.enabled_ns) /
                           static_cast<double>(value.running_ns);
    }
    return counts;
}

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
        if (command.host_counts) line.host_counts = line.host_counts.value_or(HostCounts{}) + *command.host_counts;
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

SpanLog::Span::Span(SpanLog* log, const std::string& name) : log_(log) {
    if (verbosity() >= kVerbose) {
        logged_name_ = name;
        started_ = host_clock_ns();
    }
    if (log_ == nullptr) return;
    number_ = log_->spans_.size();
    log_->spans_.push_back({name, host_clock_ns(), 0, log_->depth_++});
}

SpanLog::Span::~Span() {
    if (!logged_name_.empty())
        log_message(kVerbose,
                    fmt::format("{}: {:.3f} s", logged_name_, 1e-9 * static_cast<double>(host_clock_ns() - started_)));
    if (log_ == nullptr) return;
    log_->spans_[number_].ended = host_clock_ns();
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
