// What is measured of a device: what an operation of the number layer costs, its peak, and how its clock lies against
// the host's.
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

/// Chains of each kind of kOperations in one format, with all compute units busy; built once, measured as often as
/// wanted. Clears the session's profile. Throws DeviceError.
class OperationRates {
  public:
    OperationRates(Session& session, const NumberFormat& format, std::uint32_t lanes);

    /// Operations per second of kOperations[kind]: the best of `samples`, each of which takes 10 ms or more on the
    /// device. 0 where the device does not time its commands.
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
    std::array<std::uint32_t, kOperations.size()> rounds_{};  // that take long enough; 0: not known yet
};

/// Rates of operations in fp32 with the device's default lanes and in `format` with
/// `lanes`, and of copies between two buffers of up to 256 MB, more than caches hold; measured three times over, the
/// best of all, in some seconds. In a session of its own, so that no other profile sees it. All 0 where the device does
/// not time its commands. Throws DeviceError.
DevicePeak device_peak(const cl::Device& device, const NumberFormat& format, std::uint32_t lanes);

/// Sends the device some tiny commands, and looks at the host's clock before and after each: the time at which a
/// command was queued lies between the two. Of the tries the one that took least is taken. Two clocks may also drift
/// apart afterwards, which is not seen. The session's profile is cleared. std::logic_error where the session does not
/// time its commands.
ClockAnchor clock_anchor(Session& session);

/// The anchor of one command, queued at `queued` by the device, given between `before` and `after` by the host.
ClockAnchor anchor_between(std::uint64_t before, std::uint64_t queued, std::uint64_t after);

}  // namespace raya
