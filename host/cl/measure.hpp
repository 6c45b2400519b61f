// Measurements of a device: rates of the number layer's operations, peak rates, and the offset of its clock from the
// host's.
#pragma once
#include <array>
#include <cstdint>

#include "host/cl/commands.hpp"
#include "host/cl/device.hpp"
#include "host/cl/kernels.hpp"
#include "host/cl/profile.hpp"
#include "host/model/number_format.hpp"

namespace raya {

inline constexpr std::array<const char*, 5> kOperations = {"add", "multiply", "mul-acc", "divide", "sqrt"};

/// Measures dependent chains of each operation of kOperations in one format, on all compute units. Builds the kernel
/// once. Clears the session's profile. Throws DeviceError.
class OperationRates {
  public:
    OperationRates(Session& session, const NumberFormat& format, std::uint32_t lanes);

    /// Operations per second of kOperations[kind]: the best of `samples` launches, each of at least 10 ms on the
    /// device. 0 if the device does not time its commands.
    double measure(std::size_t kind, int samples);

  private:
    using Chains =
        DescribedKernel<"number/operations.cl", "operations", Uint<"kind">, Uint<"rounds">, cl_float, Buffer<float>&>;

    double seconds(std::size_t kind);
    void find_rounds(std::size_t kind);

    Session& session_;
    std::uint32_t group_size_;
    std::size_t items_, lanes_;
    Kernels kernels_;
    Chains chains_;
    Buffer<float> results_;
    std::array<std::uint32_t, kOperations.size()> rounds_{};  // of a launch of at least 10 ms; 0: not measured yet
};

/// Measures operations in fp32 with the device's default lanes and in `format` with `lanes`, and copies between two
/// buffers of up to 256 MB, which exceed the caches. Returns the best of three rounds; takes a few seconds. Uses a
/// session of its own, so that other profiles do not contain it. All rates are 0 if the device does not time its
/// commands. Throws DeviceError.
DevicePeak device_peak(const cl::Device& device, const NumberFormat& format, std::uint32_t lanes);

/// Enqueues a few tiny commands and reads the host's clock before and after each: the time at which a command was
/// queued is between the two. Uses the try that took the least time. Does not detect a later drift of the clocks.
/// Clears the session's profile. std::logic_error if the session does not time its commands.
ClockAnchor clock_anchor(Session& session);

/// The anchor from one command, queued at `queued` (device clock) between `before` and `after` (host clock).
ClockAnchor anchor_between(std::uint64_t before, std::uint64_t queued, std::uint64_t after);

}  // namespace raya
