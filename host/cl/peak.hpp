// What a device can do at most: the record.
#pragma once
#include <cstdint>
#include <string>

namespace raya {

/// What a small program reached on this device; 0 where the device does not time its commands.
struct DevicePeak {
    double fp32_per_s = 0;      // multiply-adds of the widest lanes, one operation each
    std::string format;         // of the render
    double multiply_per_s = 0;  // multiply-adds in that format, with the lanes of the render
    double divide_per_s = 0, root_per_s = 0;
    double copy_bytes_per_s = 0;   // read and written by copies from buffer to buffer
    std::uint64_t copy_bytes = 0;  // of each of these buffers
    double scatter = 0;            // share by which the least of three measurements of fp32_per_s lies below the best
};

}  // namespace raya
