// What one operation of the number layer costs on a device.
#pragma once
#include <array>
#include <cstdint>

#include "host/cl/commands.hpp"
#include "host/cl/kernels.hpp"
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

}  // namespace raya
