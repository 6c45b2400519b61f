// Adds measured times to a trace, as two processes: the host's steps and the device's commands.
#pragma once
#include <string>
#include <vector>

#include "host/cl/profile.hpp"
#include "host/report/trace_file.hpp"

namespace raya {

/// MPI rank of the processes; `named`: prefix their names with the rank, for several ranks.
struct TraceRank {
    std::uint32_t number = 0;
    bool named = false;
};

/// Adds one track of steps. `begin`: host_clock_ns() at the start of the trace; no step starts earlier.
void add_host_steps(TraceFile& trace, const std::vector<HostStep>& steps, std::uint64_t begin,
                    const TraceRank& rank = {});

/// Adds a slice for each command from start to end, with its four times on the device's clock, bytes, and details of
/// kernel launches. All slices are in one track, because the queue is in order; commands whose reported times overlap
/// go to further tracks. Times that are out of order or before `begin` are moved to the nearest valid time and counted
/// in the metadata, which also has the relation of the clocks. For a device that does not time its commands, adds only
/// a remark to the metadata.
void add_device_commands(TraceFile& trace, const std::string& device, const Profile& profile, const ClockAnchor& anchor,
                         std::uint64_t begin, const TraceRank& rank = {});

}  // namespace raya
