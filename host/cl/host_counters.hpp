// Counts events of the host's processor and of Linux while kernels run on the host (perf_event_open(2)).
#pragma once
#include <array>
#include <string>

namespace raya {

/// The events, in user code. kCpuNs: processor time in nanoseconds. kPageFaults: page faults.
enum HostEvent { kCycles, kInstructions, kCacheMisses, kBranchMisses, kCpuNs, kPageFaults, kHostEvents };

/// A count for each HostEvent; NaN if this host does not count the event.
struct HostCounts {
    std::array<double, kHostEvents> of{};
};
HostCounts operator+(HostCounts a, const HostCounts& b);
HostCounts operator-(HostCounts a, const HostCounts& b);

class HostCounters {
  public:
    /// Starts to count events of this thread and of all threads that it starts from now on. So construct the counters
    /// before the first call of an OpenCL driver, whose threads run the kernels.
    HostCounters();
    ~HostCounters();
    HostCounters(const HostCounters&) = delete;
    HostCounters& operator=(const HostCounters&) = delete;

    /// Returns the counts since the construction. If the processor has fewer counters than events, it counts each event
    /// during a part of the time, and the counts are extrapolated.
    HostCounts read() const;

    /// Returns which events are not counted, and the reason; empty if all are counted.
    const std::string& unavailable() const { return unavailable_; }

  private:
    std::array<int, kHostEvents> files_{};  // descriptors; -1: the event is not counted
    std::string unavailable_;
};

}  // namespace raya
