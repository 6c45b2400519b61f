// Everything that was tried, in the results format of the T4 schema, version 1.0.0, which Kernel Tuner writes and tools
// about it read (KernelTuner/kernel_tuner, kernel_tuner/schema/T4/1.0.0/results-schema.json).
#pragma once
#include <string>
#include <vector>

#include "host/tune/tune.hpp"

namespace raya {

/// A result for each candidate that has ended: its values and its workload as "configuration", times in milliseconds,
/// how it ended as "invalidity", and the measurements "time", the least of an image, and "ratio", to the best so far.
std::string t4_text(const DeviceInfo& device, const std::vector<Tuning>& tunings);

}  // namespace raya
