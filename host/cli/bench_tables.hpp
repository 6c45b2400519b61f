// What `raya bench` prints of its rows.
#pragma once
#include <cstdint>
#include <vector>

#include "host/cl/commands.hpp"
#include "host/cli/bench_rows.hpp"

namespace raya {

/// Each row's rates, times, speed-up and slow-down.
void print_rows(const std::vector<BenchRow>& rows);

/// Operations a second of the number layer in each format, measured now. DeviceError.
void print_operations(Session& session, const std::vector<NumberFormat>& formats, std::uint32_t lanes, int samples);

/// What rows that leave lanes and group open have taken, where it was tuned.
void print_tuned(const std::vector<BenchRow>& rows);

/// Each row beside the one that takes denormal numbers for 0.
void print_denormals(const std::vector<BenchRow>& rows);

}  // namespace raya
