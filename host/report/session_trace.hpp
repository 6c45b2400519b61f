// What was measured, as two processes of a trace: the host's steps and the device's commands.
#pragma once
#include <string>
#include <vector>

#include "host/cl/profile.hpp"
#include "host/report/trace_file.hpp"

namespace raya {

/// Whose they are, where there are several ranks: then the number stands before the processes' names.
struct TraceRank {
    std::uint32_t number = 0;
    bool named = false;
};

/// One track of steps. `begin`: host_clock_ns() at the trace's beginning; no step is earlier.
void add_host_steps(TraceFile& trace, const std::vector<HostStep>& steps, std::uint64_t begin,
                    const TraceRank& rank = {});

/// A slice for each command from its start to its end, all in the queue's track, with its four times by the device's
/// clock, bytes, and what is known of a kernel's launch. The queue is in order, so commands follow each other; should a
/// driver say otherwise, those that overlap go to a track of their own. A command whose times are out of order, or
/// before `begin`, is moved to the nearest time that is not, and counted in the metadata. What the clocks are to each
/// other goes to the metadata too. A device that does not time its commands has no process, and the metadata says so.
void add_device_commands(TraceFile& trace, const std::string& device, const Profile& profile, const ClockAnchor& anchor,
                         std::uint64_t begin, const TraceRank& rank = {});

}  // namespace raya
