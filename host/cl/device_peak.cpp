#include "host/cl/device_peak.hpp"

#include <algorithm>
#include <limits>
#include <optional>

#include "host/cl/commands.hpp"
#include "host/cl/kernel_options.hpp"
#include "host/cl/operation_rates.hpp"

namespace raya {
namespace {

constexpr int kSamples = 2;                                      // each of three times
constexpr std::size_t kMultiplyAdd = 2, kDivide = 3, kRoot = 4;  // of kOperations

// Two buffers, an eighth of the memory at most.
std::uint64_t copied_bytes(const DeviceInfo& device) {
    constexpr std::uint64_t kEnough = 256u << 20;
    return std::min({kEnough, device.max_allocation_bytes, device.global_memory_bytes / 16});
}

double copy_bytes_per_s(Session& session, std::uint64_t bytes) {
    Buffer<std::uint8_t> from = session.buffer<std::uint8_t>("peak, from", bytes),
                         to = session.buffer<std::uint8_t>("peak, to", bytes);
    session.fill("peak", from, 1);  // memory that nobody has written to may not be there yet
    session.fill("peak", to, 2);
    session.clear_profile();
    for (int i = 0; i < kSamples; ++i) session.copy("peak", from, 0, to, 0, bytes);
    const std::uint64_t least_ns = session.profile().summary().front().min_ns;
    return least_ns > 0 ? 2e9 * static_cast<double>(bytes) / static_cast<double>(least_ns) : 0;
}

// The programs of a device, built once.
class Peak {
  public:
    Peak(Session& session, const NumberFormat& format, std::uint32_t lanes)
        : session_(session), of_render_(session, format, lanes) {
        const NumberFormat fp32{};
        const std::uint32_t widest = default_lanes(session.device());
        if (format != fp32 || lanes != widest) widest_.emplace(session, fp32, widest);
    }

    DevicePeak once() {
        DevicePeak peak;
        peak.multiply_per_s = of_render_.measure(kMultiplyAdd, kSamples);
        peak.fp32_per_s = widest_ ? widest_->measure(kMultiplyAdd, kSamples) : peak.multiply_per_s;
        peak.divide_per_s = of_render_.measure(kDivide, kSamples);
        peak.root_per_s = of_render_.measure(kRoot, kSamples);
        peak.copy_bytes = copied_bytes(session_.device());
        peak.copy_bytes_per_s = copy_bytes_per_s(session_, peak.copy_bytes);
        return peak;
    }

  private:
    Session& session_;
    OperationRates of_render_;
    std::optional<OperationRates> widest_;  // where that is another program
};

}  // namespace

DevicePeak device_peak(const cl::Device& device, const NumberFormat& format, std::uint32_t lanes) {
    constexpr int kTimes = 3;
    Session session(device);
    DevicePeak best;
    if (session.profile().timed()) {
        Peak peaks(session, format, lanes);
        double least = std::numeric_limits<double>::infinity();
        for (int i = 0; i < kTimes; ++i) {
            const DevicePeak peak = peaks.once();
            least = std::min(least, peak.fp32_per_s);
            for (double DevicePeak::*rate :
                 {&DevicePeak::fp32_per_s, &DevicePeak::multiply_per_s, &DevicePeak::divide_per_s,
                  &DevicePeak::root_per_s, &DevicePeak::copy_bytes_per_s})
                best.*rate = std::max(best.*rate, peak.*rate);
            best.copy_bytes = peak.copy_bytes;
        }
        best.scatter = best.fp32_per_s > 0 ? 1 - least / best.fp32_per_s : 0;
    }
    best.format = format_name(format);
    return best;
}

}  // namespace raya
