// Measurements of a device: rates of arithmetic operations in a number format, peak rates, and the offset between the
// device's clock and the host's.
#pragma once
#include <array>
#include <cstdint>

#include "host/cl/commands.hpp"
#include "host/cl/kernel_options.hpp"
#include "host/cl/profile.hpp"
#include "host/model/number_format.hpp"

namespace raya {

inline constexpr std::array<const char*, 5> kOperations = {"add", "multiply", "mul-acc", "divide", "sqrt"};

/// Measures the rate of each operation of kOperations in one number format. All compute units run chains of operations;
/// in a chain, each operation depends on the previous one. Builds the kernel once. Clears the session's profile. Throws
/// DeviceError.
class OperationRates {
  public:
    OperationRates(Session& session, const NumberFormat& format, std::uint32_t lanes);

    /// Returns the number of operations kOperations[kind] per second: the maximum over `samples` launches of at least
    /// 10 ms each. Returns 0 if the device does not time its commands.
    double measure(std::size_t kind, int samples);

  private:
    using Chains =
        DescribedKernel<"number/operations.cl", "operations", Uint<"kind">, Uint<"rounds">, cl_float, Buffer<float>&>;

    /// Returns the device time of one launch, in seconds.
    double launch_seconds(std::size_t kind);
    /// Chooses rounds_[kind] so that a launch takes at least 10 ms.
    void find_rounds(std::size_t kind);

    Session& session_;
    std::uint32_t group_size_;
    std::size_t work_items_, lanes_;  // number of work-items of a launch; number of lanes
    Kernels kernels_;
    Chains chains_;
    Buffer<float> results_;
    std::array<std::uint32_t, kOperations.size()> rounds_{};  // [kind]: number of loop iterations; 0: not chosen
};

/// Measures the rates of operations in fp32 with the device's default lanes, of operations in `format` with `lanes`,
/// and of copies between two buffers of up to 256 MB, which exceed the caches. Returns the highest rates of three
/// measurements. Takes a few seconds. Uses its own session, so that its commands do not appear in the caller's profile.
/// All rates are 0 if the device does not time its commands. Throws DeviceError.
DevicePeak device_peak(const cl::Device& device, const NumberFormat& format, std::uint32_t lanes);

/// Measures the offset of the device's clock. Enqueues 16 fills of one word and reads the host's clock before and after
/// fill: the command was queued between these two times. Uses the command with the shortest interval.
/// Later drift of the clocks is not detected. Clears the session's profile. Throws std::logic_error if the session does
/// not time its commands.
ClockOffset measure_clock_offset(Session& session);

/// Returns the clock offset that follows from one command. The command was queued at `queued` on the device's clock,
/// and between `before` and `after` on the host's clock. Times are in ns.
ClockOffset clock_offset_of(std::uint64_t before, std::uint64_t queued, std::uint64_t after);

}  // namespace raya
