// Collects the contributions that the root receives: sorts them by pixel and place in the ray tree, and sums them up.
#pragma once
#include <cstdint>
#include <vector>

#include "host/cl/kernels.hpp"
#include "kernels/shared/packet.h"

namespace raya {

/// Contributions in the order of summation: by pixel, then by place in the pixel's ray tree.
struct Contributions {
    std::vector<float> colours;         // [contribution][4]: red, green, blue, weight
    std::vector<std::uint32_t> starts;  // [pixels + 1]: first contribution of each pixel
};

/// Takes return packets in any order. Throws std::logic_error for a pixel >= `pixels`, or for two packets with the same
/// place in a pixel's tree, UserError for more than 2^32 packets.
Contributions sort_contributions(const std::vector<raya_head>& returns, std::uint32_t pixels);

using ComposeKernel = DescribedKernel<"torus/compose.cl", "compose", const Buffer<float>&, const Buffer<std::uint32_t>&,
                                      Uint<"pixels">, Buffer<float>&, Buffer<std::uint32_t>&>;

class Composer {
  public:
    /// The kernels must be built for one lane.
    explicit Composer(Kernels& kernels);

    /// Returns [pixels][3]: linear red, green, blue, in the format of the build. Throws DeviceError if the device ends
    /// loops early.
    std::vector<float> compose(const Contributions& contributions);

  private:
    Session& session_;
    std::uint32_t group_;
    ComposeKernel compose_;
};

}  // namespace raya
