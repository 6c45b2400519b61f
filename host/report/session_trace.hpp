// Adds measured times to a trace file: the host's spans as one process, the device's commands as another.
#pragma once
#include <string>
#include <vector>

#include "host/cl/profile.hpp"
#include "host/report/trace_file.hpp"

namespace raya {

/// MPI rank to which the trace's processes belong.
struct TraceRank {
    std::uint32_t number = 0;
    bool named = false;  // true if there are several ranks: the names of the processes then begin with the rank
};

/// Adds one track with the host's spans. `begin`: host_clock_ns() at the start of the trace; no span starts earlier.
void add_host_spans(TraceFile& trace, const std::vector<HostSpan>& spans, std::uint64_t begin,
                    const TraceRank& rank = {});

/// Adds a slice from start to end for each command. Its arguments are the command's four times on the device's clock
/// and its bytes; a kernel has the launch's groups and arguments instead of bytes. The command queue is in order, so
/// one track contains all slices, except commands whose reported times overlap: they are in further tracks. Times that
/// are out of order or before `begin` are moved to the nearest valid time. The metadata contains the number of moved
/// times and the offset between the clocks. For a device that does not time its commands, the function adds only a
/// remark to the metadata.
void add_device_commands(TraceFile& trace, const std::string& device, const Profile& profile, const ClockOffset& offset,
                         std::uint64_t begin, const TraceRank& rank = {});

}  // namespace raya
