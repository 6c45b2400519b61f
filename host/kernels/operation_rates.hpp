// What one operation of the number layer costs on a device.
#pragma once
#include <array>
#include <cstdint>

#include "host/cl/commands.hpp"
#include "host/machine/number_format.hpp"

namespace raya {

inline constexpr std::array<const char*, 5> kOperations = {"add", "multiply", "mul-acc", "divide", "sqrt"};

/// Operations per second of each kind of kOperations in `format`, with all compute units busy: the best of `samples`,
/// each of which takes 10 ms or more on the device. 0 where the device does not time its commands. Throws DeviceError.
std::array<double, kOperations.size()> operation_rates(Session& session, const NumberFormat& format,
                                                       std::uint32_t lanes, int samples);

}  // namespace raya
