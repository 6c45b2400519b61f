// Adds measured times to a trace file. The host's spans and the device's commands appear as two processes.
#pragma once
#include <string>
#include <vector>

#include "host/cl/profile.hpp"
#include "host/report/trace_file.hpp"

namespace raya {

/// MPI rank of the processes. `named`: prefix their names with the rank, if there are several ranks.
struct TraceRank {
    std::uint32_t number = 0;
    bool named = false;
};

/// Adds one track with the host's spans. `begin`: host_clock_ns() at the start of the trace; no step starts earlier.
void add_host_spans(TraceFile& trace, const std::vector<HostSpan>& spans, std::uint64_t begin,
                    const TraceRank& rank = {});

/// Adds a slice for each command from start to end, with its four times on the device's clock, its bytes, and details
/// of kernel launches. The command queue is in order, so one track contains all slices; only commands whose reported
/// times overlap are put in further tracks. Times that are out of order or before `begin` are moved to the nearest
/// valid time. The metadata contains their number and the offset between the clocks. For a device that does not time
/// its commands, adds only a remark to the metadata.
void add_device_commands(TraceFile& trace, const std::string& device, const Profile& profile, const ClockOffset& offset,
                         std::uint64_t begin, const TraceRank& rank = {});

}  // namespace raya
