// The torus machine's nodes and links (kernels/shared/torus.h).
#pragma once
#include <array>
#include <cstdint>
#include <string>

#include "kernels/shared/torus.h"

namespace raya {

inline constexpr std::uint32_t kMaxNodes = 65536;

enum class Links { kTorus3d, kTorus2d };

/// "torus3d" or "torus2d"
std::string links_name(Links links);

/// I x J x K nodes. A 2-D torus arranges the K slabs of I x J nodes in rows of C, where C is the divisor of K that
/// makes the two sides most alike (the lower one in case of a tie). Throws UserError unless 1 <= I, J, K and I J K <=
/// kMaxNodes.
raya_torus make_torus(const std::array<std::uint32_t, 3>& nodes, Links links);

/// Links of each node that lead to another node: 6, 4, or fewer if a side of the torus is 1.
std::uint32_t links_of_node(const raya_torus& torus);

/// "4x4x4"
std::string sides_text(const std::array<std::uint32_t, 3>& sides);

}  // namespace raya
