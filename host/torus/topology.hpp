// The torus machine's nodes and links (kernels/shared/torus.h).
#pragma once
#include <array>
#include <cstdint>
#include <string>

#include "kernels/shared/torus.h"

namespace raya {

inline constexpr std::uint32_t kMostNodes = 65536;

enum class Links { kTorus3d, kTorus2d };

/// "torus3d" or "torus2d"
std::string links_name(Links links);

/// I x J x K nodes. On a 2-D torus the slabs of equal k lie C beside one another, C the divisor of K that makes the two
/// sides most alike (of equals the lower). UserError unless 1 <= I, J, K and there are at most kMostNodes nodes.
raya_torus make_torus(const std::array<std::uint32_t, 3>& nodes, Links links);

/// Links of each node that lead to another node: 6, 4, or fewer where a side of the torus is 1.
std::uint32_t links_of_node(const raya_torus& torus);

/// "4x4x4"
std::string sides_text(const std::array<std::uint32_t, 3>& sides);

}  // namespace raya
