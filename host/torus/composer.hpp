// Sorts the contributions that the root has received, by pixel and by position in the pixel's ray tree, and sums them.
#pragma once
#include <cstdint>
#include <vector>

#include "host/cl/kernel_options.hpp"
#include "kernels/shared/packet.h"

namespace raya {

/// Contributions, sorted by pixel, then by position in the pixel's ray tree. This is the order of summation.
struct Contributions {
    std::vector<float> colours;         // [contribution][4]: red, green, blue, weight
    std::vector<std::uint32_t> starts;  // [pixels + 1]: index of each pixel's first contribution
};

/// Sorts the contributions of return packets. `returns`: heads of the packets, in any order. `pixels`: number of pixels
/// in the image. Throws std::logic_error for a pixel >= `pixels` and for two packets with the same position in a
/// pixel's ray tree. Throws UserError for more than 2^32 packets.
Contributions sort_contributions(const std::vector<raya_head>& returns, std::uint32_t pixels);

using ComposeKernel = DescribedKernel<"torus/compose.cl", "compose", const Buffer<float>&, const Buffer<std::uint32_t>&,
                                      Uint<"pixels">, Buffer<float>&, Buffer<std::uint32_t>&>;

/// Sums the contributions of each pixel on the device.
class Composer {
  public:
    /// `kernels` must be built for one lane.
    explicit Composer(Kernels& kernels);

    /// Returns [pixel][3]: linear red, green and blue, rounded to the kernels' number format. Throws DeviceError if
    /// the device ends loops early (kernels/shared/loop_canary.clh).
    std::vector<float> compose(const Contributions& contributions);

  private:
    Session& session_;
    std::uint32_t group_size_;
    ComposeKernel compose_;
};

}  // namespace raya
