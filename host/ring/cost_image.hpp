// What every pixel of an image costs: from it follows the load of every mapping, without tracing again.
#pragma once
#include <cstdint>
#include <vector>

namespace raya {

/// Modelled cycles of each pixel, all its rays included. Their sum must stay below 2^63, which leaves room for
/// requests.
struct CostImage {
    std::uint32_t width = 0, height = 0;  // pixels
    std::vector<std::uint64_t> cycles;    // height x width, row-major
};

}  // namespace raya
