// Mappings of an image onto the PEs of a ring; the formulas are in kernels/shared/mapping.h.
#pragma once
#include <cstdint>
#include <string>

#include "host/model/mapping_rule.hpp"

namespace raya {

/// Checks and completes a mapping. Throws UserError, with the option and its legal range, for an image side outside
/// 1..16384, PEs outside 1..W*H or different from the grid's, an offset outside 0..W-1, tiles that do not divide the
/// image.
raya_mapping make_mapping(const MappingRule& rule, const ImageSize& image, std::uint32_t pes);

/// The argument of --mapping for this mapping, without the fold: "cyclic:16", "grid:16x16". The column split is
/// "cyclic:0".
std::string mapping_text(const MappingRule& rule);
std::string mapping_text(const raya_mapping& mapping);

/// Maximum number of pixels of a PE.
std::uint32_t largest_share(const raya_mapping& mapping);

}  // namespace raya
