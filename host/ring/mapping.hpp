// Mappings of an image onto the PEs of a ring; the formulas are in kernels/shared/mapping.h.
#pragma once
#include <cstdint>
#include <string>

#include "host/model/mapping_rule.hpp"

namespace raya {

/// Returns the mapping of an image of W x H pixels by this rule. Throws UserError, with the option and its legal range,
/// if W or H is outside 1..16384, the number of PEs is outside 1..W*H or is not R C for a mapping grid:RxC,
/// the offset is outside 0..W-1, or tiles do not divide the image.
raya_mapping make_mapping(const MappingRule& rule, const ImageSize& image, std::uint32_t pes);

/// Returns the argument of --mapping for this mapping, without the fold: "cyclic:16", "grid:16x16". The mapping of
/// whole columns is "cyclic:0".
std::string mapping_text(const MappingRule& rule);
std::string mapping_text(const raya_mapping& mapping);

/// Returns the maximum number of pixels that a PE owns.
std::uint32_t largest_share(const raya_mapping& mapping);

}  // namespace raya
