// What a device can do at most, as small programs reach it.
#pragma once
#include <cstdint>

#include "host/cl/device.hpp"
#include "host/cl/peak.hpp"
#include "host/model/number_format.hpp"

namespace raya {

/// Rates of operations (kernels/operation_rates.hpp) in fp32 with the device's default lanes and in `format` with
/// `lanes`, and of copies between two buffers of up to 256 MB, more than caches hold; measured three times over, the
/// best of all, in some seconds. In a session of its own, so that no other profile sees it. All 0 where the device does
/// not time its commands. Throws DeviceError.
DevicePeak device_peak(const cl::Device& device, const NumberFormat& format, std::uint32_t lanes);

}  // namespace raya
