// Puts the contributions that come back to the root into the order of their pixels' ray trees and adds them up.
#pragma once
#include <cstdint>
#include <vector>

#include "host/cl/kernels.hpp"
#include "kernels/shared/packet.h"

namespace raya {

/// Sorted as the pixels' sums need them: first to last pixel, in each the order of its ray tree. `starts`: [pixels +
/// 1].
struct Contributions {
    std::vector<float> colours;         // [contribution][4]: red, green, blue, weight
    std::vector<std::uint32_t> starts;  // where those of each pixel start
};

/// Takes return packets in any order. std::logic_error for a pixel beyond `pixels`, or two packets with the same place
/// in a pixel's tree.
Contributions sort_contributions(const std::vector<raya_head>& returns, std::uint32_t pixels);

using ComposeKernel = DescribedKernel<"torus/compose.cl", "compose", const Buffer<float>&, const Buffer<std::uint32_t>&,
                                      Uint<"pixels">, Buffer<float>&, Buffer<std::uint32_t>&>;

class Composer {
  public:
    /// Kernels for one lane.
    explicit Composer(Kernels& kernels);

    /// [pixels][3]: linear red, green, blue, in the format of the build. DeviceError where the device ends loops early.
    std::vector<float> compose(const Contributions& contributions);

  private:
    Session& session_;
    std::uint32_t group_;
    ComposeKernel compose_;
};

}  // namespace raya
