// Maps of who owns what, coloured, as small pictures.
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "host/image/image.hpp"
#include "kernels/shared/mapping.h"
#include "kernels/shared/torus.h"

namespace raya {

/// Each pixel in the colour of its PE's load: red above the mean, blue below, full at the load that lies farthest from
/// it. At most kPreviewSide a side, else each the mean load of the pixels that it stands for.
Image load_map(const raya_mapping& mapping, const std::vector<double>& loads);

inline constexpr std::uint32_t kCloseUpSide = 48;  // pixels

/// The upper left pixels: hue is the number of the owner.
Image owner_close_up(const raya_mapping& mapping);

/// One cell for each node, in the same colours: slices of equal z beside and below one another, x to the right, y down.
/// `values`: by node number.
Image node_map(const raya_torus& torus, const std::vector<double>& values);

}  // namespace raya
