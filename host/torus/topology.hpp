// The torus machine's nodes and links (kernels/shared/torus.h).
#pragma once
#include <array>
#include <cstdint>
#include <string>

#include "kernels/shared/torus.h"

namespace raya {

inline constexpr std::uint32_t kMaxNodes = 65536;  // maximum number of nodes

/// Topology of the links.
enum class Links { kTorus3d, kTorus2d };

/// Returns "torus3d" or "torus2d".
std::string links_name(Links links);

/// Makes a torus of I x J x K nodes. A 2-D torus arranges the K slabs of I x J nodes in rows of C slabs, so that its
/// sides are I C and J K / C nodes. C is the divisor of K that minimises the difference of the sides; in case of a tie,
/// the smallest such divisor. Throws UserError unless I, J, K >= 1 and I J K <= kMaxNodes.
raya_torus make_torus(const std::array<std::uint32_t, 3>& nodes, Links links);

/// Returns the number of links of a node that lead to another node: 2 for each side of the torus that is longer than 1,
/// so at most 6 in a 3-D torus and 4 in a 2-D torus.
std::uint32_t links_of_node(const raya_torus& torus);

/// Returns text such as "4x4x4".
std::string sides_text(const std::array<std::uint32_t, 3>& sides);

}  // namespace raya
